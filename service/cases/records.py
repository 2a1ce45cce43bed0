"""What goes into a case's record and what comes back out."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

Json = Mapping[str, Any]


class ArtefactKind(StrEnum):
    """The tables of artefacts, by name."""

    REGISTRATION = "registrations"
    TARGET = "targets"
    PLAN = "plans"
    PERMIT = "permits"
    PERMIT_USE = "permit_uses"
    MOTION = "motions"
    EVALUATION = "evaluations"
    INSERTION = "insertions"
    IMAGE_ASSIGNMENT = "image_assignments"


@dataclass(frozen=True, slots=True)
class NewCase:
    """A case to open; `devices` maps a device kind to the id of its file, `planned_targets` a name to its plan."""

    id: str
    room: str
    patient_id: str
    study_uid: str
    opened_by: str
    settings_sha256: str
    devices: Mapping[str, str]
    planned_targets: Mapping[str, Json]


@dataclass(frozen=True, slots=True)
class NewEvent:
    """Something that happened to a case; `state` and `case_state` are those after it.

    An event with `changes_state` false (a note, a refused request, a late result) leaves the version as it is.
    """

    trigger: str
    user_id: str | None
    state: str
    case_state: Json
    data: Json
    changes_state: bool = True


@dataclass(frozen=True, slots=True)
class NewArtefact:
    """One link of the chain, made by the event that it is appended with.

    `columns` holds what its table has beside `content`: image_id, number, approved_by or trajectory.
    """

    kind: ArtefactKind
    id: str
    made_from: tuple[str, ...]
    content: Json
    columns: Json


@dataclass(frozen=True, slots=True)
class NewVerdict:
    """An interlock's answer within an attempt."""

    code: str
    hazard: str
    passed: bool
    measured: float | str | bool | None
    limit: float | str | bool | None
    unit: str
    message: str


@dataclass(frozen=True, slots=True)
class NewAttempt:
    """A request as it was decided, with every verdict, whether it was accepted or not."""

    case_id: str | None
    user_id: str | None
    trigger: str
    accepted: bool
    code: str
    message: str
    state: str | None
    verdicts: tuple[NewVerdict, ...]


@dataclass(frozen=True, slots=True)
class StoredEvent:
    """An event as the record has it."""

    case_id: str
    sequence: int
    version: int
    trigger: str
    user_id: str | None
    state: str
    case_state: Json
    data: Json
    recorded_at: str


@dataclass(frozen=True, slots=True)
class StoredCase:
    """What was fixed when the case was opened."""

    id: str
    room: str
    patient_id: str
    study_uid: str
    opened_by: str
    product_version: str
    settings_sha256: str
    devices: Json
    opened_at: str


@dataclass(frozen=True, slots=True)
class StoredArtefact:
    """An artefact as the record has it; `columns` as in `NewArtefact`."""

    id: str
    case_id: str
    sequence: int
    made_from: tuple[str, ...]
    content: Json
    columns: Json
    recorded_at: str
