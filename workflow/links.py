"""The artefact chain V I R T P A M E: each link is made from those above it."""

from dataclasses import dataclass
from enum import StrEnum


class Link(StrEnum):
    """One place in the chain, oldest first."""

    VIEW = "view"
    IMAGE = "image"
    REGISTRATION = "registration"
    TARGET = "target"
    PLAN = "plan"
    PERMIT = "permit"
    MOTION = "motion"
    VERIFICATION = "verification"

    @property
    def with_below(self) -> tuple["Link", ...]:
        """This link and everything made from it."""
        links = tuple(Link)
        return links[links.index(self) :]


@dataclass(frozen=True, slots=True)
class Artefact:
    """Something a case has, by its id in the record, and the ids of what it was made from."""

    id: str
    made_from: tuple[str, ...]
