"""Interlocks of an arriving image, of the registration made from it and of the target picked in it."""

from collections.abc import Callable
from typing import TypeVar

from workflow.checks import Interlock, bounded, enough, given, id_of, same, since, yes, young
from workflow.facts import (
    CorrectionRequested,
    ImageArrived,
    NewestImageReused,
    RegistrationCompleted,
    RegistrationQuality,
    TargetConfirmed,
)
from workflow.findings import Finding, at_least
from workflow.inquiry import Inquiry
from workflow.triggers import Trigger

T = TypeVar("T")
_EXPOSE = (Trigger.EXPOSURE_REQUESTED,)
_RETAKE = (Trigger.RETAKE,)
_REGISTER = (Trigger.REGISTRATION_COMPLETED,)


def _quality(value: Callable[[RegistrationQuality], T | None]) -> Callable[[Inquiry], T | None]:
    """Picks from the registration of an image, or from that of a verification image that becomes one."""

    def pick(inquiry: Inquiry) -> T | None:
        facts = inquiry.given(RegistrationCompleted) or inquiry.given(CorrectionRequested)
        return None if facts is None else value(facts.quality)

    return pick


def _plate(inquiry: Inquiry) -> Finding:
    """A flat panel needs no plate, but whether one is needed must be known."""
    required = _quality(lambda q: q.plate_required)(inquiry)
    balls = _quality(lambda q: q.plate_balls)(inquiry)
    if required is False:
        return Finding(True, balls, 0, "balls")
    return at_least(balls if required else None, inquiry.limits.plate_balls, "balls")


PATIENT_MATCHES = Interlock(
    "patient_matches",
    "H01",
    "another patient's image",
    yes(given(ImageArrived, lambda i: i.patient_matches)),
    asks=True,
)
STUDY_MATCHES = Interlock(
    "study_matches", "H01", "an image of another study", yes(given(ImageArrived, lambda i: i.study_matches)), asks=True
)
IMAGE_UNSEEN = Interlock(
    "image_unseen", "H02", "this image came before", yes(given(ImageArrived, lambda i: i.sop_uid_unseen)), asks=True
)
PIXELS_UNSEEN = Interlock(
    "pixels_unseen", "H02", "these pixels came before", yes(given(ImageArrived, lambda i: i.pixels_unseen)), asks=True
)
IMAGE_NEWER = Interlock(
    "image_newer",
    "H02",
    "not newer than the previous image by the C-arm's own clock",
    yes(given(ImageArrived, lambda i: i.newer_by_carm_clock)),
    asks=True,
)
WINDOW_OPEN = Interlock(
    "window_open",
    "H02",
    "no exposure was requested in time",
    since(lambda i: i.case.window.opened_s if i.case.window else None, lambda limits: limits.exposure_window_s),
    _EXPOSE,
    asks=True,
)
STILL_MM = Interlock(
    "still_mm",
    "H04",
    "the guide moved between the exposure request and the image",
    bounded(given(ImageArrived, lambda i: i.moved_mm), lambda limits: limits.unaccounted_mm, "mm"),
    _EXPOSE,
    asks=True,
)
STILL_RAD = Interlock(
    "still_rad",
    "H04",
    "the guide turned between the exposure request and the image",
    bounded(given(ImageArrived, lambda i: i.moved_rad), lambda limits: limits.unaccounted_rad, "rad"),
    _EXPOSE,
    asks=True,
)
IMAGE_AFTER_MOTION = Interlock(
    "image_after_motion",
    "H28",
    "the exposure was not requested after this motion came to rest",
    same(lambda i: i.case.window.motion_id if i.case.window else None, lambda i: id_of(i.case.motion)),
    _EXPOSE,
    asks=True,
)
NEWEST_IMAGE = Interlock(
    "newest_image",
    "H02",
    "not the newest image, or something moved since",
    same(given(NewestImageReused, lambda i: i.image_id), lambda i: i.case.newest_image_id),
    _EXPOSE,
    asks=True,
)
GUIDE_IN_IMAGE = Interlock(
    "guide_in_image",
    "H07",
    "the guide is not in that image",
    yes(given(NewestImageReused, lambda i: i.guide_in_image)),
    _EXPOSE,
    asks=True,
)
HANDEDNESS = Interlock(
    "handedness", "H05", "the image may be mirrored", yes(_quality(lambda q: q.handedness_proved)), _RETAKE, asks=True
)
PLATE = Interlock("plate", "H06", "too little of the distortion plate was found", _plate, _RETAKE, asks=True)
SCALE = Interlock(
    "scale",
    "H06",
    "the pixel scale does not fit the C-arm file",
    bounded(_quality(lambda q: q.scale_error), lambda limits: limits.scale_error, ""),
    _RETAKE,
    asks=True,
)
FIDUCIALS = Interlock(
    "fiducials",
    "H07",
    "not every fiducial was found",
    enough(_quality(lambda q: q.fiducials), lambda limits: limits.fiducials, "fiducials"),
    _RETAKE,
    asks=True,
)
RESIDUAL = Interlock(
    "residual",
    "H07",
    "the guide does not fit the image",
    bounded(_quality(lambda q: q.residual_rms_px), lambda limits: limits.residual_rms_px, "px"),
    _RETAKE,
    asks=True,
)
PREDICTED_ANGLE = Interlock(
    "predicted_angle",
    "H07",
    "the registration does not determine the direction well enough",
    bounded(_quality(lambda q: q.predicted_angle_rad), lambda limits: limits.angle_error_rad, "rad"),
    _RETAKE,
    asks=True,
)
PREDICTED_POSITION = Interlock(
    "predicted_position",
    "H07",
    "the registration does not determine the position well enough",
    bounded(_quality(lambda q: q.predicted_position_mm), lambda limits: limits.position_error_mm, "mm"),
    _RETAKE,
    asks=True,
)
IMAGE_AGE = Interlock(
    "image_age",
    "H03",
    "the image is old: nothing sees whether the C-arm was moved since",
    young(lambda s: s.image_exposed, lambda limits: limits.image_age_s),
    _RETAKE,
    hard=lambda limits: limits.image_age_hard_s,
)
TARGET_ECHO = Interlock(
    "target_echo",
    "H08",
    "the target was not drawn back and confirmed",
    yes(given(TargetConfirmed, lambda t: t.echo_seen)),
    asks=True,
)
TARGET_IMAGE = Interlock(
    "target_image",
    "H22",
    "the target was picked in another image",
    same(given(TargetConfirmed, lambda t: t.image_id), lambda i: id_of(i.case.image)),
    asks=True,
)
TARGET_REGISTRATION = Interlock(
    "target_registration",
    "H22",
    "the target was picked with another registration",
    same(given(TargetConfirmed, lambda t: t.registration_id), lambda i: id_of(i.case.registration)),
    _REGISTER,
    asks=True,
)
