"""DICOM audit messages keep the rules of PS3.15 A.5.1, FHIR events those of their models; neither loses an entry."""

import json
import sys
from base64 import b64decode
from xml.etree import ElementTree

import pytest
from fhir.resources.auditevent import AuditEvent

from service.audit import record_audit
from service.auth.permissions import Role
from service.errors import ErrorCode, ServiceError
from service.ledger.audit_terms import terms_of
from service.ledger.exports import ExportFormat, export
from service.ledger.listing import Wanted, page

# PS3.15 A.5.1.1: for each element its attributes (must, may) and its elements in order, each with least and most.
_CODED = ({"csd-code", "codeSystemName", "originalText"}, {"displayName"}, [])
_ANY = 10**6
_SCHEMA = {
    "AuditMessage": (
        set(),
        set(),
        [
            ("EventIdentification", 1, 1),
            ("ActiveParticipant", 1, _ANY),
            ("AuditSourceIdentification", 1, 1),
            ("ParticipantObjectIdentification", 0, _ANY),
        ],
    ),
    "EventIdentification": (
        {"EventDateTime", "EventOutcomeIndicator"},
        {"EventActionCode"},
        [("EventID", 1, 1), ("EventTypeCode", 0, _ANY), ("EventOutcomeDescription", 0, 1)],
    ),
    "ActiveParticipant": (
        {"UserID", "UserIsRequestor"},
        {"AlternativeUserID", "UserName", "NetworkAccessPointID", "NetworkAccessPointTypeCode"},
        [("RoleIDCode", 0, _ANY)],
    ),
    "AuditSourceIdentification": ({"AuditSourceID"}, {"AuditEnterpriseSiteID"}, [("AuditSourceTypeCode", 0, _ANY)]),
    "AuditSourceTypeCode": ({"csd-code"}, {"codeSystemName", "originalText", "displayName"}, []),
    "ParticipantObjectIdentification": (
        {"ParticipantObjectID"},
        {"ParticipantObjectTypeCode", "ParticipantObjectTypeCodeRole", "ParticipantObjectDataLifeCycle"},
        [
            ("ParticipantObjectIDTypeCode", 1, 1),
            ("ParticipantObjectName", 1, 1),
            ("ParticipantObjectDetail", 0, _ANY),
        ],
    ),
    "ParticipantObjectDetail": ({"type", "value"}, set(), []),
    "ParticipantObjectName": (set(), set(), []),
    "EventOutcomeDescription": (set(), set(), []),
    "EventID": _CODED,
    "EventTypeCode": _CODED,
    "RoleIDCode": _CODED,
    "ParticipantObjectIDTypeCode": _CODED,
}
_VALUES = {
    "EventActionCode": set("CRUDE"),
    "EventOutcomeIndicator": {"0", "4", "8", "12"},
    "UserIsRequestor": {"true", "false"},
    "NetworkAccessPointTypeCode": set("12345"),
    "ParticipantObjectTypeCode": set("1234"),
    "ParticipantObjectTypeCodeRole": {str(number) for number in range(1, 27)},
}


def _breaches(element):
    """What of an element and those within is against the schema."""
    must, may, inner = _SCHEMA[element.tag]
    found = [f"{element.tag}: {name}" for name in must ^ (set(element.keys()) - may)]
    found += [f"{name}={element.get(name)}" for name in _VALUES.keys() & element.keys()
              if element.get(name) not in _VALUES[name]]  # fmt: skip
    names = [child.tag for child in element]
    order = [name for name, *_ in inner]
    if [name for name in order for _ in range(names.count(name))] != names:
        found.append(f"{element.tag}: {names}")
    found += [name for name, least, most in inner if not least <= names.count(name) <= most]
    return found + [one for child in element for one in _breaches(child)]


@pytest.fixture
def database(record):
    database = record.open()
    with database.write() as connection:
        odd = {"message": "<&\x07µ \u2028", "accepted": False, "subject": "anna"}
        record_audit(connection, "wrong_answer", None, odd)
    yield database
    database.close()


def _exported(database, form, **wanted):
    with database.read() as connection:
        entries = page(connection, Wanted(**wanted), 0, 1000)
    lines = "".join(export(database, Wanted(**wanted), form)).split("\n")
    return entries, lines[:-1]


