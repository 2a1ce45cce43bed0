"""A case as it is replayed: bytes, poses, settings, and what was recorded to be made of them; no database needed.

It can be sent to another process or another machine.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

Json = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Difference:
    """One place where the record is not what its bytes give; None where one of the two has nothing there."""

    where: str
    field: str
    recorded: Any
    recomputed: Any


@dataclass(frozen=True, slots=True)
class Image:
    """An image to the byte, and the arm's pose (4 x 4, mm) during the exposure where it is known."""

    content: bytes
    base_from_tcp: list[list[float]] | None


@dataclass(frozen=True, slots=True)
class Registered:
    """A registration, or its refusal (which has no id); `first_image_id` where a nudge between two images proved it."""

    where: str
    id: str | None
    image_id: str
    first_image_id: str | None
    devices: Mapping[str, str]
    recorded: Json


@dataclass(frozen=True, slots=True)
class Targeted:
    """A target in a registered image."""

    where: str
    id: str
    image_id: str
    registration_id: str
    devices: Mapping[str, str]
    recorded: Json


@dataclass(frozen=True, slots=True)
class Planned:
    """A plan; target and image where it leads onto one."""

    where: str
    target_id: str | None
    image_id: str | None
    devices: Mapping[str, str]
    recorded: Json


@dataclass(frozen=True, slots=True)
class Evaluated:
    """An evaluation with the registration inside it, or its refusal (which has none)."""

    where: str
    registration: Registered | None
    image_id: str
    target_id: str
    devices: Mapping[str, str]
    recorded: Json


Step = Registered | Targeted | Planned | Evaluated


@dataclass(frozen=True, slots=True)
class CaseInput:
    """Everything that the replay of one case needs; `devices` holds files by the ids that steps have by kind.

    `faults` are bytes that have not the hash they were pinned by, and what is not there at all.
    """

    case_id: str
    product_version: str
    settings: bytes | None
    images: Mapping[str, Image]
    devices: Mapping[str, bytes]
    steps: tuple[Step, ...]
    faults: tuple[Difference, ...]


@dataclass(frozen=True, slots=True)
class CaseReplay:
    """What a replay of one case found, and how much was computed."""

    case_id: str
    registrations: int
    targets: int
    plans: int
    evaluations: int
    differences: tuple[Difference, ...]

    @property
    def results(self) -> int:
        """How many results were computed anew."""
        return self.registrations + self.targets + self.plans + self.evaluations
