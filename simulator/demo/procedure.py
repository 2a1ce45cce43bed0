"""One case from opening to closing: the planned pedicles one after the other, each in its own view."""

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack

from coaxial_client import Case, Coaxial
from simulator.demo.door_client import PlannedPedicle
from simulator.demo.failure import DemoFailed
from simulator.demo.results import TargetResult
from simulator.demo.stage import Stage
from simulator.demo.targeting import place_sleeve
from simulator.demo.team import Team
from simulator.demo.telling import Teller

_ARM_WITHIN_S = 30.0
_LOOK_EVERY_S = 0.1
# True errors beyond the procedure's own limits mean that a verification passed that should not have.
_LIMIT_DEG, _LIMIT_MM = 1.0, 1.5


def run_case(stage: Stage, pedicles: Sequence[PlannedPedicle], teller: Teller) -> Iterator[TargetResult]:
    """Each target's result as soon as its sleeve is placed; the case is closed after the last."""
    with ExitStack() as open_clients:
        surgeon = open_clients.enter_context(stage.sign_in("surgeon"))
        operator = open_clients.enter_context(stage.sign_in("operator"))
        team = open_case(stage, surgeon, operator, pedicles, teller)
        for pedicle in pedicles:
            teller.about = pedicle.name
            result = place_sleeve(team, pedicle.name)
            _check_truth(result)
            yield result
        teller.about = "case"
        _close_case(team)


def open_case(
    stage: Stage, surgeon: Coaxial, operator: Coaxial, pedicles: Sequence[PlannedPedicle], teller: Teller
) -> Team:
    """A case for the patient in the room, control taken as soon as the arm is read; DemoFailed if it never is."""
    room = stage.door.room()
    case = surgeon.open_case(
        {
            "patient_id": room["patient"]["id"],
            "study_uid": room["study_uid"],
            "position": room["patient"]["position"],
            "targets": [
                {"name": one.name, "entry_mm": list(one.entry_mm), "target_mm": list(one.target_mm)} for one in pedicles
            ],
        }
    )
    teller.tell(f"case {case.id[:8]} open: {', '.join(one.name for one in pedicles)}")
    with teller.doing("waiting for the arm"):
        _await_arm(case)
    case.take_lease("targeting")
    return Team(case, operator.case(case.id), stage.people["surgeon"].pin, stage.door, teller)


def _await_arm(case: Case) -> None:
    end_s = time.monotonic() + _ARM_WITHIN_S
    while not case.status()["arm"]["connected"]:
        if time.monotonic() > end_s:
            raise DemoFailed("arm_not_connected", f"the service reads no arm after {_ARM_WITHIN_S:g} s")
        time.sleep(_LOOK_EVERY_S)


def _check_truth(result: TargetResult) -> None:
    true = result.final.true
    if true.angle_deg > _LIMIT_DEG or true.position_mm > _LIMIT_MM:
        text = f"{result.name} was verified, but is {true.angle_deg:.3f} deg and {true.position_mm:.3f} mm off"
        raise DemoFailed("verified_wrongly", text)


def _close_case(team: Team) -> None:
    status = team.surgeon.status()
    team.surgeon.command("case-closed", pin=team.pin)
    team.teller.tell(f"closed: {len(team.surgeon.record())} events, {status['images']} images in the record")
