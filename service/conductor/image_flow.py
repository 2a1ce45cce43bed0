"""From an arriving image to a registration or an evaluation: one image after the other, off the event loop."""

import asyncio
import base64
import math
from collections.abc import Callable
from functools import partial

import structlog

from service.cases import store
from service.cases.records import ArtefactKind, NewArtefact
from service.conductor.arrival import take_in
from service.conductor.conductor import Conductor, new_id
from service.conductor.image_work import Json, evaluate_image, quality_of, register_image
from service.conductor.taking import Prepared, Taken
from service.conductor.unusable import what_to_do
from service.errors import ErrorCode, ServiceError
from service.images.findings import findings_key, keep_findings
from service.images.store import images_without_purpose
from workflow.decisions import Effect
from workflow.facts import Evaluated, RegistrationCompleted, RegistrationRefused, VerificationRefused
from workflow.triggers import Trigger

_log = structlog.get_logger(__name__)
# A try waits for the database by itself; together they last about as long as an exposure's window is open.
_BUSY_TRIES = 6
_BUSY_PAUSE_S = 1.0


class ImageFlow:
    """Takes image ids from the receiver's threads."""

    def __init__(self, conductor: Conductor) -> None:
        self._conductor = conductor
        self._arrived: asyncio.Queue[str] = asyncio.Queue()
        self._work: asyncio.Queue[Taken] = asyncio.Queue()
        self._loop = asyncio.get_running_loop()
        conductor.on_effect[Effect.REGISTRATION_STARTS] = self._start
        conductor.on_effect[Effect.EVALUATION_STARTS] = self._start

    def stored(self, image_id: str) -> None:
        """An image is stored; from any thread."""
        self._loop.call_soon_threadsafe(self._arrived.put_nowait, image_id)

    async def take_in_all(self) -> None:
        """Give every arriving image its purpose, first those that arrived while nobody could; until cancelled."""
        for image_id in await asyncio.to_thread(self._left_over):
            self._arrived.put_nowait(image_id)
        while True:
            image_id = await self._arrived.get()
            try:
                await self._take_in(image_id)
            except ServiceError as error:
                _log.error("image_not_taken_in", image_id=image_id, code=error.code)
            except Exception:  # noqa: BLE001  a defect met with one image must not shut out every image after it
                _log.exception("image_not_taken_in", image_id=image_id)

    async def work_through(self) -> None:
        """Register and evaluate what entered a chain; until cancelled."""
        while True:
            taken = await self._work.get()
            case_id, image_id = taken.event.case_id, taken.prepared.made["image"]
            try:
                if Effect.EVALUATION_STARTS in taken.decision.effects:
                    await self._evaluate(taken, case_id, image_id)
                else:
                    await self._register(case_id, image_id)
            except ServiceError as error:
                _log.error("image_result_not_recorded", image_id=image_id, code=error.code)
            except Exception:  # noqa: BLE001  as above; the case may retake
                _log.exception("image_result_not_recorded", image_id=image_id)

    async def _take_in(self, image_id: str) -> None:
        await _until_free(lambda: take_in(self._conductor, image_id), image_id)

    def _start(self, taken: Taken) -> None:
        self._loop.call_soon_threadsafe(self._work.put_nowait, taken)

    def _left_over(self) -> list[str]:
        with self._conductor.parts.database.read() as connection:
            return images_without_purpose(connection)

    async def _register(self, case_id: str, image_id: str) -> None:
        try:
            result = await register_image(self._conductor, case_id, image_id)
        except ServiceError as error:
            result = _failed(error)
        if result["status"] == "refused":
            refused = RegistrationRefused(image_id, result["reason"]["code"])
            await self._observe(case_id, Trigger.REGISTRATION_REFUSED, _refused(refused, result))
            return
        facts = RegistrationCompleted(new_id(), image_id, quality_of(result))
        artefact = registration_artefact(facts.registration_id, image_id, result)
        made = {"registration": facts.registration_id}
        prepared = Prepared(facts, (artefact,), made, {"image_id": image_id, **_summary(result)})
        await self._observe(case_id, Trigger.REGISTRATION_COMPLETED, prepared)

    async def _evaluate(self, taken: Taken, case_id: str, image_id: str) -> None:
        try:
            target = await asyncio.to_thread(self._target, taken)
            result = await evaluate_image(self._conductor, case_id, image_id, target)
        except ServiceError as error:
            result = _failed(error)
        if result["status"] == "refused":
            refused = VerificationRefused(image_id, result["reason"]["code"])
            await self._observe(case_id, Trigger.VERIFICATION_REFUSED, _refused(refused, result))
            return
        await self._observe(case_id, Trigger.VERIFICATION_PASSED, evaluation_of(image_id, result))

    async def _observe(self, case_id: str, trigger: Trigger, prepared: Prepared) -> None:
        observe = partial(self._conductor.observe, case_id, trigger, lambda _: prepared)
        await _until_free(observe, prepared.data["image_id"])

    def _target(self, taken: Taken) -> Json:
        """The target that the motion aimed at."""
        target = taken.decision.after.target
        with self._conductor.parts.database.read() as connection:
            artefact = store.read_artefact(connection, ArtefactKind.TARGET, target.id if target else "")
            return dict(artefact.content)


