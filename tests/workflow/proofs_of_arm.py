"""Proofs of the interlocks on the arm, its controller and the held button (H04, H10, H16 to H18, H21, H29, H36)."""

import math

from tests.workflow.proof import (
    ACKNOWLEDGE,
    APPROVE,
    ARRIVE,
    ELSEWHERE,
    FEEDBACK,
    HEARTBEAT,
    INSERT,
    LIMITS,
    MORE,
    NAN,
    RECORD,
    SLEEVE,
    START,
    Proof,
    given,
    measured,
    most,
    reading,
    said,
    surgery,
)
from workflow.snapshot import SafetyMode
from workflow.states import State
from workflow.triggers import Trigger

ARM_PROOFS: dict[str, Proof] = {
    "still_mm": Proof(*ARRIVE, *most(given, "moved_mm", 0.05)),
    "still_rad": Proof(*ARRIVE, *most(given, "moved_rad", math.radians(0.02))),
    "devices_known": Proof(
        *APPROVE,
        [reading("devices_hash", None), reading("devices_hash", "devices", RECORD * MORE)],
        [reading("devices_hash", "devices", RECORD)],
    ),
    "arm_where_planned": Proof(
        *APPROVE,
        [reading("joints_rad", ELSEWHERE), reading("joints_rad", ())],
        [],
    ),
    "permit_joints": Proof(*START, [reading("joints_rad", ELSEWHERE), reading("joints_rad", ELSEWHERE[:5])], []),
    "permit_devices": Proof(*START, [reading("devices_hash", "others"), reading("devices_hash", None)], []),
    "no_insertion": Proof(*APPROVE, [surgery(insertion=SLEEVE)], []),
    "at_rest": Proof(State.CARM_POSITIONED, Trigger.EXPOSURE_REQUESTED, *said("at_rest", True, FEEDBACK)),
    "unaccounted_mm": Proof(*START, *measured("unaccounted_mm", 0.05, FEEDBACK)),
    "unaccounted_rad": Proof(*START, *measured("unaccounted_rad", math.radians(0.02), FEEDBACK)),
    "devices_in_date": Proof(*START, *said("devices_in_date", True, RECORD)),
    "tcp_mm": Proof(*START, *measured("tcp_difference_mm", 5.0, RECORD)),
    "tcp_rad": Proof(*START, *measured("tcp_difference_rad", math.radians(1.0), RECORD)),
    "payload_kg": Proof(*START, *measured("payload_difference_kg", LIMITS.payload_difference_kg, RECORD)),
    "heartbeat_fresh": Proof(
        *START, [reading("hold_pressed", True, 0.2001)], [reading("hold_pressed", True, HEARTBEAT)]
    ),
    "challenge_echoed": Proof(*START, [reading("challenge_echoed", False), reading("challenge_echoed", None)], []),
    "challenge_fresh": Proof(
        *START, [reading("challenge_echoed", True, 0.2001)], [reading("challenge_echoed", True, HEARTBEAT)]
    ),
    "guard_alive": Proof(*START, *said("guard_alive", True, HEARTBEAT)),
    "safety_normal": Proof(
        *START,
        [reading("safety_mode", mode) for mode in SafetyMode if mode not in (SafetyMode.NORMAL, SafetyMode.REDUCED)]
        + [reading("safety_mode", None), reading("safety_mode", SafetyMode.NORMAL, FEEDBACK * MORE)],
        [reading("safety_mode", SafetyMode.REDUCED, FEEDBACK)],
    ),
    "feedback_fresh": Proof(
        *START, [reading("controller_time_s", 1.0, 0.1001)], [reading("controller_time_s", 1.0, FEEDBACK)]
    ),
    "joints_fresh": Proof(*ACKNOWLEDGE, [reading("joints_rad", ELSEWHERE, 0.1001)], [reading("joints_rad", ELSEWHERE)]),
    "feedback_finite": Proof(
        *ACKNOWLEDGE,
        [
            reading("controller_time_s", NAN),
            reading("controller_time_s", None),
            reading("joints_rad", (NAN, *ELSEWHERE[1:])),
            reading("joints_rad", None),
        ],
        [reading("joints_rad", ELSEWHERE)],
    ),
    "feedback_advances": Proof(*START, *said("feedback_advances", True, FEEDBACK)),
    "script_stopped": Proof(*INSERT, *said("program_running", False, FEEDBACK)),
    "motion_locked": Proof(*INSERT, *said("motion_locked", True, HEARTBEAT)),
    "drift_mm": Proof(*INSERT, *measured("drift_mm", 0.3, FEEDBACK)),
    "drift_rad": Proof(*INSERT, *measured("drift_rad", math.radians(0.1), FEEDBACK)),
}
