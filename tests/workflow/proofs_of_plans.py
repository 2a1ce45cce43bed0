"""Proofs of the interlocks on plans and permits (H07, H09, H11 to H15, H22, H30, H35)."""

import math
from dataclasses import replace

from tests.workflow.proof import (
    ACKNOWLEDGE,
    APPROVE,
    MORE,
    NAN,
    OTHER,
    PLAN,
    RECORD,
    START,
    TARGET,
    UNKNOWN,
    Proof,
    Spoil,
    given,
    least,
    most,
    nested,
    reading,
    surgery,
)
from workflow.plans import PlanKind
from workflow.snapshot import Reading
from workflow.states import GuideState, State
from workflow.triggers import Trigger

PLAN_PROOFS: dict[str, Proof] = {
    "target_image": Proof(*TARGET, [given(image_id="old")], []),
    "target_registration": Proof(*TARGET, [given(registration_id="old")], []),
    "plan_plausible": Proof(
        *PLAN,
        [given(start_joints_rad=(57.3,) * 6), given(start_joints_rad=(NAN,) * 6)],
        [given(start_joints_rad=(2.0 * math.pi,) * 6)],
    ),
    "joint_margin": Proof(*PLAN, *least("joint_margin_rad", math.radians(5.0))),
    "singularity": Proof(*PLAN, *least("smallest_singular_value", 0.05)),
    "clearance": Proof(
        *PLAN,
        [
            *least("clearance_mm", 5.0)[0],
            given(clearance_needed_mm=None),
            given(clearance_needed_mm=20.0 * MORE),
            given(clearance_mm=1.9, clearance_needed_mm=1.0),  # the room file may not ask for as little
        ],
        [given(clearance_mm=5.0), given(clearance_mm=-3.0, clearance_needed_mm=-3.0, axial=True)],
    ),
    "path_length": Proof(*PLAN, *most(given, "length_mm", 150.0)),
    "path_angle": Proof(*PLAN, *most(given, "rotation_rad", math.radians(35.0))),
    "path_speed": Proof(*PLAN, *most(given, "speed_mm_s", 20.0)),
    "path_turn_speed": Proof(*PLAN, *most(given, "speed_rad_s", math.radians(5.0))),
    "path_acceleration": Proof(*PLAN, *most(given, "acceleration_mm_s2", 50.0)),
    "aim_angle": Proof(
        *START,
        [nested("plan", predicted_angle_rad=bad) for bad in (math.radians(0.25) * MORE, None, NAN, -0.01)],
        [nested("plan", predicted_angle_rad=math.radians(0.25))],
    ),
    "aim_position": Proof(
        *START,
        [nested("plan", predicted_position_mm=bad) for bad in (0.5 * MORE, None, NAN, -0.01)],
        [nested("plan", predicted_position_mm=0.5)],
    ),
    "plan_parents": Proof(*PLAN, [given(made_from=("old",)), given(made_from=())], []),
    "plan_current": Proof(*APPROVE, [given(plan_id="old")], []),
    "surgeon": Proof(*APPROVE, [given(approval=replace(OTHER, surgeon=False))], []),
    "pin": Proof(*APPROVE, [given(approval=replace(OTHER, pin_confirmed=False))], []),
    "lease": Proof(
        *APPROVE,
        [given(approval=replace(OTHER, control_token=2)), reading("control_token", 2), reading("control_token", None)],
        [reading("control_token", 1, RECORD)],
    ),
    "permit_current": Proof(*START, [given(permit_id="foreign")], []),
    "permit_unused": Proof(
        *START, [Spoil(case=lambda case: replace(case, used_permit_id=case.permit and case.permit.id))], []
    ),
    "permit_fresh": Proof(*START, [Spoil(later_s=30.001), Spoil(later_s=-1.0)], [Spoil(later_s=30.0)]),
    "permit_holder": Proof(
        *START, [Spoil(readings={"control_token": Reading(2, 0.01)}, facts={"control_token": 2})], []
    ),
    "permit_parents": Proof(*START, [nested("permit", made_from=("old",)), nested("target", id="new")], []),
    "permit_guide": Proof(*START, [surgery(guide=GuideState.WIRE)], [], PlanKind.RETREAT),
    "guide_empty": Proof(
        *APPROVE,
        [surgery(guide=guide) for guide in (GuideState.WIRE, GuideState.INSTRUMENT, GuideState.UNKNOWN)],
        [surgery(guide=GuideState.EMPTY)],
    ),
    "guide_known": Proof(
        State.CARM_POSITIONED, Trigger.EXPOSURE_REQUESTED, [surgery(guide=GuideState.UNKNOWN)], [given()]
    ),
    "guide_restated": Proof(*ACKNOWLEDGE, [given(guide=GuideState.WIRE)], []),
    "configuration": Proof(
        *PLAN,
        [
            reading("configuration", "another"),
            reading("configuration", None),
            reading("configuration_opened", None),
            Spoil(readings={"configuration": UNKNOWN, "configuration_opened": UNKNOWN}),
            reading("configuration", "configuration", RECORD * MORE),
        ],
        [reading("configuration", "configuration", RECORD)],
    ),
    "hold_pressed": Proof(*START, [reading("hold_pressed", False), reading("hold_pressed", None)], []),
}
