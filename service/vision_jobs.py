"""What the image worker can do: functions of `vision` on bytes, answers as JSON. Runs in the worker process only.

The shapes are those of the command line: a refusal is `{"status": "refused", "reason": {...}}`.
"""

import base64
import hashlib
import math
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import cv2
import numpy as np

from service.report.figures import draw_figures as drawn_figures
from service.report.typesetting import typeset as set_report
from service.vision_echo import draw_point
from service.vision_overlay import outlines
from vision import carm_angles as angles
from vision.devices import CArm, Guide, read_carm, read_guide
from vision.drawing import draw, png
from vision.evaluation import evaluate_registration
from vision.findings import Findings
from vision.handedness import prove_handedness
from vision.inspection import inspect
from vision.motion_agreement import MotionErrors, detectable_motion
from vision.refusal import Refusal
from vision.registered import PixelSpace, Registration
from vision.registration import examine
from vision.registration import register as find_guide
from vision.registration_json import from_json, to_json
from vision.result_json import (
    carm_angles_to_json,
    evaluation_to_json,
    refusal_to_json,
    relative_motion_to_json,
    targeting_to_json,
    two_images_to_json,
)
from vision.targeting import target as aim
from vision.two_images import Before, compare_images
from vision.xray import XrayImage, decode, stored_pixels

Json = dict[str, Any]

# Where the cores are busy, threads mostly wait for one another; guard and service need theirs (H32).
cv2.setNumThreads(1)


def register(image: bytes, guide: bytes, carm: bytes, handedness_proved: bool = False) -> Json:
    """Find the guide in an image; a refusal comes with a picture of what was found.

    `handedness_proved`: a nudge has shown that this C-arm connection does not mirror (H05).
    """
    decoded = decode(image)
    if isinstance(decoded, Refusal):
        return refusal_to_json(decoded)
    guide_file, carm_file = read_guide(guide), read_carm(carm)
    findings = examine(decoded, guide_file, carm_file, handedness_proved=handedness_proved)
    if isinstance(findings.result, Registration):
        return _registration_json(findings.result)
    return refusal_to_json(findings.result) | _picture(decoded, guide_file, carm_file, findings)


def annotate(
    image: bytes,
    guide: bytes,
    carm: bytes,
    raw_px: tuple[float, float] | None,
    depth_mm: float,
    handedness_proved: bool,
) -> Json:
    """The picture of what is found in an image, with the target where there is one, as those who look later see it.

    `handedness_proved` as it was when the image was registered.
    """
    decoded = decode(image)
    if isinstance(decoded, Refusal):
        return refusal_to_json(decoded)
    guide_file, carm_file = read_guide(guide), read_carm(carm)
    findings = examine(decoded, guide_file, carm_file, handedness_proved=handedness_proved)
    inspection = inspect(decoded, guide_file, carm_file, findings, raw_px, PixelSpace.RAW, depth_mm)
    return {"status": "drawn", "picture_png_base64": base64.b64encode(png(draw(inspection))).decode()}


def handedness(
    first: bytes, second: bytes, guide: bytes, carm: bytes, before_from_after: list[list[float]], errors: Json
) -> Json:
    """The second image's registration, where the two prove with the arm's motion that nothing mirrors them (H05)."""
    before, after = (_unproved(image, guide, carm) for image in (first, second))
    if isinstance(before, Refusal):
        return refusal_to_json(before)
    if isinstance(after, Refusal):
        return refusal_to_json(after)
    proof = prove_handedness(before, after, np.array(before_from_after), _motion_errors(errors))
    if isinstance(proof, Refusal):
        return refusal_to_json(proof)
    return _registration_json(after) | {"nudge": asdict(proof)}


def _registration_json(registration: Registration) -> Json:
    """Without a bead there is none unless a nudge proved its handedness, which it says."""
    return to_json(registration) | ({"handedness_by": "nudge"} if registration.guide.bead is None else {})


def _unproved(image: bytes, guide: bytes, carm: bytes) -> Registration | Refusal:
    """A registration whose handedness is still to be proved."""
    decoded = decode(image)
    if isinstance(decoded, Refusal):
        return decoded
    return find_guide(decoded, read_guide(guide), read_carm(carm), handedness_proved=True)


def target(registration: Json, raw_px: tuple[float, float], depth_mm: float, errors: Json) -> Json:
    """Where the guide must go, and what else that moves meanwhile the next image will see."""
    registered = from_json(registration)
    result = aim(registered, raw_px, PixelSpace.RAW, depth_mm)
    if isinstance(result, Refusal):
        return refusal_to_json(result)
    detectable = detectable_motion(registered, result.guide_from_goal, _motion_errors(errors))
    return targeting_to_json(result) | {"detectable_motion": relative_motion_to_json(detectable)}


def evaluate(
    image: bytes, guide: bytes, carm: bytes, raw_px: tuple[float, float], depth_mm: float, before: Json
) -> Json:
    """How well the guide points, what else moved, and this image's contour registration for a correction.

    A refusal comes with a picture of what was found. `before` holds the `image` from which the move was planned, its
    `registration`, the guide's motion since by the arm (`before_from_after`), its standard deviations (`errors`) and
    whether a nudge proved the connection's handedness (`handedness_proved`).
    """
    decoded, first = decode(image), decode(before["image"])
    if isinstance(decoded, Refusal):
        return refusal_to_json(decoded)
    if isinstance(first, Refusal):
        return refusal_to_json(first)
    guide_file, carm_file = read_guide(guide), read_carm(carm)
    findings = examine(decoded, guide_file, carm_file, handedness_proved=before["handedness_proved"])
    result = _compared(findings, first, raw_px, depth_mm, before)
    if isinstance(result, Refusal):
        return refusal_to_json(result) | _picture(decoded, guide_file, carm_file, findings)
    return result


