"""Targeting, evaluation, C-arm angles and refusals as JSON, exactly as the command-line contract prints them."""

import math
from typing import TYPE_CHECKING, Any

from vision.refusal import Refusal

if TYPE_CHECKING:  # so that to print C-arm angles takes no image libraries
    from vision.carm_angles import CArmAngles
    from vision.evaluation import AlignmentError, Evaluation
    from vision.motion_agreement import RelativeMotion
    from vision.registered import PredictedError
    from vision.targeting import Targeting
    from vision.two_images import TwoImages


def targeting_to_json(targeting: "Targeting") -> dict[str, Any]:
    """The object of `coaxial target`."""
    return {
        "status": "targeted",
        "target_raw_px": targeting.target_raw_px.tolist(),
        "target_corrected_px": targeting.target_corrected_px.tolist(),
        "guide_from_goal": targeting.guide_from_goal.tolist(),
        "translation_mm": targeting.translation_mm.tolist(),
        "rotation_axis": targeting.rotation_axis.tolist(),
        "rotation_deg": math.degrees(targeting.rotation_rad),
        "predicted_error_95": predicted_error_to_json(targeting.predicted_error_95),
    }


def predicted_error_to_json(predicted: "PredictedError") -> dict[str, float]:
    """The bounds, angle in degrees."""
    return {
        "angle_deg": math.degrees(predicted.angle_rad),
        "position_mm": predicted.position_mm,
        "depth_mm": predicted.depth_mm,
    }


def evaluation_to_json(evaluation: "Evaluation") -> dict[str, Any]:
    """The object of `coaxial evaluate`, without the image's path."""
    image = evaluation.registration.image
    return {
        "status": "evaluated",
        "image": {"sha256": image.sha256, "rows": image.rows, "columns": image.columns},
        "contour": _error_to_json(evaluation.contour)
        | {"predicted_error_95": predicted_error_to_json(evaluation.contour_bounds_95)},
        "paper": _error_to_json(evaluation.paper),
        "paper_centre_corrected": _error_to_json(evaluation.paper_corrected),
        "difference": _error_to_json(evaluation.difference),
        "difference_limit": _error_to_json(evaluation.limit),
        "agree": evaluation.agree,
    }


def two_images_to_json(compared: "TwoImages") -> dict[str, Any]:
    """What moved between two images, for the object of an evaluation."""
    motion, anatomy = compared.motion, compared.anatomy
    return {
        "motion_agreement": {
            "chi_square": motion.chi_square,
            "limit": motion.limit,
            "difference": relative_motion_to_json(motion.difference),
            "detectable": relative_motion_to_json(motion.detectable),
        },
        "anatomy_shift": {
            "measured": anatomy.is_measured,
            "across_mm": anatomy.across_mm,
            "along_mm": anatomy.along_mm,
            "across_sd_mm": anatomy.across_sd_mm,
            "correlation": anatomy.correlation,
        },
    }


def relative_motion_to_json(motion: "RelativeMotion") -> dict[str, float]:
    """A motion of the C-arm against the arm's base, the turn in degrees."""
    return {
        "rotation_deg": math.degrees(motion.rotation_rad),
        "across_mm": motion.across_mm,
        "along_mm": motion.along_mm,
    }


def _error_to_json(error: "AlignmentError") -> dict[str, float]:
    return {"angle_error_deg": math.degrees(error.angle_rad), "position_error_mm": error.position_mm}


def carm_angles_to_json(angles: "CArmAngles") -> dict[str, Any]:
    """The object of `coaxial plan-carm`."""
    return {
        "status": "planned",
        "primary_angle_deg": math.degrees(angles.primary_rad),
        "secondary_angle_deg": math.degrees(angles.secondary_rad),
        "rotation_from_vertical_deg": math.degrees(angles.rotation_from_vertical_rad),
        "angulation_from_vertical_deg": math.degrees(angles.angulation_from_vertical_rad),
        "orbital_deg": math.degrees(angles.orbital_rad),
        "tilt_deg": math.degrees(angles.tilt_rad),
        "words": angles.words,
    }


def refusal_to_json(refusal: Refusal) -> dict[str, Any]:
    """The object that every command prints instead of its own when it refuses, without the image."""
    return {
        "status": "refused",
        "reason": {
            "code": refusal.code.value,
            "message": refusal.message,
            "measured": _finite_or_none(refusal.measured),
            "limit": _finite_or_none(refusal.limit),
        },
    }


def _finite_or_none(value: float | None) -> float | None:
    """JSON has no NaN and no infinity."""
    return value if value is not None and math.isfinite(value) else None
