"""Everything that the record has of a case and that its report speaks of, read in one transaction."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import sqlalchemy as sa
from pydicom import Dataset
from sqlalchemy.engine import Connection

from service.auth.users import user_names
from service.cases import store
from service.cases.attempts import list_attempts
from service.cases.records import ArtefactKind, Json, StoredArtefact, StoredCase, StoredEvent
from service.database import tables
from service.devices.store import StoredDevice, read_device
from service.images.store import NewPurpose, StoredImage, list_images, original_bytes, purpose_of
from service.pacs.derived import identity_of
from workflow.decisions import ImageUse
from workflow.triggers import Trigger

_ALL = 1_000_000  # rows; more than any case has
_SHOWN = (ImageUse.REGISTRATION, ImageUse.VERIFICATION)


@dataclass(frozen=True, slots=True)
class CaseImage:
    """An image of the case and what it was for."""

    stored: StoredImage
    purpose: NewPurpose


@dataclass(frozen=True, slots=True)
class UsedDevice:
    """A device file and since when the case used it (UTC)."""

    file: StoredDevice
    since: str


@dataclass(frozen=True, slots=True)
class LedgerProof:
    """The ledger's entry of the case's last event and the first signed checkpoint that covers it, where there is one.

    `checkpoint` is the signed statement: sequence, sha256, signed_at, key.
    """

    sequence: int
    sha256: str
    checkpoint: Json | None


@dataclass(frozen=True, slots=True, eq=False)
class CaseRecord:
    """A case as its report tells it.

    `decisions` are the requests and observations with the verdict of every interlock, oldest first; `artefacts` by
    kind and id; `image_bytes` those of images that entered the chain; `people` the names of users by id.
    """

    case: StoredCase
    identity: Dataset
    planned: Mapping[str, Json]
    events: Sequence[StoredEvent]
    artefacts: Mapping[ArtefactKind, Mapping[str, StoredArtefact]]
    images: Mapping[str, CaseImage]
    image_bytes: Mapping[str, bytes]
    devices: Sequence[UsedDevice]
    decisions: Sequence[Json]
    people: Mapping[str, str]
    proof: LedgerProof | None

    @property
    def last(self) -> StoredEvent:
        """The newest event: the report tells the case up to it."""
        return self.events[-1]

    def person(self, user_id: str | None) -> str:
        """The name of whoever did it; the service itself where nobody did."""
        return "the service" if not user_id else self.people.get(user_id, f"unknown user {user_id}")


def read_record(connection: Connection, case_id: str) -> CaseRecord:
    """The whole of a case; ServiceError CASE_UNKNOWN."""
    case = store.read_case(connection, case_id)
    events = list(store.all_events(connection, case_id))
    images = dict(_images(connection, case_id))
    return CaseRecord(
        case=case,
        identity=identity_of(connection, case),
        planned=store.planned_targets(connection, case_id),
        events=events,
        artefacts={kind: _artefacts(connection, kind, case_id) for kind in ArtefactKind},
        images=images,
        image_bytes={
            image_id: original_bytes(connection, image_id)
            for image_id, image in images.items()
            if image.purpose.purpose in _SHOWN
        },
        devices=list(_devices(connection, case, events)),
        decisions=list_attempts(connection, case_id, _ALL)[::-1],
        people=user_names(connection),
        proof=_proof(connection, events[-1]),
    )


def _artefacts(connection: Connection, kind: ArtefactKind, case_id: str) -> dict[str, StoredArtefact]:
    return {one.id: one for one in store.artefacts_of(connection, kind, case_id)}


def _images(connection: Connection, case_id: str) -> Iterator[tuple[str, CaseImage]]:
    for image in reversed(list_images(connection, case_id, _ALL)):
        purpose = purpose_of(connection, image.id)
        if purpose is not None:
            yield image.id, CaseImage(image, purpose)


def _devices(connection: Connection, case: StoredCase, events: Sequence[StoredEvent]) -> Iterator[UsedDevice]:
    for device_id in case.devices.values():
        yield UsedDevice(read_device(connection, device_id), case.opened_at)
    for event in events:
        if event.trigger == Trigger.DEVICE_CHANGED:
            for device_id in event.data.get("devices", {}).values():
                yield UsedDevice(read_device(connection, device_id), event.recorded_at)


def _proof(connection: Connection, last: StoredEvent) -> LedgerProof | None:
    """Later entries speak of the case too (an export, a delivery) and change nothing in it."""
    ledger, checkpoints = tables.ledger.c, tables.checkpoints.c
    of_last = (ledger.case_id == last.case_id, ledger.action == last.trigger)
    query = sa.select(ledger.sequence, ledger.sha256).where(*of_last).order_by(ledger.sequence.desc()).limit(1)
    entry = connection.execute(query).first()
    if entry is None:  # the case was imported: the ledger that vouches for it is in the archive
        return None
    covering = sa.select(checkpoints.statement).where(checkpoints.sequence >= entry.sequence)
    signed = connection.execute(covering.order_by(checkpoints.sequence).limit(1)).scalar()
    return LedgerProof(entry.sequence, entry.sha256, None if signed is None else json.loads(signed))
