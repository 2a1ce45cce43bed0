"""Proofs of the interlocks on images and what is measured in them (H01 to H03, H05 to H09, H28, H33, H34)."""

import math

from tests.workflow.proof import (
    ANGLE_LEFT,
    ARRIVE,
    INSERT,
    JUDGE,
    LIMITS,
    MORE,
    NAN,
    POSITION_LEFT,
    REGISTER,
    START,
    TARGET,
    Proof,
    Spoil,
    given,
    most,
    nested,
    of_quality,
    reading,
    stated,
    surgery,
)
from workflow.states import State
from workflow.triggers import Trigger

IMAGE_PROOFS: dict[str, Proof] = {
    "patient_matches": Proof(*ARRIVE, *stated("patient_matches")),
    "study_matches": Proof(*ARRIVE, *stated("study_matches")),
    "image_unseen": Proof(*ARRIVE, *stated("sop_uid_unseen")),
    "pixels_unseen": Proof(*ARRIVE, *stated("pixels_unseen")),
    "image_newer": Proof(*ARRIVE, *stated("newer_by_carm_clock")),
    "window_open": Proof(*ARRIVE, [Spoil(later_s=120.001), surgery(window=None)], [Spoil(later_s=120.0)]),
    "image_after_motion": Proof(
        State.MOVED, Trigger.IMAGE_ARRIVED, [nested("window", motion_id="old"), nested("window", motion_id=None)], []
    ),
    "newest_image": Proof(
        State.CARM_POSITIONED, Trigger.NEWEST_IMAGE_REUSED, [given(image_id="old"), surgery(newest_image_id=None)], []
    ),
    "guide_in_image": Proof(State.CARM_POSITIONED, Trigger.NEWEST_IMAGE_REUSED, *stated("guide_in_image")),
    "handedness": Proof(
        *REGISTER, [of_quality(handedness_proved=False), of_quality(handedness_proved=None)], [of_quality()]
    ),
    "plate": Proof(
        *REGISTER,
        [of_quality(plate_balls=39), of_quality(plate_balls=None), of_quality(plate_required=None)],
        [of_quality(plate_balls=40), of_quality(plate_required=False, plate_balls=0)],
    ),
    "scale": Proof(*REGISTER, *most(of_quality, "scale_error", 0.1)),
    "fiducials": Proof(*REGISTER, [of_quality(fiducials=11), of_quality(fiducials=None)], [of_quality(fiducials=12)]),
    "residual": Proof(*REGISTER, *most(of_quality, "residual_rms_px", 1.0)),
    "predicted_angle": Proof(*REGISTER, *most(of_quality, "predicted_angle_rad", math.radians(1.0))),
    "predicted_position": Proof(*REGISTER, *most(of_quality, "predicted_position_mm", 1.5)),
    "image_age": Proof(
        *START,
        [reading("image_exposed", True, age_s) for age_s in (1800.0 * MORE, -0.01, NAN, math.inf)],
        [reading("image_exposed", True, 1800.0)],
    ),
    "target_echo": Proof(*TARGET, *stated("echo_seen")),
    "figures_plausible": Proof(
        *JUDGE,
        [
            given(angle_error_rad=0.5 * 57.3),
            given(angle_error_rad=None),
            given(angle_bound_rad=NAN),
            given(position_error_mm=500.0),
            given(position_error_mm=NAN),
            given(position_bound_mm=-0.1),
        ],
        [given(angle_error_rad=0.0)],
    ),
    "image_evaluated": Proof(*JUDGE, [given(image_id="old")], []),
    "evaluations_agree": Proof(*JUDGE, *stated("agree")),
    "motion_agrees": Proof(*JUDGE, *most(given, "motion_chi_square", LIMITS.motion_chi_square)),
    "anatomy_across": Proof(*JUDGE, *most(given, "anatomy_across_mm", 0.5)),
    "anatomy_along": Proof(*JUDGE, *most(given, "anatomy_along_mm", 2.0)),
    "angle_error": Proof(*JUDGE, [given(angle_error_rad=ANGLE_LEFT * MORE)], [given(angle_error_rad=ANGLE_LEFT)]),
    "position_error": Proof(
        *JUDGE, [given(position_error_mm=POSITION_LEFT * MORE)], [given(position_error_mm=POSITION_LEFT)]
    ),
    "correction_image": Proof(State.OFF_TARGET, Trigger.CORRECTION_REQUESTED, [given(image_id="old")], []),
    "verification_newer": Proof(
        *INSERT, [nested("verification", motion_id="old"), nested("verification", passed=False)], [surgery(motion=None)]
    ),
    "verification_age": Proof(*INSERT, [Spoil(later_s=900.1), Spoil(later_s=-1.0)], [Spoil(later_s=900.0)]),
}
