"""An entry as an audit message of DICOM PS3.15 A.5: one XML document on one line, as syslog would carry it."""

import re
from base64 import b64encode
from xml.etree import ElementTree as Xml

import orjson

from service.ledger.audit_terms import SOURCE, AuditTerms, Code, Entry, Subject, address_of, terms_of

_PATIENT_NUMBER = Code("2", "Patient Number", "RFC-3881")
_STUDY_UID = Code("110180", "Study Instance UID")
_URI = Code("12", "URI", "RFC-3881")
# Participant object type codes and roles (A.5.1.2.2).
_PERSON, _SYSTEM_OBJECT = "1", "2"
_PATIENT, _REPORT, _SECURITY_RESOURCE = "1", "3", "13"
_IP_ADDRESS = "2"
_APPLICATION_SERVER = "4"
# What XML 1.0 cannot hold in any form, and what would end the line; the detail has it all the same.
_UNPRINTABLE = re.compile("[^\\x20-\\uD7FF\\uE000-\\uFFFD\\U00010000-\\U0010FFFF]")
_REPLACED = "\N{REPLACEMENT CHARACTER}"


def audit_message(entry: Entry, subject: Subject | None) -> str:
    """The message of one entry; the entry itself, whole, is a detail of its last object."""
    message = Xml.Element("AuditMessage")
    _event(message, entry, terms_of(entry))
    _participant(message, entry)
    source = Xml.SubElement(message, "AuditSourceIdentification", AuditSourceID=SOURCE)
    Xml.SubElement(source, "AuditSourceTypeCode", {"csd-code": _APPLICATION_SERVER})
    if subject is not None:
        _object(message, _PERSON, _PATIENT, subject.patient_id, _PATIENT_NUMBER, subject.patient_id)
        _object(message, _SYSTEM_OBJECT, _REPORT, subject.study_uid, _STUDY_UID, str(entry["case_id"]))
    name = f"urn:{SOURCE}:ledger:{entry['sequence']}"
    log = _object(message, _SYSTEM_OBJECT, _SECURITY_RESOURCE, name, _URI, "Security Audit Log")
    value = b64encode(orjson.dumps(dict(entry), option=orjson.OPT_SORT_KEYS)).decode()
    Xml.SubElement(log, "ParticipantObjectDetail", type="entry", value=value)
    for element in message.iter():
        element.text = element.text and _UNPRINTABLE.sub(_REPLACED, element.text)
        element.attrib = {name: _UNPRINTABLE.sub(_REPLACED, text) for name, text in element.attrib.items()}
    return Xml.tostring(message, encoding="unicode") + "\n"


def _event(message: Xml.Element, entry: Entry, terms: AuditTerms) -> None:
    event = Xml.SubElement(
        message,
        "EventIdentification",
        EventActionCode=terms.action,
        EventDateTime=entry["recorded_at"],
        EventOutcomeIndicator=terms.outcome,
    )
    _coded(event, "EventID", terms.event)
    _coded(event, "EventTypeCode", terms.kind)
    if terms.outcome_text:
        Xml.SubElement(event, "EventOutcomeDescription").text = terms.outcome_text


def _participant(message: Xml.Element, entry: Entry) -> None:
    """Who did it; the service itself where nobody asked."""
    said = {"UserID": entry["actor"] or SOURCE, "UserIsRequestor": "true", "AlternativeUserID": str(entry["client"])}
    if entry["actor_name"]:
        said["UserName"] = entry["actor_name"]
    if address := address_of(entry):
        said |= {"NetworkAccessPointID": address, "NetworkAccessPointTypeCode": _IP_ADDRESS}
    participant = Xml.SubElement(message, "ActiveParticipant", said)
    if entry["role"]:
        _coded(participant, "RoleIDCode", Code(entry["role"], entry["role"], SOURCE))


def _object(message: Xml.Element, kind: str, role: str, name: str, id_type: Code, shown: str) -> Xml.Element:
    said = {"ParticipantObjectID": name, "ParticipantObjectTypeCode": kind, "ParticipantObjectTypeCodeRole": role}
    made = Xml.SubElement(message, "ParticipantObjectIdentification", said)
    _coded(made, "ParticipantObjectIDTypeCode", id_type)
    Xml.SubElement(made, "ParticipantObjectName").text = shown
    return made


def _coded(parent: Xml.Element, name: str, code: Code) -> None:
    said = {"csd-code": code.value, "codeSystemName": code.system, "originalText": code.meaning}
    Xml.SubElement(parent, name, said)
