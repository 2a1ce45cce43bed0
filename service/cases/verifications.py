"""How each target of a case was verified: from the events and artefacts alone."""

from dataclasses import dataclass

from sqlalchemy.engine import Connection

from service.cases import store
from service.cases.records import ArtefactKind, Json, StoredArtefact, StoredEvent
from workflow.triggers import Trigger

_JUDGED = (Trigger.VERIFICATION_PASSED, Trigger.VERIFICATION_FAILED)


@dataclass(frozen=True, slots=True)
class Verification:
    """One judged verification image.

    `before_image_id` is the image that the target was picked or corrected in, `image_id` the one after the motion;
    `figures` are the evaluation's content, `target` and `registration` those artefacts' (the latter of `image_id`).
    """

    planned_target: str | None
    before_image_id: str
    image_id: str
    passed: bool
    target: Json
    registration: Json
    figures: Json
    recorded_at: str


def verifications_of(connection: Connection, case_id: str) -> list[Verification]:
    """Every judged verification of a case, oldest first; a result that came late, to no target, is none."""
    judged = {event.sequence: event for event in store.events_of_kind(connection, case_id, _JUDGED)}
    evaluations = store.artefacts_of(connection, ArtefactKind.EVALUATION, case_id)
    found = [_verification(connection, judged[one.sequence], one) for one in evaluations if one.sequence in judged]
    return [one for one in found if one is not None]


def _verification(connection: Connection, event: StoredEvent, evaluation: StoredArtefact) -> Verification | None:
    standing = event.case_state.get("target")
    if standing is None:
        return None
    target = store.read_artefact(connection, ArtefactKind.TARGET, standing["id"]).content
    registration_id = str(evaluation.content["registration_id"])
    return Verification(
        planned_target=target["planned_target"],
        before_image_id=str(target["image_id"]),
        image_id=str(evaluation.columns["image_id"]),
        passed=event.trigger == Trigger.VERIFICATION_PASSED,
        target=target,
        registration=store.read_artefact(connection, ArtefactKind.REGISTRATION, registration_id).content,
        figures=evaluation.content,
        recorded_at=event.recorded_at,
    )
