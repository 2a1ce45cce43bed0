"""An entry as a FHIR R5 AuditEvent, checked by `fhir.resources` before it leaves; one resource a line.

Needs the extra `fhir`: its import costs a second, and only this export pays it.
"""

import json
from typing import Any

from fhir.resources.auditevent import AuditEvent

from service.ledger.audit_terms import SOURCE, Code, Entry, Subject, address_of, terms_of

_SYSTEMS = {"DCM": "http://dicom.nema.org/resources/ontology/DCM", SOURCE: f"urn:{SOURCE}:action"}
_OUTCOMES = "http://terminology.hl7.org/CodeSystem/audit-event-outcome"


def audit_event(entry: Entry, subject: Subject | None) -> str:
    """The resource of one entry; the entry itself, whole, is a detail of its first entity."""
    terms = terms_of(entry)
    outcome: dict[str, Any] = {"code": {"system": _OUTCOMES, "code": terms.outcome}}
    if terms.outcome_text:
        outcome["detail"] = [{"text": terms.outcome_text}]
    resource = {
        "resourceType": "AuditEvent",
        "category": [_concept(terms.event)],
        "code": _concept(terms.kind),
        "action": terms.action,
        "recorded": entry["recorded_at"],
        "outcome": outcome,
        "agent": [_agent(entry)],
        "source": {"observer": {"display": SOURCE}},
        "entity": _entities(entry, subject),
    }
    if subject is not None:
        resource["patient"] = {"identifier": {"value": subject.patient_id}}
    return AuditEvent.model_validate(resource).model_dump_json(exclude_none=True) + "\n"


def _concept(code: Code) -> dict[str, Any]:
    return {"coding": [{"system": _SYSTEMS[code.system], "code": code.value, "display": code.meaning}]}


def _agent(entry: Entry) -> dict[str, Any]:
    who = {"identifier": {"value": entry["actor"] or SOURCE}, "display": entry["actor_name"] or SOURCE}
    agent: dict[str, Any] = {"who": who, "requestor": True, "networkString": address_of(entry) or str(entry["client"])}
    return agent | ({"role": [{"text": entry["role"]}]} if entry["role"] else {})


def _entities(entry: Entry, subject: Subject | None) -> list[dict[str, Any]]:
    name = f"urn:{SOURCE}:ledger:{entry['sequence']}"
    whole = {"type": {"text": "entry"}, "valueString": json.dumps(dict(entry), sort_keys=True, ensure_ascii=False)}
    entities: list[dict[str, Any]] = [{"what": {"identifier": {"value": name}}, "detail": [whole]}]
    if subject is not None:
        study = {"identifier": {"system": "urn:dicom:uid", "value": f"urn:oid:{subject.study_uid}"}}
        entities.append({"what": study | {"display": f"case {entry['case_id']}"}})
    return entities
