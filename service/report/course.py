"""The course of a case by targets: its events cut where the work on one target ends and that on the next begins."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from service.cases.records import ArtefactKind, Json, StoredArtefact, StoredEvent
from service.report.record import CaseRecord
from service.report.wording import seconds_between
from workflow.plans import PlanKind
from workflow.triggers import Trigger

JUDGED = (Trigger.VERIFICATION_PASSED, Trigger.VERIFICATION_FAILED)
_AIMS = (Trigger.TARGET_CONFIRMED, Trigger.CORRECTION_REQUESTED)
# The first of these behind the end of a target begins the work on the next; a retreat still belongs to the last.
_BEGINS = frozenset(
    {
        Trigger.CARM_MOVED,
        Trigger.CARM_POSITION_CONFIRMED,
        Trigger.EXPOSURE_REQUESTED,
        Trigger.NEWEST_IMAGE_REUSED,
        Trigger.TARGET_CONFIRMED,
        Trigger.PLAN_REQUESTED,
    }
)


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """A judged verification image: the evaluation, the target that it judged, the verdicts of its interlocks."""

    event: StoredEvent
    figures: Json
    image_id: str
    target: StoredArtefact
    verdicts: Json

    @property
    def passed(self) -> bool:
        """Whether the rules passed it."""
        return self.event.trigger == Trigger.VERIFICATION_PASSED


@dataclass(frozen=True, slots=True, eq=False)
class TargetWork:
    """The work on one target, from the C-arm's positioning on; `name` is None where no target was ever confirmed.

    `aims` are its targets as artefacts: confirmed, and crossed into a verification image by a correction.
    """

    name: str | None
    events: Sequence[StoredEvent]
    aims: Sequence[StoredArtefact]
    judgements: Sequence[Judgement]

    @property
    def done(self) -> StoredEvent | None:
        """The statement that ended it: placed or abandoned."""
        return next((event for event in self.events if event.trigger == Trigger.TARGET_DONE), None)

    @property
    def placed(self) -> bool:
        """Whether the surgeon said so."""
        return self.done is not None and bool(self.done.data["placed"])

    @property
    def final(self) -> Judgement | None:
        """The last judged verification: that with which the sleeve went in, where it did."""
        return self.judgements[-1] if self.judgements else None

    @property
    def seconds(self) -> float | None:
        """From its first event to its end, or to its last event where it has none."""
        return seconds_between(self.events[0].recorded_at, (self.done or self.events[-1]).recorded_at)

    def image_ids(self) -> list[str]:
        """The images that arrived meanwhile."""
        return [str(event.data["image_id"]) for event in self.events if event.trigger == Trigger.IMAGE_ARRIVED]


def course_of(record: CaseRecord) -> list[TargetWork]:
    """The work on each target in turn; a target that was tried twice comes twice."""
    verdicts = _verdicts_by_event(record)
    works = [_work(record, events, verdicts) for events in _cut(record, record.events[1:])]
    return [one for one in works if one.aims or one.judgements or any(_is_work(event) for event in one.events)]


def _is_work(event: StoredEvent) -> bool:
    """What moves the arm or exposes; statements and notes alone are no work on a target."""
    return event.trigger in (Trigger.IMAGE_ARRIVED, Trigger.MOVE_STARTED)


def _cut(record: CaseRecord, events: Sequence[StoredEvent]) -> Iterator[list[StoredEvent]]:
    part: list[StoredEvent] = []
    name, over = None, False
    for event in events:
        aimed = _aimed_name(record, event)
        if (over and _begins(event)) or (aimed is not None and name is not None and aimed != name):
            yield part
            part, name, over = [], None, False
        part.append(event)
        name = aimed or name
        over = over or event.trigger == Trigger.TARGET_DONE
    if part:
        yield part


def _begins(event: StoredEvent) -> bool:
    return event.trigger in _BEGINS and event.data.get("kind") != PlanKind.RETREAT


def _aimed_name(record: CaseRecord, event: StoredEvent) -> str | None:
    if event.trigger != Trigger.TARGET_CONFIRMED:
        return None
    return next((str(one.content["planned_target"] or "unplanned target") for one in _aims(record, event)), None)


def _aims(record: CaseRecord, event: StoredEvent) -> list[StoredArtefact]:
    return [one for one in record.artefacts[ArtefactKind.TARGET].values() if one.sequence == event.sequence]


def _work(record: CaseRecord, events: Sequence[StoredEvent], verdicts: dict[int, Json]) -> TargetWork:
    names = [name for name in (_aimed_name(record, event) for event in events) if name is not None]
    aims = [aim for event in events if event.trigger in _AIMS for aim in _aims(record, event)]
    judgements = [_judgement(record, event, verdicts) for event in events if event.trigger in JUDGED]
    return TargetWork(names[-1] if names else None, events, aims, [one for one in judgements if one is not None])


def _judgement(record: CaseRecord, event: StoredEvent, verdicts: dict[int, Json]) -> Judgement | None:
    """None for a result that came late, to no target."""
    standing = event.case_state.get("target")
    made = [one for one in record.artefacts[ArtefactKind.EVALUATION].values() if one.sequence == event.sequence]
    if standing is None or not made:
        return None
    target = record.artefacts[ArtefactKind.TARGET][standing["id"]]
    image_id = str(made[0].columns["image_id"])
    return Judgement(event, made[0].content, image_id, target, verdicts.get(event.sequence, {}))


def _verdicts_by_event(record: CaseRecord) -> dict[int, Json]:
    """Verdicts by their interlock's code, of each judged event: an accepted decision is recorded with its event."""
    judged = [event for event in record.events if event.data.get("told_as") == Trigger.VERIFICATION_PASSED]
    decisions = [one for one in record.decisions if one["accepted"] and one["trigger"] == Trigger.VERIFICATION_PASSED]
    if len(judged) != len(decisions):  # not recorded together, so nobody can say which belong to which
        return {}
    return {
        event.sequence: {verdict["code"]: verdict for verdict in one["verdicts"]}
        for event, one in zip(judged, decisions, strict=True)
    }
