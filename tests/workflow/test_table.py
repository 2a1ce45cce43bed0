"""The table against a second one, written anew from the description and expanded to every state x trigger."""

import subprocess
import sys
from dataclasses import dataclass, replace

import pytest

from workflow.decisions import Decision, Effect, Outcome
from workflow.machine import decide
from workflow.refusals import Refusal
from workflow.rows import Row
from workflow.states import GuideState, InsertionStatus, State
from workflow.table import TABLE
from workflow.totality import IncompleteTableError, index
from workflow.triggers import Kind, Trigger

CHAIN = "VIRTPAME"
LINKS = ("view", "image", "registration", "target", "plan", "permit", "motion", "verification")
IDLE = "case_open carm_positioned image_acquired registered target_chosen moved verified off_target"
LIVE = f"{IDLE} moving inserting sleeve_inserted safe_hold"
NOT_MOVING = f"{IDLE} inserting sleeve_inserted safe_hold"
HELD = "inserting sleeve_inserted safe_hold"
OVER = "closed aborted"
AIMED = "target_chosen moved verified off_target"

NOT_EXPOSING = f"case_open image_acquired registered target_chosen moving verified off_target {HELD} {OVER}"

# trigger | from | to | effects: -X+ voids X and below, -X voids X, +X makes X, !E keeps a passed E. One line a row of
# the description, in its order; "settle" is worked out below. Facts are those of a case in which all goes well.
SECOND_TABLE = f"""
 1 | carm_position_confirmed | case_open carm_positioned             | carm_positioned | -V+ +V
 2 | exposure_requested      | carm_positioned moved                 | same            | window
 3 | image_arrived           | carm_positioned                       | image_acquired  | +I
 4 | image_arrived           | moved                                 | same            |
 5 | image_arrived           | {NOT_EXPOSING} | same |
 6 | newest_image_reused     | carm_positioned                       | image_acquired  | +I
 7 | registration_completed  | image_acquired                        | registered      | +R
 8 | registration_refused    | image_acquired                        | carm_positioned | -I+
 9 | retake                  | image_acquired registered target_chosen | carm_positioned | -I+
10 | target_confirmed        | registered {AIMED}                    | target_chosen   | -T+ +T
11 | target_withdrawn        | {AIMED}                               | settle          | -T+
12 | plan_requested          | {IDLE}                                | same            | +P -A
13 | move_approved           | {IDLE}                                | same            | +A
14 | move_started            | {IDLE}                                | moving          | -A -M -E
15 | arrived                 | moving                                | moved           | +M
16 | missed                  | moving                                | settle          |
17 | released                | moving                                | settle          |
18 | verification_passed     | moved                                 | verified        | +E
19 | verification_failed     | moved                                 | off_target      | +E
20 | verification_refused    | moved                                 | same            |
21 | correction_requested    | verified off_target                   | target_chosen   | -P+ +I +R +T
22 | verification_rejected   | verified off_target                   | settle          | -E
23 | insertion_started       | verified                              | inserting       | S=open G=instrument
24 | sleeve_in               | inserting sleeve_inserted             | sleeve_inserted | S=done G=instrument
25 | sleeve_in               | {IDLE} moving safe_hold               | safe_hold       | stop S=done G=instrument
26 | insertion_cancelled     | inserting                             | settle          | S=none G=empty
27 | sleeve_removed          | sleeve_inserted safe_hold             | same            | G=empty
28 | target_done             | sleeve_inserted                       | settle          | S=none -T+
29 | guide_state_stated      | {IDLE} moving safe_hold               | same            | G=empty
30 | carm_moved              | {IDLE}                                | settle          | -V+ !E
31 | patient_moved           | {IDLE}                                | settle          | -I+
32 | arm_disturbed           | {IDLE}                                | settle          | -I+
32 | hand_guided             | {IDLE}                                | settle          | -I+
33 | device_changed          | {IDLE}                                | settle          | -V+
34 | carm_moved              | {HELD}                                | same            | -V+ !E alarm
34 | patient_moved           | {HELD}                                | same            | -I+ alarm
34 | arm_disturbed           | {HELD}                                | same            | -I+ alarm
34 | hand_guided             | {HELD}                                | same            | -I+ alarm
34 | device_changed          | {HELD}                                | same            | -V+ alarm
35 | carm_moved              | moving                                | safe_hold       | -V+ -P+ stop
35 | patient_moved           | moving                                | safe_hold       | -I+ -P+ stop
35 | arm_disturbed           | moving                                | safe_hold       | -I+ -P+ stop
35 | hand_guided             | moving                                | safe_hold       | -I+ -P+ stop
35 | device_changed          | moving                                | safe_hold       | -V+ -P+ stop
36 | stop                    | {LIVE}                                | safe_hold       | stop
36 | stop                    | {OVER}                                | same            | stop
37 | fault                   | {LIVE}                                | safe_hold       | stop
38 | restarted               | {LIVE}                                | safe_hold       | -V+
39 | hold_requested          | {NOT_MOVING}                          | safe_hold       |
40 | acknowledged            | safe_hold                             | settle          |
41 | lease_taken             | {NOT_MOVING}                          | same            |
41 | lease_taken             | moving                                | safe_hold       | stop
42 | case_closed             | {IDLE}                                | closed          | checkpoint
43 | case_aborted            | {LIVE}                                | aborted         | stop
44 | note                    | {LIVE} {OVER}                         | same            |
44 | label                   | {LIVE} {OVER}                         | same            |
44 | read                    | {LIVE} {OVER}                         | same            |
44 | export                  | {LIVE} {OVER}                         | same            |
"""
KINDS = {
    "o": "image_arrived registration_completed registration_refused arrived missed released verification_passed "
    "verification_failed verification_refused arm_disturbed fault restarted",
    "f": "sleeve_in insertion_cancelled sleeve_removed guide_state_stated carm_moved patient_moved hand_guided "
    "device_changed case_aborted",
}


