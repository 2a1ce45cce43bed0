"""Who may ask for what, after the description: one user of each role, and a second surgeon."""

# What each role may do beyond reading and stopping; the second surgeon is one.
_STAFF = {"fact", "hold", "note"}
_MAY = {
    "surgeon": _STAFF | {"expose", "position", "target", "plan", "approve", "move", "lease", "close"},
    "second": _STAFF | {"expose", "position", "target", "plan", "approve", "move", "lease", "close"},
    "operator": _STAFF | {"expose", "position"},
    "engineer": _STAFF,
    "auditor": set(),
}
_ASKS = {
    "carm_position_confirmed": "position",
    "exposure_requested": "expose",
    "newest_image_reused": "expose",
    "retake": "expose",
    "target_confirmed": "target",
    "target_withdrawn": "target",
    "plan_requested": "plan",
    "move_approved": "approve",
    "move_started": "move",
    "correction_requested": "target",
    "verification_rejected": "target",
    "insertion_started": "approve",
    "target_done": "target",
    "hold_requested": "hold",
    "acknowledged": "approve",
    "lease_taken": "lease",
    "case_closed": "close",
    "case_aborted": "close",
    "note": "note",
}
PEOPLE = tuple(_MAY)


def may(person: str, trigger: str) -> bool:
    """Whether this person's role allows it; facts are the default."""
    return trigger == "stop" or _ASKS.get(trigger, "fact") in _MAY[person]
