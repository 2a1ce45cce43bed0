"""What `vision` returns when the image or the geometry says no."""

from dataclasses import dataclass
from enum import StrEnum


class RefusalCode(StrEnum):
    """Stable reasons for a refusal; scripts and the README rely on the names."""

    NO_GUIDE_FOUND = "no_guide_found"
    GUIDE_CUT_OFF = "guide_cut_off"
    RING_MISSING = "ring_missing"
    LINE_MISSING = "line_missing"
    BEAD_MISSING = "bead_missing"
    MIRRORED = "mirrored"
    HANDEDNESS_UNPROVED = "handedness_unproved"
    PLATE_MISSING = "plate_missing"
    PLATE_TOO_SPARSE = "plate_too_sparse"
    PLATE_UNEXPECTED = "plate_unexpected"
    SCALE_MISMATCH = "scale_mismatch"
    RESIDUAL_TOO_HIGH = "residual_too_high"
    PREDICTED_ERROR_TOO_HIGH = "predicted_error_too_high"
    GUIDE_MISMATCH = "guide_mismatch"
    AMBIGUOUS = "ambiguous"
    UNREADABLE_IMAGE = "unreadable_image"
    UNSUPPORTED_IMAGE = "unsupported_image"
    IMAGE_TOO_LARGE = "image_too_large"
    TARGET_NOT_FINITE = "target_not_finite"
    TARGET_OUTSIDE_IMAGE = "target_outside_image"
    TARGET_NOT_REACHABLE = "target_not_reachable"
    PATH_IMPLAUSIBLE = "path_implausible"


@dataclass(frozen=True, slots=True)
class Refusal:
    """A typed no: the code, one clear line, and what was measured against which limit (unit: see the message)."""

    code: RefusalCode
    message: str
    measured: float | None = None
    limit: float | None = None
