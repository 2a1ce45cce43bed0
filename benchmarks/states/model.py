"""What a case does, after the description of the state machine: written anew, without a look at the product's rules.

States, requests and codes are plain words here. One method an event of the description; each changes the case, adds
what is recorded, and says nothing of ids: a link is there or it is void, and is told apart by a number.
"""

from dataclasses import dataclass, field
from itertools import count

from benchmarks.states.slots import Permit, Plan, Sleeve, Verdict, Window

CHAIN = "VIRTPAME"
IDLE = frozenset(
    {
        "case_open",
        "carm_positioned",
        "image_acquired",
        "registered",
        "target_chosen",
        "moved",
        "verified",
        "off_target",
    }
)
INSERTION = frozenset({"inserting", "sleeve_inserted"})
OVER = frozenset({"closed", "aborted"})
LOCKED = INSERTION | OVER | {"safe_hold"}
AIMED = frozenset({"targeting", "corrective"})
_BY_LETTER = {"T": "target_chosen", "R": "registered", "I": "image_acquired", "V": "carm_positioned"}


@dataclass
class Model:
    """One case; `chain` holds what is valid of V to E."""

    state: str = "case_open"
    guide: str = "unknown"
    chain: dict[str, object] = field(default_factory=lambda: dict.fromkeys(CHAIN))
    running: str | None = None  # kind of the motion under way
    sleeve: Sleeve | None = None
    window: Window | None = None
    evaluated: int | None = None
    newest: int | None = None
    corrections: int = 0
    images: int = 0
    recorded: list[tuple[str, str]] = field(default_factory=lambda: [("case_opened", "case_open")])
    exposed_s: dict[int, float] = field(default_factory=dict)  # images whose exposure was watched
    aimed_at: str | None = None  # planned target of the newest target, void or not
    placed: bool = False
    done: bool = False  # the planned target: placed or abandoned
    numbers: "count[int]" = field(default_factory=lambda: count(1))

    # What is there

    def has(self, letters: str) -> bool:
        """All of these are valid."""
        return all(self.chain[letter] is not None for letter in letters)

    @property
    def plan(self) -> Plan | None:
        """P."""
        plan = self.chain["P"]
        return plan if isinstance(plan, Plan) else None

    @property
    def permit(self) -> Permit | None:
        """A."""
        permit = self.chain["A"]
        return permit if isinstance(permit, Permit) else None

    @property
    def verdict(self) -> Verdict | None:
        """E."""
        verdict = self.chain["E"]
        return verdict if isinstance(verdict, Verdict) else None

    def settled(self) -> str:
        """settle()."""
        if self.sleeve is not None:
            return "sleeve_inserted" if self.sleeve.status == "done" else "inserting"
        if self.verdict is not None and self.verdict.passed:
            return "verified"
        if self.has("VIRTM"):
            return "off_target" if self.verdict is not None else "moved"
        return next((state for letter, state in _BY_LETTER.items() if self.has(letter)), "case_open")

    # What a row does

    def goes(self, trigger: str, to: str | None = None) -> None:
        """The case is there now, settled where nothing is said; it is recorded."""
        to = self.settled() if to is None else to
        if to != self.state:
            self.chain["A"] = self.window = None
        self.state = to
        self.recorded.append((trigger, to))

    def stays(self, trigger: str) -> None:
        """Recorded; the state is kept."""
        self.goes(trigger, self.state)

    def void(self, letter: str) -> None:
        """A link and everything below it."""
        for below in CHAIN[CHAIN.index(letter) :]:
            self.chain[below] = None
        self.evaluated = None

    def makes(self, letter: str, what: object = None) -> None:
        """A new link."""
        self.chain[letter] = next(self.numbers) if what is None else what

    # Positioning and images

    def carm_position_confirmed(self) -> None:
        self.void("V")
        self.makes("V")
        self.window = self.newest = None
        self.goes("carm_position_confirmed", "carm_positioned")

    def exposure_requested(self, now_s: float) -> None:
        self.window = Window(now_s)
        self.stays("exposure_requested")

    def image_arrived(self, image: int, now_s: float, *, of_the_case: bool, window_s: float) -> None:
        """Row 3, 4 or 5."""
        self.images += 1
        window = self.window
        asked_for = window is not None and now_s - window.opened_s <= window_s
        if not (of_the_case and asked_for):
            if of_the_case and window is not None:
                self.newest = image  # clean, yet nobody asked for it in time
            self.stays("image_arrived")
            return
        self.newest, self.exposed_s[image] = image, window.opened_s if window else now_s
        if self.state == "moved":
            self.evaluated, self.window = image, None
            self.stays("image_arrived")
        else:
            self.makes("I", image)
            self.goes("image_arrived", "image_acquired")

    def newest_image_reused(self) -> None:
        self.makes("I", self.newest)
        self.goes("newest_image_reused", "image_acquired")

    def registration_came(self, image: int, outcome: str) -> None:
        """Rows 7 and 8, or late."""
        told = "registration_refused" if outcome in ("refused", "crashed") else "registration_completed"
        current = self.chain["I"] == image and not self.has("R") and self.state in ("image_acquired", "safe_hold")
        held = self.state == "safe_hold"
        if not current:
            self.stays(told)
        elif outcome == "sound":
            self.makes("R")
            self.goes(told, "safe_hold" if held else "registered")
        else:
            self.void("I")
            self.goes("registration_refused", "safe_hold" if held else "carm_positioned")

    def retake(self) -> None:
        self.void("I")
        self.goes("retake", "carm_positioned")

    # Targets and motions

    def target_confirmed(self, planned: str | None) -> None:
        self.void("T")
        self.makes("T")
        self.corrections, self.aimed_at = 0, planned
        self.goes("target_confirmed", "target_chosen")

    def target_withdrawn(self) -> None:
        self.void("T")
        self.corrections = 0
        self.goes("target_withdrawn")

    def plan_requested(self, kind: str) -> None:
        self.chain["A"] = None
        self.makes("P", Plan(kind))
        self.stays("plan_requested")

    def move_approved(self, now_s: float, token: int) -> None:
        self.makes("A", Permit(now_s, token, self.guide))
        self.stays("move_approved")

    def move_started(self) -> None:
        plan = self.plan
        assert plan is not None, "a motion without a plan"
        plan.used, self.running = True, plan.kind
        self.chain["A"] = self.chain["M"] = self.chain["E"] = self.evaluated = self.newest = self.window = None
        self.goes("move_started", "moving")

    def motion_ended(self, cause: str, *, at_goal: bool, at_rest: bool) -> None:
        """Rows 15 to 17; the arm that is not at rest moves without an M."""
        kind, self.running = self.running, None
        if self.state != "moving":
            self.stays(cause)
        elif not at_rest:
            self.void("I")
            self.newest = self.window = None
            self.goes("arm_disturbed", "safe_hold")
        elif cause == "arrived" and kind in AIMED and at_goal:
            self.makes("M")
            self.goes("arrived", "moved")
        else:
            self.goes(cause)

    # Verification

    def evaluation_came(self, image: int, outcome: str, now_s: float) -> None:
        """Rows 18 to 20, 30, 31, 34, or late."""
        told = "verification_refused" if outcome in ("refused", "crashed") else "verification_passed"
        held = self.state == "safe_hold"
        if not (self.has("M") and self.evaluated == image and self.state in ("moved", "safe_hold")):
            self.stays(told)
        elif outcome in ("passed", "exceeded"):
            self.evaluated = None
            self.makes("E", Verdict(outcome == "passed", image, now_s))
            to = "verified" if outcome == "passed" else "off_target"
            self.goes(
                "verification_passed" if outcome == "passed" else "verification_failed", self.state if held else to
            )
        elif outcome in ("view_moved", "patient_shifted"):
            self.seen_to_move("carm_moved" if outcome == "view_moved" else "patient_moved")
        else:
            self.evaluated = None
            self.stays("verification_refused")

    def correction_requested(self) -> None:
        verdict = self.verdict
        assert verdict is not None, "a correction without a verification"
        self.void("P")
        self.makes("I", verdict.image)
        self.makes("R")
        self.makes("T")
        self.corrections += 1
        self.goes("correction_requested", "target_chosen")

    def verification_rejected(self) -> None:
        self.chain["E"] = None
        self.goes("verification_rejected")

    # The sleeve

    def insertion_started(self) -> None:
        self.sleeve, self.guide = Sleeve("open", False, False, self.aimed_at), "instrument"
        self.goes("insertion_started", "inserting")

    def sleeve_in(self) -> None:
        if self.state in OVER:
            return self.stays("sleeve_in")
        before = self.sleeve or Sleeve("open", False, False, self.aimed_at)
        expected = self.state in INSERTION
        passed = self.verdict is not None and self.verdict.passed
        verified = (before.verified if before.status == "done" else passed) if expected else False
        self.sleeve, self.guide = Sleeve("done", verified, before.flagged, before.target), "instrument"
        if not expected:
            self.running = None
        return self.goes("sleeve_in", "sleeve_inserted" if expected else "safe_hold")

    def insertion_cancelled(self) -> None:
        is_open = self.sleeve is not None and self.sleeve.status == "open"
        if self.state == "inserting" or (self.state == "safe_hold" and is_open):
            self.sleeve, self.guide = None, "empty"
        self.goes("insertion_cancelled", None if self.state == "inserting" else self.state)

    def sleeve_removed(self, guide: str) -> None:
        if self.state in ("sleeve_inserted", "safe_hold"):
            self.guide = guide
        self.stays("sleeve_removed")

    def target_done(self, *, placed: bool) -> None:
        if self.sleeve is not None and self.sleeve.target is not None:
            self.placed, self.done = self.placed or placed, True
        self.void("T")
        self.sleeve, self.corrections = None, 0
        self.goes("target_done")

    # Statements and observations

    def guide_state_stated(self, guide: str) -> None:
        if self.state in OVER or self.sleeve is not None:
            return self.stays("guide_state_stated")
        self.guide = guide
        if self.state != "moving" or guide == "empty":
            return self.stays("guide_state_stated")
        self.void("P")
        self.running = None
        return self.goes("guide_state_stated", "safe_hold")

    def seen_to_move(self, trigger: str) -> None:
        """Rows 30 to 35."""
        if self.state in OVER:
            return self.stays(trigger)
        verdict = self.verdict
        self.void("V" if trigger in ("carm_moved", "device_changed") else "I")
        if trigger == "carm_moved" and verdict is not None and verdict.passed:
            self.chain["E"] = verdict
        self.newest = self.window = None
        if self.state in IDLE:
            return self.goes(trigger)
        if self.state == "moving":
            self.void("P")
            self.running = None
            return self.goes(trigger, "safe_hold")
        if self.sleeve is not None:
            self.sleeve.flagged = True
        return self.stays(trigger)

    def held(self, trigger: str) -> None:
        """Stop, fault, pause: nothing is void but the permit."""
        if self.state in OVER:
            return self.stays(trigger)
        self.running = None
        return self.goes(trigger, "safe_hold")

    def restarted(self) -> None:
        self.running = None
        self.void("V")
        self.newest = self.window = None
        self.goes("restarted", "safe_hold")

    def lease_taken(self) -> None:
        if self.state == "moving":
            self.held("lease_taken")
        else:
            self.stays("lease_taken")

    def ends(self, trigger: str, state: str) -> None:
        """Closed or aborted."""
        if self.state in OVER:
            return self.stays(trigger)
        self.running = None
        return self.goes(trigger, state)
