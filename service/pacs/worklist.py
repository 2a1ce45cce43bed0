"""The hospital's worklist (C-FIND, PS3.4 K): who is next, to fill a new case without a slip (H01)."""

from dataclasses import dataclass
from typing import Any

from pydicom import Dataset
from pynetdicom.sop_class import ModalityWorklistInformationFind

from service.errors import ErrorCode, ServiceError
from service.pacs.peer import association_with
from service.settings import PeerSettings

_PENDING = (0xFF00, 0xFF01)
_SUCCESS = 0x0000
_LARGEST_LIST = 200


@dataclass(frozen=True, slots=True)
class WorklistEntry:
    """A scheduled procedure step; empty where the worklist has nothing."""

    patient_id: str
    patient_name: str
    birth_date: str
    sex: str
    study_uid: str
    accession_number: str
    description: str
    scheduled_at: str
    station: str


def find_scheduled(peer: PeerSettings, calling: str, date: str = "", patient_id: str = "") -> list[WorklistEntry]:
    """What is scheduled, on a date (YYYYMMDD or a range) or for a patient where named.

    ServiceError PEER_UNKNOWN without a worklist in the settings, PEER_UNREACHABLE where it does not answer.
    """
    with association_with(peer, calling, [ModalityWorklistInformationFind]) as association:
        return _entries(association.send_c_find(_query(date, patient_id), ModalityWorklistInformationFind))


def _query(date: str, patient_id: str) -> Dataset:
    """The keys that come back (PS3.4 table K.6-1); an empty one asks for whatever it is."""
    step = Dataset()
    step.ScheduledProcedureStepStartDate = date
    for name in ("ScheduledProcedureStepStartTime", "ScheduledStationAETitle", "ScheduledProcedureStepDescription"):
        setattr(step, name, "")
    step.Modality = ""
    query = Dataset()
    query.SpecificCharacterSet = "ISO_IR 192"
    query.PatientID = patient_id
    for name in ("PatientName", "PatientBirthDate", "PatientSex", "StudyInstanceUID", "AccessionNumber"):
        setattr(query, name, "")
    query.RequestedProcedureDescription = ""
    query.ScheduledProcedureStepSequence = [step]
    return query


def _entries(answers: Any) -> list[WorklistEntry]:
    found: list[WorklistEntry] = []
    for status, identifier in answers:
        code = status.get("Status")
        if code in _PENDING and len(found) < _LARGEST_LIST:
            found.append(_entry(identifier))
        elif code not in (*_PENDING, _SUCCESS):
            told = "no answer" if code is None else f"status 0x{code:04X}"
            raise ServiceError(ErrorCode.PEER_UNREACHABLE, f"the worklist did not answer the question: {told}")
    return found


def _entry(identifier: Dataset) -> WorklistEntry:
    step = next(iter(identifier.get("ScheduledProcedureStepSequence") or ()), Dataset())
    day, time = _text(step, "ScheduledProcedureStepStartDate"), _text(step, "ScheduledProcedureStepStartTime")
    return WorklistEntry(
        patient_id=_text(identifier, "PatientID"),
        patient_name=_text(identifier, "PatientName"),
        birth_date=_text(identifier, "PatientBirthDate"),
        sex=_text(identifier, "PatientSex"),
        study_uid=_text(identifier, "StudyInstanceUID"),
        accession_number=_text(identifier, "AccessionNumber"),
        description=_text(identifier, "RequestedProcedureDescription")
        or _text(step, "ScheduledProcedureStepDescription"),
        scheduled_at=f"{day} {time}".strip(),
        station=_text(step, "ScheduledStationAETitle"),
    )


def _text(dataset: Dataset, name: str) -> str:
    return str(dataset.get(name) or "").strip()