def test_every_dicom_message_keeps_the_schema_and_holds_its_entry(database):
    entries, lines = _exported(database, ExportFormat.DICOM, action="signed_in")
    assert len(lines) == len(entries) == 1
    entries, lines = _exported(database, ExportFormat.DICOM, case_id="case-1")
    for entry, line in zip(entries, lines, strict=True):
        message = ElementTree.fromstring(line)
        assert _breaches(message) == []
        detail = message.find(".//ParticipantObjectDetail").get("value")
        assert json.loads(b64decode(detail)) == entry
        objects = [one.get("ParticipantObjectID") for one in message.iter("ParticipantObjectIdentification")]
        assert objects[:2] == ["P1", "1.2"]
        assert message.find("EventIdentification/EventID").get("csd-code") == "110111"


def test_a_text_that_xml_cannot_hold_breaks_no_message(database):
    entries, lines = _exported(database, ExportFormat.DICOM)
    messages = [ElementTree.fromstring(line) for line in lines]
    assert [problem for message in messages for problem in _breaches(message)] == []
    details = [json.loads(b64decode(one.find(".//ParticipantObjectDetail").get("value"))) for one in messages]
    assert details == entries


def test_the_schema_of_this_test_finds_what_is_wrong(database):
    _, (line, *_) = _exported(database, ExportFormat.DICOM)
    for change in (
        lambda m: m.remove(m.find("AuditSourceIdentification")),
        lambda m: m.find("EventIdentification").set("EventActionCode", "X"),
        lambda m: m.find("ActiveParticipant").attrib.pop("UserIsRequestor"),
        lambda m: m.append(m.find("EventIdentification")),
    ):
        message = ElementTree.fromstring(line)
        change(message)
        assert _breaches(message)


def test_every_fhir_event_is_valid_and_holds_its_entry(database):
    entries, lines = _exported(database, ExportFormat.FHIR)
    for entry, line in zip(entries, lines, strict=True):
        event = AuditEvent.model_validate_json(line)
        assert json.loads(event.entity[0].detail[0].valueString) == entry
        assert event.outcome.code.code == terms_of(entry).outcome
        assert (event.patient is not None) == (entry["case_id"] is not None)


@pytest.mark.parametrize(
    ("action", "case_id", "payload", "expected"),
    [
        ("signed_in", None, {}, ("110114", "110122", "E", "0")),
        ("wrong_answer", None, {}, ("110114", "110122", "E", "4")),
        ("log_read", None, {}, ("110101", "log_read", "R", "0")),
        ("case_opened", "case-1", {}, ("110111", "case_opened", "C", "0")),
        ("move_approved", "case-1", {"accepted": False, "code": "interlock"}, ("110111", "move_approved", "U", "4")),
        ("device_uploaded", None, {}, ("device_uploaded", "device_uploaded", "E", "0")),
    ],
)
def test_an_entry_has_dicom_s_terms_where_there_are_some(action, case_id, payload, expected):
    terms = terms_of({"action": action, "case_id": case_id, "payload": payload})
    assert (terms.event.value, terms.kind.value, terms.action, terms.outcome) == expected


def test_without_its_extra_fhir_is_refused_before_the_first_line(database, monkeypatch):
    monkeypatch.delitem(sys.modules, "service.ledger.fhir_audit", raising=False)
    monkeypatch.setitem(sys.modules, "fhir.resources.auditevent", None)
    with pytest.raises(ServiceError) as refusal:
        export(database, Wanted(), ExportFormat.FHIR)
    assert refusal.value.code == ErrorCode.EXTRA_MISSING


@pytest.mark.parametrize("form", ExportFormat)
def test_exporting_over_http_is_an_entry(running, form):
    with running.client(Role.AUDITOR) as auditor:
        before = len(auditor.get("/audit", params={"action": "log_read"}).json())
        answer = auditor.get("/audit/export", params={"format": form.value, "action": "log_read"})
        assert answer.status_code == 200
        assert len(answer.text.splitlines()) == before + 1 + (form is ExportFormat.CSV)