def _compared(
    findings: Findings,
    first: XrayImage,
    raw_px: tuple[float, float],
    depth_mm: float,
    before: Json,
) -> Json | Refusal:
    """The evaluation's answer by this image's registration and the image before it."""
    registered, corrected = findings.result, findings.corrected
    if isinstance(registered, Refusal):
        return registered
    if corrected is None:
        raise ValueError("a registration without the corrected image that it was made in")
    result = evaluate_registration(registered, raw_px, PixelSpace.RAW, depth_mm)
    if isinstance(result, Refusal):
        return result
    motion = np.array(before["before_from_after"])
    known = Before(first, from_json(before["registration"]), motion, _motion_errors(before["errors"]))
    compared = compare_images(known, corrected, registered, raw_px, depth_mm)
    if isinstance(compared, Refusal):
        return compared
    return evaluation_to_json(result) | two_images_to_json(compared) | {"registration": _registration_json(registered)}


def _picture(image: XrayImage, guide: Guide, carm: CArm, findings: Findings) -> Json:
    picture = png(draw(inspect(image, guide, carm, findings)))
    return {"findings_png_base64": base64.b64encode(picture).decode()}


def _motion_errors(errors: Json) -> MotionErrors:
    return MotionErrors(
        arm_rad=math.radians(errors["arm_sd_deg"]),
        arm_mm=errors["arm_sd_mm"],
        tcp_rad=math.radians(errors["tcp_sd_deg"]),
        tcp_mm=errors["tcp_sd_mm"],
    )


def carm_angles(entry_mm: tuple[float, ...], target_mm: tuple[float, ...], position: str) -> Json:
    """The C-arm's angles in which a planned path projects to a point (patient LPS)."""
    result = angles.carm_angles(np.array(entry_mm), np.array(target_mm), angles.Position(position))
    return refusal_to_json(result) if isinstance(result, Refusal) else carm_angles_to_json(result)


def echo(image: bytes, registration: Json, pixel: tuple[float, float], space: str) -> Json:
    """A picked point in both grids, drawn back into its image (H08)."""
    decoded = decode(image)
    if isinstance(decoded, Refusal):
        return refusal_to_json(decoded)
    aimed = aim(from_json(registration), pixel, PixelSpace(space))
    if isinstance(aimed, Refusal):
        return refusal_to_json(aimed)
    raw_px = (float(aimed.target_raw_px[0]), float(aimed.target_raw_px[1]))
    points = {"raw_px": list(raw_px), "corrected_px": aimed.target_corrected_px.tolist()}
    return {"status": "drawn"} | points | draw_point(decoded.pixels, raw_px)


def identify(image: bytes) -> Json:
    """The size of a PNG or TIFF and the hash of its pixels, as an uncompressed DICOM image of them has it (H02)."""
    pixels = stored_pixels(image)
    if isinstance(pixels, Refusal):
        return refusal_to_json(pixels)
    rows, columns = pixels.shape
    values = np.ascontiguousarray(pixels, dtype=pixels.dtype.newbyteorder("<"))
    sha256 = hashlib.sha256(values.tobytes()).hexdigest()
    return {"status": "identified", "rows": rows, "columns": columns, "pixel_sha256": sha256}


def pixels(image: bytes) -> Json:
    """Every pixel with all its bits: rows of little-endian unsigned 16-bit numbers, dark where absorbed."""
    decoded = decode(image)
    if isinstance(decoded, Refusal):
        return refusal_to_json(decoded)
    steps = np.rint(decoded.pixels * np.float32(2**decoded.bits - 1)).astype("<u2")
    size = {"rows": decoded.rows, "columns": decoded.columns, "bits": decoded.bits}
    return {"status": "decoded"} | size | {"pixels": steps.tobytes()}


def overlay(image: bytes, registration: Json, targets: list[Json]) -> Json:
    """What was found in an image, and its targets, as lines in its raw pixels."""
    decoded = decode(image)
    if isinstance(decoded, Refusal):
        return refusal_to_json(decoded)
    lines = outlines(decoded, from_json(registration), targets)
    return refusal_to_json(lines) if isinstance(lines, Refusal) else {"status": "drawn"} | lines


def draw_figures(images: list[Json]) -> Json:
    """The images of a target's page in a report, each as SVG, or None where it cannot be drawn."""
    return {"status": "drawn", "figures": drawn_figures(images)}


def typeset(document: Json, pictures: dict[str, str], dated: str) -> Json:
    """A report as PDF; in this process, whose low priority no heartbeat waits for (H32)."""
    return {"status": "set", "pdf": set_report(document, pictures, dated)}


_REPORT_JOBS = (draw_figures, typeset)
_JOBS = (register, annotate, handedness, target, evaluate, carm_angles, echo, identify, pixels, overlay, *_REPORT_JOBS)
JOBS: dict[str, Callable[..., Json]] = {job.__name__: job for job in _JOBS}