async def _until_free(record: Callable[[], object], image_id: str) -> None:
    """Record something of an image, again and again while another writer has the database; what follows waits."""
    for tries_left in reversed(range(_BUSY_TRIES)):
        try:
            await asyncio.to_thread(record)
        except ServiceError as error:
            if error.code != ErrorCode.DATABASE_BUSY or tries_left == 0:
                raise
            _log.warning("image_recorded_later", image_id=image_id, code=error.code)
            await asyncio.sleep(_BUSY_PAUSE_S)
        else:
            return


def _refused(facts: RegistrationRefused | VerificationRefused, result: Json) -> Prepared:
    """A refused image; the picture of what was found in it, where image work came to one, commits with the refusal."""
    reason = result["reason"]
    data = {"image_id": facts.image_id, "reason": reason, "what_to_do": what_to_do(reason["code"])}
    data |= {name: result[name] for name in ("first_image_id",) if name in result}  # of a nudge
    encoded = result.get("findings_png_base64")
    if encoded is None:
        return Prepared(facts, data=data)
    picture = base64.b64decode(encoded)
    return Prepared(
        facts, data=data | findings_key(picture), also=lambda connection, _: keep_findings(connection, picture)
    )


def registration_artefact(registration_id: str, image_id: str, result: Json) -> NewArtefact:
    """A registration as it is recorded."""
    return NewArtefact(ArtefactKind.REGISTRATION, registration_id, (image_id,), result, {"image_id": image_id})


def evaluation_of(image_id: str, result: Json) -> Prepared:
    """An evaluation; whether it passes the rules say, from the figures with their bounds.

    The contour registration inside is recorded as one of its own: a correction starts from it.
    """
    contour, bounds = result["contour"], result["contour"]["predicted_error_95"]
    anatomy, motion = result["anatomy_shift"], result["motion_agreement"]
    facts = Evaluated(
        evaluation_id=new_id(),
        image_id=image_id,
        angle_error_rad=math.radians(contour["angle_error_deg"]),
        angle_bound_rad=math.radians(bounds["angle_deg"]),
        position_error_mm=contour["position_error_mm"],
        position_bound_mm=bounds["position_mm"],
        agree=result["agree"],
        motion_chi_square=motion["chi_square"],
        anatomy_across_mm=anatomy["across_mm"] if anatomy["measured"] else None,
        anatomy_along_mm=anatomy["along_mm"] if anatomy["measured"] else None,
    )
    registration = registration_artefact(new_id(), image_id, result["registration"])
    figures = {key: value for key, value in result.items() if key != "registration"}
    content = figures | {"registration_id": registration.id}
    columns = {"image_id": image_id}
    made_from = (image_id, registration.id)
    evaluation = NewArtefact(ArtefactKind.EVALUATION, facts.evaluation_id, made_from, content, columns)
    made = {"evaluation": facts.evaluation_id, "registration": registration.id}
    data, limits = {"image_id": image_id, **figures}, {"motion_chi_square": motion["limit"]}
    return Prepared(facts, (registration, evaluation), made, data, limits=limits)


def _summary(result: Json) -> Json:
    kept = ("residual_rms_px", "predicted_error_95", "elapsed_ms", "handedness_by", "nudge")
    return {key: result[key] for key in kept if key in result} | {"balls": result["distortion"].get("balls")}


def _failed(error: ServiceError) -> Json:
    """Image work that failed is no registration either: the reason says what to do."""
    reason = {"code": error.code, "message": error.message, "measured": error.measured, "limit": error.limit}
    return {"status": "refused", "reason": reason}
