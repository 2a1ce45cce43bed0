"""What an entry is in the terms of DICOM's audit trail (PS3.15 A.5), which FHIR's AuditEvent shares."""

from collections.abc import Mapping
from dataclasses import dataclass
from ipaddress import ip_address
from typing import Any

Entry = Mapping[str, Any]
SOURCE = "coaxial"
DICOM = "DCM"


@dataclass(frozen=True, slots=True)
class Code:
    """A coded value."""

    value: str
    meaning: str
    system: str = DICOM


@dataclass(frozen=True, slots=True)
class Subject:
    """Whom a case is about."""

    patient_id: str
    study_uid: str


@dataclass(frozen=True, slots=True)
class AuditTerms:
    """The event and its kind; `action` is one of CRUDE, `outcome` 0 (success) or 4 (minor failure: refused)."""

    event: Code
    kind: Code
    action: str
    outcome: str
    outcome_text: str


_AUTHENTICATION = Code("110114", "User Authentication")
_LOG_USED = Code("110101", "Audit Log Used")
_SECURITY_ALERT = Code("110113", "Security Alert")
_PROCEDURE_RECORD = Code("110111", "Procedure Record")
_LOGIN = Code("110122", "Login")
_USER_CHANGED = Code("110137", "User Security Attributes Changed")
# Event, kind and action of what DICOM has a message for; None: the entry's own action is its kind.
_KNOWN: dict[str, tuple[Code, Code | None, str]] = {
    "signed_in": (_AUTHENTICATION, _LOGIN, "E"),
    "wrong_answer": (_AUTHENTICATION, _LOGIN, "E"),
    "signed_out": (_AUTHENTICATION, Code("110123", "Logout"), "E"),
    "log_read": (_LOG_USED, None, "R"),
    "ledger_verified": (_LOG_USED, None, "R"),
    "user_added": (_SECURITY_ALERT, _USER_CHANGED, "E"),
    "user_disabled": (_SECURITY_ALERT, _USER_CHANGED, "E"),
    "case_opened": (_PROCEDURE_RECORD, None, "C"),
}


def terms_of(entry: Entry) -> AuditTerms:
    """The terms of an entry; what the standard has no event for keeps its own name under this product's system."""
    own = Code(entry["action"], entry["action"].replace("_", " "), SOURCE)
    elsewhere = (_PROCEDURE_RECORD if entry["case_id"] else own, None, "U" if entry["case_id"] else "E")
    event, kind, action = _KNOWN.get(entry["action"], elsewhere)
    refused = entry["payload"].get("accepted") is False or entry["action"] == "wrong_answer"
    said = entry["payload"].get("message") or entry["payload"].get("code") or ""
    return AuditTerms(event, kind or own, action, "4" if refused else "0", str(said))


def address_of(entry: Entry) -> str | None:
    """The network address that the entry came from; None where it was this machine's command line or the service."""
    first = str(entry["client"]).partition(" ")[0]
    try:
        return str(ip_address(first))
    except ValueError:
        return None
