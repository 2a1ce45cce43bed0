"""An image arrived: whose it is, whether it was asked for, what it is for (H01, H02, H04, H28)."""

import math
import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.cases import store
from service.conductor.conductor import Conductor
from service.conductor.taking import Prepared, Standing, Taken
from service.conductor.verdict_json import plain_verdict
from service.database import tables
from service.errors import ErrorCode, ServiceError
from service.images.store import (
    NewPurpose,
    StoredImage,
    assign_purpose,
    awaits_statement,
    purpose_of,
    read_image,
)
from service.motion.exposures import Exposure
from workflow.decisions import Decision, ImageUse
from workflow.facts import ImageArrived
from workflow.triggers import Trigger

# HHMMSS.FFFFFF; a sender's time of another form is no time, and must not end the taking in of images.
_TIME = re.compile(r"([0-9]{2})([0-9]{2})([0-9]{2}(?:\.[0-9]{0,6})?)")
_Time = tuple[str, float]


@dataclass(frozen=True, slots=True)
class Statement:
    """What a person says of an image that names nobody: the patient, that it is of this view and exposure, what for."""

    patient_id: str
    view_id: str | None
    window_id: str | None
    purpose: ImageUse | None
    user_id: str


def take_in(conductor: Conductor, image_id: str) -> Taken | None:
    """Give an image its purpose in the open case, else in the one that is over and that it belongs to; None if none."""
    case_id = conductor.open_case() or _late_for(conductor, image_id)
    if case_id is None:
        with conductor.parts.database.write() as connection:
            assign_purpose(connection, NewPurpose(image_id, None, ImageUse.UNASSIGNED, {}, ()))
        return None
    return conductor.observe(case_id, Trigger.IMAGE_ARRIVED, lambda standing: _prepare(conductor, standing, image_id))


def take_in_stated(conductor: Conductor, case_id: str, image_id: str, statement: Statement) -> Taken:
    """Give an image its purpose by a person's statement, in a case that is over too.

    ServiceError IMAGE_UNKNOWN, IMAGE_NAMED, IMAGE_TAKEN_IN, STATEMENT_OUTDATED where view or exposure are others, or
    PURPOSE_REFUSED where it turns out to be for something else.
    """

    def prepare(standing: Standing) -> Prepared:
        _check_statement(standing, image_id, statement)
        return _prepare(conductor, standing, image_id, statement)

    return conductor.observe(case_id, Trigger.IMAGE_ARRIVED, prepare, statement.user_id)


def _check_statement(standing: Standing, image_id: str, statement: Statement) -> None:
    if not awaits_statement(read_image(standing.connection, image_id)):
        raise ServiceError(ErrorCode.IMAGE_NAMED, "the image names patient, study and itself")
    if purpose_of(standing.connection, image_id) is not None:
        raise ServiceError(ErrorCode.IMAGE_TAKEN_IN, "what the image is for was decided already")
    view, window = standing.case.view, standing.case.window
    if (statement.view_id, statement.window_id) != (view and view.id, window and window.id):
        raise ServiceError(ErrorCode.STATEMENT_OUTDATED, "the view or the requested exposure is another one now")


def _late_for(conductor: Conductor, image_id: str) -> str | None:
    """The newest case of the room with the image's patient and study, though it is over."""
    cases = tables.cases.c
    with conductor.parts.database.read() as connection:
        image = read_image(connection, image_id)
        same = (cases.patient_id == image.patient_id, cases.study_uid == image.study_uid)
        query = sa.select(cases.id).where(cases.room == conductor.parts.settings.room, *same)
        return connection.execute(query.order_by(cases.opened_at.desc()).limit(1)).scalar()


def _prepare(conductor: Conductor, standing: Standing, image_id: str, statement: Statement | None = None) -> Prepared:
    image = read_image(standing.connection, image_id)
    window = standing.case.window
    exposure = conductor.bridge.watch.exposure_of_window(window.id) if window is not None else None
    facts = facts_of(standing, image, exposure)
    if statement is not None:
        facts = _with_statement(standing, facts, image, statement)

    def assign(connection: Connection, decision: Decision) -> None:
        purpose = _purpose(decision.image_use or ImageUse.UNASSIGNED, statement.purpose if statement else None)
        entered = purpose in (ImageUse.REGISTRATION, ImageUse.VERIFICATION)
        if entered and window is not None:
            conductor.bridge.watch.assign_exposure(window.id, image_id)
        arm = _pose_json(exposure) if entered and exposure is not None else {}
        verdicts = tuple(map(plain_verdict, decision.verdicts))
        assign_purpose(connection, NewPurpose(image_id, standing.case.case_id, purpose, arm, verdicts))

    data: dict[str, Any] = {"image_id": image_id, "problem": image.problem}
    if statement is not None:
        data["identity_by_statement"] = asdict(statement)
    return Prepared(facts, made={"image": image_id}, data=data, also=assign)


