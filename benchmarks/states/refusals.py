"""Why a request is refused, after the description: who speaks, control, the state, what is missing, the interlocks.

`standing` asks what the status of a case tells: nothing comes with the request yet, so that only the case and the room
can refuse it.
"""

from dataclasses import dataclass

from benchmarks.states.model import AIMED, INSERTION, OVER, Model
from benchmarks.states.requests import ASK_FOR_CHAIN, LISTED, MOVES, NEEDS, PLAN_INPUTS, PLAN_STATES, RELY_ON_E

_STALE_ARM = {"at_rest", "safety_normal", "feedback_fresh", "joints_fresh", "feedback_advances"}
PERMIT_LIFE_S, WINDOW_S, IMAGE_AGE_S, VERIFICATION_AGE_S = 30.0, 120.0, 1800.0, 900.0


@dataclass
class World:
    """What the interlocks are told of the room."""

    now_s: float
    stale: bool = False  # nothing was read for some seconds
    at_rest: bool = True
    safe: bool = True
    program_running: bool = False
    payload_right: bool = True


@dataclass(frozen=True)
class Given:
    """What comes with a request beyond its name."""

    kind: str | None = None  # of a plan
    right: bool = True  # it names what is there: echo, plan, permit, guide
    image: int | None = None  # that is to be reused
    found: bool = True  # the guide, in that image
    reason: bool = True
    placed: bool = True
    planned: str | None = None  # target
    abandoned: bool = False  # a closing case's open target
    token: int = 0


Refused = tuple[str, frozenset[str]]  # its code, and the interlocks that failed


def refusal(model: Model, trigger: str, world: World, given: Given | None) -> Refused | None:
    """Code and failed interlocks, or None where the request is taken; without `given`, of the standing alone."""
    listed = model.state in LISTED[trigger]
    failed = frozenset(_failed(model, trigger, world, given))
    code = (
        (None if listed else _by_state(model))
        or _by_guide(model, trigger)
        or (None if listed or model.state not in INSERTION else "insertion_running")
        or ("missing" if (not listed or trigger in ASK_FOR_CHAIN) and _misses(model, trigger, given) else None)
        or (None if listed else "not_now")
        or (None if given is None else _by_what_came(model, trigger, given))
        or ("interlock" if failed else None)
    )
    return None if code is None else (code, failed)


def _by_state(model: Model) -> str | None:
    if model.state in OVER:
        return "case_over"
    return {"safe_hold": "held", "moving": "arm_moving"}.get(model.state)


def _by_guide(model: Model, trigger: str) -> str | None:
    match trigger:
        case "case_closed":
            in_the_way = model.guide != "empty"
        case "target_done":
            in_the_way = model.state in INSERTION and model.guide not in ("empty", "wire")
        case "move_approved" | "move_started":
            along_wire = model.guide == "wire" and model.plan is not None and model.plan.kind == "retreat"
            in_the_way = model.guide != "empty" and not along_wire
        case _:
            in_the_way = False
    return "instrument_in_guide" if in_the_way else None


def _kind(model: Model, trigger: str, given: Given | None) -> str | None:
    """Of the plan that the request is about."""
    if trigger == "plan_requested":
        return given.kind if given is not None else None
    return model.plan.kind if model.plan is not None else None


def _usable(model: Model) -> bool:
    plan = model.plan
    return plan is not None and not plan.used and model.state in PLAN_STATES[plan.kind]


def _misses(model: Model, trigger: str, given: Given | None) -> bool:
    if trigger in MOVES:
        kind = _kind(model, trigger, given)
        inputs = model.has(PLAN_INPUTS.get(kind or "", ""))
        planned = trigger == "plan_requested" or _usable(model)
        return not (inputs and planned and (trigger != "move_started" or model.permit is not None))
    if trigger in RELY_ON_E and model.verdict is not None:
        return False
    there = {"P": _usable(model) or model.has("M"), "A": model.permit is not None or model.has("M")}
    return not all(there.get(letter, model.has(letter)) for letter in NEEDS.get(trigger, ""))


def _by_what_came(model: Model, trigger: str, given: Given) -> str | None:
    match trigger:
        case "plan_requested" if model.state not in PLAN_STATES[given.kind or ""]:
            return "not_now"
        case "target_done" if not given.placed and not given.reason:
            return "reason_required"
        case "correction_requested" if model.corrections >= 2 and not given.reason:
            return "reason_required"
        case "case_closed" if not (model.done or given.abandoned):
            return "targets_open"
    return None


