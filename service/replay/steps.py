"""The results of a case in the order in which they were recorded, each with what it was computed from."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from sqlalchemy.engine import Connection

from service.cases import store
from service.cases.records import ArtefactKind, StoredArtefact, StoredCase, StoredEvent
from service.replay.inputs import Evaluated, Json, Planned, Registered, Step, Targeted
from vision.refusal import RefusalCode
from workflow.triggers import Trigger

_COMPUTED = (ArtefactKind.REGISTRATION, ArtefactKind.TARGET, ArtefactKind.PLAN, ArtefactKind.EVALUATION)
_REFUSALS = (Trigger.REGISTRATION_REFUSED, Trigger.VERIFICATION_REFUSED)
_STARTS = (Trigger.IMAGE_ARRIVED, Trigger.NEWEST_IMAGE_REUSED)
_Made = Mapping[ArtefactKind, list[StoredArtefact]]


def steps_of(connection: Connection, case: StoredCase) -> tuple[Step, ...]:
    """Every registration, target, plan and evaluation of a case, refused registrations and evaluations too.

    A refusal for want of time or memory is no result of the bytes and is left out.
    """
    made: dict[int, dict[ArtefactKind, list[StoredArtefact]]] = defaultdict(lambda: defaultdict(list))
    for kind in _COMPUTED:
        for artefact in store.artefacts_of(connection, kind, case.id):
            made[artefact.sequence][kind].append(artefact)
    walk = _Walk(dict(case.devices))
    return tuple(
        step for event in store.all_events(connection, case.id) for step in walk.take(event, made[event.sequence])
    )


@dataclass(frozen=True, slots=True)
class _Start:
    """What image work began with: the devices in force, and the target that a motion had aimed at."""

    devices: Mapping[str, str]
    target_id: str = ""


@dataclass(slots=True)
class _Walk:
    """What is in force at each event."""

    devices: dict[str, str]
    starts: dict[str, _Start] = field(default_factory=dict)

    def take(self, event: StoredEvent, made: _Made) -> Iterator[Step]:
        """The results that came with an event."""
        data, told_as = event.data, event.data.get("told_as")
        if told_as == Trigger.DEVICE_CHANGED:
            self.devices = self.devices | data["devices"]
        elif told_as in _STARTS:
            self.starts[data["image_id"]] = _Start(self.devices, (event.case_state["target"] or {}).get("id", ""))
        elif told_as in _REFUSALS and data["reason"]["code"] in tuple(RefusalCode):
            yield self._refused(event)
        yield from self._images(made)
        yield from (self._target(target) for target in made[ArtefactKind.TARGET])
        yield from (self._plan(plan) for plan in made[ArtefactKind.PLAN])

    def _images(self, made: _Made) -> Iterator[Step]:
        evaluations = {one.content["registration_id"]: one for one in made[ArtefactKind.EVALUATION]}
        for artefact in made[ArtefactKind.REGISTRATION]:
            image_id = str(artefact.columns["image_id"])
            start = self._start(image_id)
            where = f"registrations {artefact.id}"
            first_id = artefact.content.get("nudge", {}).get("first_image_id")
            registered = Registered(where, artefact.id, image_id, first_id, start.devices, dict(artefact.content))
            evaluation = evaluations.get(artefact.id)
            yield registered if evaluation is None else _evaluated(registered, evaluation, start)

    def _refused(self, event: StoredEvent) -> Step:
        image_id, where = event.data["image_id"], f"events {event.case_id}/{event.sequence}"
        start, recorded = self._start(image_id), {"status": "refused", "reason": dict(event.data["reason"])}
        if event.data["told_as"] == Trigger.REGISTRATION_REFUSED:
            first_id = event.data.get("first_image_id")
            return Registered(where, None, image_id, first_id, start.devices, recorded)
        return Evaluated(where, None, image_id, start.target_id, start.devices, recorded)

    def _start(self, image_id: str) -> _Start:
        return self.starts.get(image_id, _Start(self.devices))

    def _target(self, target: StoredArtefact) -> Targeted:
        content = dict(target.content)
        where = f"targets {target.id}"
        return Targeted(where, target.id, content["image_id"], content["registration_id"], self.devices, content)

    def _plan(self, plan: StoredArtefact) -> Planned:
        # Made from view, image, registration and target where it leads onto one; from a view at most where not.
        aimed = len(plan.made_from) > 1
        image_id, target_id = (plan.made_from[1], plan.made_from[3]) if aimed else (None, None)
        return Planned(f"plans {plan.id}", target_id, image_id, self.devices, dict(plan.content))


def _evaluated(registration: Registered, evaluation: StoredArtefact, start: _Start) -> Evaluated:
    figures: Json = {key: value for key, value in evaluation.content.items() if key != "registration_id"}
    where, image_id = f"evaluations {evaluation.id}", registration.image_id
    return Evaluated(where, registration, image_id, start.target_id, start.devices, figures)