def _purpose(found: ImageUse, stated: ImageUse | None) -> ImageUse:
    """What an image is for: what the procedure makes of it, and of one that it has no use for what a person says."""
    if stated in (None, found) or found is ImageUse.QUARANTINED:
        return found
    if found is ImageUse.UNASSIGNED and stated in (ImageUse.SCOUT, ImageUse.DEPTH_CHECK):
        return ImageUse(stated)
    raise ServiceError(ErrorCode.PURPOSE_REFUSED, "an image of now is for something else", measured=stated, limit=found)


def facts_of(standing: Standing, image: StoredImage, exposure: Exposure | None) -> ImageArrived:
    """What the record tells of an image, against a case and the images before it."""
    connection = standing.connection
    case = store.read_case(connection, standing.case.case_id)
    usable = image.problem is None  # of an image that is none, nothing is known that could pass
    return ImageArrived(
        image_id=image.id,
        patient_matches=image.patient_id == case.patient_id if image.patient_id and usable else None,
        study_matches=image.study_uid == case.study_uid if image.study_uid and usable else None,
        sop_uid_unseen=_unseen(connection, image, "sop_uid") if usable else None,
        pixels_unseen=_unseen(connection, image, "pixel_sha256") if usable else None,
        newer_by_carm_clock=_newer(connection, image, case.id),
        moved_mm=exposure.largest.offset_mm if exposure else None,
        moved_rad=exposure.largest.angle_rad if exposure else None,
    )


def _with_statement(standing: Standing, facts: ImageArrived, image: StoredImage, statement: Statement) -> ImageArrived:
    """What the image does not say itself, by the word of a person; what it says stands, and pixels must be new.

    That view and exposure are the present ones was checked: a person says that the image is of now.
    """
    patient_id = store.read_case(standing.connection, standing.case.case_id).patient_id
    same_patient = statement.patient_id == patient_id
    return replace(
        facts,
        patient_matches=same_patient if image.patient_id is None else facts.patient_matches and same_patient,
        study_matches=same_patient if image.study_uid is None else facts.study_matches,
        sop_uid_unseen=facts.pixels_unseen if image.sop_uid is None else facts.sop_uid_unseen,
        newer_by_carm_clock=True if facts.newer_by_carm_clock is None else facts.newer_by_carm_clock,
    )


def _unseen(connection: Connection, image: StoredImage, column: str) -> bool | None:
    """Whether no earlier usable image has the same; None if this one does not say."""
    value = getattr(image, column)
    if value is None:
        return None
    images = tables.images
    earlier = (images.c.position < image.position, images.c.problem.is_(None))
    query = sa.select(1).where(images.c[column] == value, *earlier)
    return connection.execute(query.limit(1)).first() is None


def _newer(connection: Connection, image: StoredImage, case_id: str) -> bool | None:
    """Whether the C-arm's own clock has passed every image of the case; its offset from ours is never trusted (H02).

    Every one, taken into the chain or not: an old image that was refused lets no other old one in behind it. The first
    image of a case is held against the C-arm's last one before it.
    """
    taken = _carm_time(image.metadata)
    if taken is None:
        return None
    of_case = max(_times(connection, image, case_id), default=None)
    newest = of_case or next(_times(connection, image, None), None)
    return newest is None or taken > newest


def _times(connection: Connection, image: StoredImage, case_id: str | None) -> Iterator[_Time]:
    """When the same C-arm took what arrived before an image, last first: in one case, or ever."""
    images, purposes = tables.images, tables.image_purposes
    query = sa.select(images.c.metadata).where(images.c.position < image.position, images.c.problem.is_(None))
    if case_id is not None:
        query = query.join(purposes, purposes.c.image_id == images.c.id).where(purposes.c.case_id == case_id)
    for metadata in connection.execute(query.order_by(images.c.position.desc())).scalars():
        told = _carm_time(metadata)
        if told is not None and metadata.get("station") == image.metadata.get("station"):
            yield told


def _carm_time(metadata: Any) -> _Time | None:
    """Date and seconds of the acquisition, of the content where the acquisition is not told."""
    for kind in ("acquisition", "content"):
        day, time = metadata.get(f"{kind}_date"), metadata.get(f"{kind}_time")
        if day and time and (told := _TIME.fullmatch(time.strip())):
            hours, minutes, seconds = told.groups()
            return str(day), int(hours) * 3600 + int(minutes) * 60 + float(seconds)
    return None


def _pose_json(exposure: Exposure) -> dict[str, Any]:
    """The arm during the exposure: the pose that the goal is composed from."""
    arm = exposure.latched
    return {
        "base_from_tcp": arm.base_from_tcp.tolist(),
        "joints_rad": arm.joints_rad.tolist(),
        "controller_time_s": arm.controller_time_s,
        "moved_mm": exposure.largest.offset_mm,
        "moved_deg": math.degrees(exposure.largest.angle_rad),
    }