def _failed(model: Model, trigger: str, world: World, given: Given | None) -> set[str]:
    """The interlocks that refuse."""
    failed: set[str] = set()
    kind = _kind(model, trigger, given)
    match trigger:
        case "carm_position_confirmed":
            failed |= _arm(world) & {"at_rest"}
        case "exposure_requested":
            failed |= _arm(world) - {"safety_normal", "guard_alive"}
            failed |= {"guide_known"} if model.guide == "unknown" else set()
        case "newest_image_reused":
            failed |= _pose_kept(model, model.newest, world)
            if given is not None:
                failed |= set() if given.image is not None and given.image == model.newest else {"newest_image"}
                failed |= set() if given.found and given.image in model.exposed_s else {"guide_in_image"}
        case "target_confirmed":
            failed |= _image_young(model, world, _number(model.chain["I"]))
            if given is not None and not given.right:
                failed |= {"target_echo", "target_image", "target_registration"}
        case "plan_requested":
            failed |= _aim(model, world) if kind in AIMED else set()
        case "move_approved" | "move_started":
            failed |= _motion(model, trigger, world, given)
            failed |= _aim(model, world) if kind in AIMED else set()
        case "correction_requested":
            image = model.verdict.image if model.verdict is not None else None
            failed |= _image_young(model, world, image) | _pose_kept(model, image, world)
        case "insertion_started":
            failed |= _insertion(model, world)
        case "acknowledged":
            failed |= _arm(world)
            failed |= {"guide_known"} if model.guide == "unknown" else set()
            failed |= {"guide_restated"} if given is not None and not given.right else set()
    return failed


def _arm(world: World) -> set[str]:
    """A ready arm."""
    failed = _STALE_ARM | {"guard_alive"} if world.stale else set()
    failed = failed | (set() if world.at_rest else {"at_rest"})
    return failed | (set() if world.safe else {"safety_normal"})


def _pose_kept(model: Model, image: int | None, world: World) -> set[str]:
    known = image in model.exposed_s and not world.stale
    return set() if known else {"unaccounted_mm", "unaccounted_rad"}


def _image_young(model: Model, world: World, image: int | None) -> set[str]:
    exposed_s = model.exposed_s.get(image) if image is not None else None
    return set() if exposed_s is not None and world.now_s - exposed_s <= IMAGE_AGE_S else {"image_age"}


def _aim(model: Model, world: World) -> set[str]:
    image = _number(model.chain["I"])
    return _image_young(model, world, image) | _pose_kept(model, image, world)


def _motion(model: Model, trigger: str, world: World, given: Given | None) -> set[str]:
    failed = _arm(world) | (set() if world.payload_right and not world.stale else {"payload_kg"})
    failed |= {"tcp_mm", "tcp_rad"} if world.stale else set()
    failed |= {"no_insertion"} if model.sleeve is not None else set()
    if trigger == "move_approved":
        failed |= {"arm_where_planned"} if world.stale else set()
        failed |= {"plan_current"} if given is not None and not given.right else set()
        return failed
    permit = model.permit
    failed |= {"permit_joints"} if world.stale else set()
    failed |= set() if permit is not None and world.now_s - permit.issued_s <= PERMIT_LIFE_S else {"permit_fresh"}
    failed |= set() if permit is not None and permit.guide == model.guide else {"permit_guide"}
    if given is not None:
        failed |= set() if given.right else {"permit_current", "hold_pressed", "heartbeat_fresh"}
        failed |= set() if given.right else {"challenge_echoed", "challenge_fresh"}
        failed |= set() if permit is not None and permit.token == given.token else {"permit_holder"}
    return failed


def _insertion(model: Model, world: World) -> set[str]:
    verdict = model.verdict
    failed = _arm(world)
    failed |= {"script_stopped"} if world.program_running or world.stale else set()
    failed |= {"motion_locked", "drift_mm", "drift_rad"} if world.stale else set()
    passed = verdict is not None and verdict.passed
    failed |= set() if passed else {"verification_newer"}
    young = verdict is not None and world.now_s - verdict.at_s <= VERIFICATION_AGE_S
    return failed | (set() if young else {"verification_age"})


def _number(link: object) -> int | None:
    return link if isinstance(link, int) else None
