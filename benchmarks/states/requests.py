"""Requests of a case, after the description: where each is listed, and what it needs of the chain."""

from collections.abc import Mapping

from benchmarks.states.model import IDLE, INSERTION, OVER

_POSITIONED = {"case_open", "carm_positioned"}
_AIMED_AT = {"target_chosen", "moved", "verified", "off_target"}
_JUDGED = {"verified", "off_target"}
_LIVE = IDLE | INSERTION | {"moving", "safe_hold"}
_ANY = _LIVE | OVER
# Every request with the states that list it.
LISTED: Mapping[str, frozenset[str]] = {
    name: frozenset(states)
    for name, states in {
        "carm_position_confirmed": _POSITIONED,
        "exposure_requested": {"carm_positioned", "moved"},
        "newest_image_reused": {"carm_positioned"},
        "retake": {"image_acquired", "registered", "target_chosen"},
        "target_confirmed": {"registered"} | _AIMED_AT,
        "target_withdrawn": _AIMED_AT,
        "plan_requested": IDLE,
        "move_approved": IDLE,
        "move_started": IDLE,
        "correction_requested": _JUDGED,
        "verification_rejected": _JUDGED,
        "insertion_started": {"verified"},
        "target_done": {"sleeve_inserted"},
        "hold_requested": _LIVE - {"moving"},
        "acknowledged": {"safe_hold"},
        "lease_taken": _LIVE,
        "case_closed": IDLE,
        "stop": _ANY,
        "note": _ANY,
        "label": _ANY,
        "read": _ANY,
        "export": _ANY,
    }.items()
}
LEASED = {
    "target_confirmed",
    "target_withdrawn",
    "plan_requested",
    "move_approved",
    "move_started",
    "correction_requested",
    "insertion_started",
}
MOVES = {"plan_requested", "move_approved", "move_started"}
PLAN_STATES: Mapping[str, frozenset[str]] = {
    "targeting": frozenset({"target_chosen"}),
    "corrective": frozenset({"target_chosen"}),
    "approach": frozenset(_POSITIONED),
    "calibration": frozenset(_POSITIONED),
    "nudge": frozenset({"carm_positioned"}),
    "retreat": IDLE,
}
PLAN_INPUTS = {"targeting": "VIRT", "corrective": "VIRT", "nudge": "V"}
NEEDS = {
    "exposure_requested": "V",
    "newest_image_reused": "V",
    "retake": "VI",
    "target_confirmed": "VIR",
    "target_withdrawn": "VIRT",
    "correction_requested": "VIRTPAME",
    "verification_rejected": "VIRTPAME",
    "insertion_started": "VIRTPAME",
    "target_done": "VIRTPAME",
}
RELY_ON_E = {"verification_rejected", "insertion_started", "target_done"}
ASK_FOR_CHAIN = {"target_confirmed", "correction_requested"} | MOVES