@dataclass(frozen=True)
class Expected:
    number: int
    to: str
    effects: tuple[str, ...]


def expanded() -> dict[tuple[str, str], Expected]:
    cells: dict[tuple[str, str], Expected] = {}
    for line in SECOND_TABLE.strip().splitlines():
        number, trigger, sources, to, effects = (part.strip() for part in line.split("|"))
        for source in sources.split():
            assert (source, trigger) not in cells, f"the second table has two rows for {trigger} in {source}"
            cells[source, trigger] = Expected(int(number), to, tuple(effects.split()))
    return cells


CELLS = expanded()
EVERY_CELL = [(state, trigger) for state in State for trigger in Trigger]


def chain_after(chain: str, effects: tuple[str, ...], passed: bool) -> str:
    left = set(chain)
    for effect in effects:
        if effect.startswith("-") and effect.endswith("+"):
            left -= set(CHAIN[CHAIN.index(effect[1]) :])
        elif effect.startswith("-"):
            left.discard(effect[1])
        elif effect.startswith("+"):
            left.add(effect[1])
        elif effect == "!E" and passed:
            left.add("E")
    return "".join(letter for letter in CHAIN if letter in left)


def settled(chain: str, passed: bool, insertion: str) -> str:
    if insertion != "none":
        return {"open": "inserting", "done": "sleeve_inserted"}[insertion]
    if "E" in chain and passed:
        return "verified"
    if set("VIRTM") <= set(chain):
        return "off_target" if "E" in chain else "moved"
    by_letter = {"T": "target_chosen", "R": "registered", "I": "image_acquired", "V": "carm_positioned"}
    return next((state for letter, state in by_letter.items() if letter in chain), "case_open")


def letters(case) -> str:
    return "".join(letter for letter, link in zip(CHAIN, LINKS, strict=True) if getattr(case, link) is not None)


def insertion(case) -> str:
    return case.insertion.status.value if case.insertion else "none"


def prepare(walk, state: State, trigger: Trigger):
    """The usual case in a state, with the plan and the permit that a motion from there would need."""
    walk.to(state)
    if trigger in (Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED) and state in State and state.value in IDLE.split():
        if state is not State.TARGET_CHOSEN:
            walk.do(Trigger.PLAN_REQUESTED, kind="retreat")
        if trigger is Trigger.MOVE_STARTED and state is not State.TARGET_CHOSEN:
            walk.do(Trigger.MOVE_APPROVED)
    if trigger is Trigger.NEWEST_IMAGE_REUSED and state is State.CARM_POSITIONED:
        walk.do(Trigger.IMAGE_ARRIVED)
        walk.do(Trigger.RETAKE)
    if trigger is Trigger.IMAGE_ARRIVED and state is State.MOVED:
        walk.do(Trigger.EXPOSURE_REQUESTED)
    if trigger is Trigger.TARGET_DONE and state is State.SLEEVE_INSERTED:
        walk.do(Trigger.SLEEVE_REMOVED)
    return walk.case


def asked(walk, trigger: Trigger):
    if trigger is Trigger.PLAN_REQUESTED and walk.case.state is not State.TARGET_CHOSEN:
        return walk.ask(trigger, kind="retreat")
    return walk.ask(trigger)


@pytest.mark.hazard("H22")
@pytest.mark.parametrize(("state", "trigger"), EVERY_CELL, ids=lambda value: value.value)
def test_every_cell_is_as_the_second_table_says(walk, state, trigger):
    before = prepare(walk, state, trigger)
    answer = asked(walk, trigger)
    expected = CELLS.get((state.value, trigger.value))
    if expected is None:
        check_unlisted(before, trigger, answer)
    else:
        check_listed(before, expected, answer)


@pytest.mark.hazard("H22")
@pytest.mark.parametrize("state", State)
def test_what_a_person_states_is_taken_alike_where_nothing_was_measured(new_walk, state):
    for trigger in (one for one in Trigger if one.kind is Kind.FACT):
        walk = new_walk().to(state)
        case, facts = walk.case, walk.facts(trigger)
        measured, unmeasured = (
            decide(case, trigger, facts, snapshot, walk.limits, walk.now_s) for snapshot in (walk.snapshot, None)
        )
        assert measured == unmeasured
        assert measured.verdicts == ()


def check_listed(before, expected: Expected, answer) -> None:
    assert isinstance(answer, Decision), answer
    after, passed = answer.after, bool(before.verification and before.verification.passed)
    assert answer.row == expected.number
    chain = chain_after(letters(before), expected.effects, passed)
    slots = dict(effect.split("=") for effect in expected.effects if "=" in effect)
    goes_to = {"same": before.state.value, "settle": settled(chain, passed, slots.get("S", insertion(before)))}
    assert after.state.value == goes_to.get(expected.to, expected.to)
    kept = chain if after.state is before.state else chain.replace("A", "")
    assert letters(after) == kept
    assert insertion(after) == slots.get("S", insertion(before))
    assert after.guide.value == slots.get("G", before.guide.value)
    assert (Effect.STOP_SENT in answer.effects) == ("stop" in expected.effects)
    assert (Effect.ALARM in answer.effects) == ("alarm" in expected.effects)
    assert (Effect.CHECKPOINT_SIGNED in answer.effects) == ("checkpoint" in expected.effects)
    assert after.running is None or after.state is State.MOVING


def check_unlisted(before, trigger: Trigger, answer) -> None:
    if trigger.kind is Kind.REQUEST:
        assert isinstance(answer, Refusal), answer
        assert answer.code.value == refusal_of(before, trigger)
        assert answer.leads_onwards
        return
    assert isinstance(answer, Decision)
    assert answer.after == before
    assert answer.row is None
    assert answer.outcome is (Outcome.LATE if trigger.kind is Kind.OBSERVATION else Outcome.RECORDED)


def refusal_of(case, trigger: Trigger) -> str:
    """The order of the description: over, held, moving, guide, insertion, missing, not now."""
    by_state = {"closed": "case_over", "aborted": "case_over", "safe_hold": "held", "moving": "arm_moving"}
    if case.state in by_state:
        return by_state[case.state]
    if case.state.value in ("inserting", "sleeve_inserted"):
        wants_empty = trigger in (
            Trigger.MOVE_APPROVED,
            Trigger.MOVE_STARTED,
            Trigger.CASE_CLOSED,
            Trigger.TARGET_DONE,
        )
        return "instrument_in_guide" if wants_empty and case.guide is GuideState.INSTRUMENT else "insertion_running"
    return "missing" if lacks_something(case, trigger) else "not_now"


def lacks_something(case, trigger: Trigger) -> bool:
    needs = {
        "exposure_requested": "V",
        "newest_image_reused": "V",
        "retake": "VI",
        "target_confirmed": "VIR",
        "target_withdrawn": "VIRT",
        "correction_requested": "VIRTME",
        "verification_rejected": "VIRTME",
        "insertion_started": "E",
        "target_done": "E",
    }
    return not set(needs.get(trigger.value, "")) <= set(letters(case))


def test_the_two_tables_have_the_same_kinds_and_44_rows():
    for trigger in Trigger:
        expected = next((kind for kind, names in KINDS.items() if trigger.value in names.split()), "q")
        assert trigger.kind.value == expected
    assert {entry.number for entry in TABLE if isinstance(entry, Row)} == set(range(1, 45))
    assert {cell.number for cell in CELLS.values()} == set(range(1, 45))


@pytest.mark.parametrize("missing", range(len(TABLE)))
def test_a_table_without_one_of_its_entries_is_refused(missing):
    with pytest.raises(IncompleteTableError, match=f"no entry for {TABLE[missing].trigger} in"):
        index(TABLE[:missing] + TABLE[missing + 1 :])


def test_nothing_starts_on_a_table_that_is_not_whole():
    """The conductor decides by `workflow.machine`: what cannot be imported serves nobody."""
    broken = "import workflow.table as table; table.TABLE = table.TABLE[1:]; import workflow.machine"
    started = subprocess.run([sys.executable, "-c", broken], capture_output=True, text=True)
    assert started.returncode != 0
    assert "IncompleteTableError: no entry for" in started.stderr


def test_a_table_with_overlapping_rows_is_refused():
    row = next(entry for entry in TABLE if isinstance(entry, Row))
    with pytest.raises(IncompleteTableError, match="two entries"):
        index((*TABLE, row))


def test_a_row_that_settles_nowhere_is_refused():
    settling = next(entry for entry in TABLE if isinstance(entry, Row) and entry.settles_to)
    others = tuple(entry for entry in TABLE if entry is not settling)
    with pytest.raises(IncompleteTableError, match="settles"):
        index((*others, replace(settling, settles_to=frozenset())))


def test_an_insertion_that_was_open_in_a_hold_is_done_or_cancelled_there(walk):
    walk.to(State.INSERTING).do(Trigger.HOLD_REQUESTED)
    held = walk.case
    walk.do(Trigger.SLEEVE_IN)
    assert walk.case.insertion.status is InsertionStatus.DONE
    assert not walk.case.insertion.verified
    walk.case = held
    walk.do(Trigger.INSERTION_CANCELLED)
    assert (walk.case.state, walk.case.insertion, walk.case.guide) == (State.SAFE_HOLD, None, GuideState.EMPTY)
