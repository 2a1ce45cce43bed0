"""What was asked for at the command line, and whether the room has it: told before anything is started."""

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

from simulator.controller import Fault
from simulator.demo.failure import NothingStartedError
from simulator.faults import RoomFault
from simulator.patient import build_patient
from simulator.truth import Truth, read_truth

_FOUR = ("L3-left", "L3-right", "L4-left", "L4-right")


@dataclass(frozen=True, slots=True)
class Wanted:
    """What was asked for at the command line."""

    pedicles: tuple[str, ...]  # none: those of the default
    data: Path | None
    port: int
    stay: bool
    faults: tuple[str, ...]
    truth: Path | None


def check(wanted: Wanted) -> None:
    """NothingStartedError where the room will not have what was asked for."""
    if wanted.stay and (wanted.pedicles or wanted.faults):
        raise NothingStartedError("nothing_to_place", "--stay runs no procedure: leave --pedicle and --fault out")
    truth = _truth(wanted.truth)
    planned = build_patient(truth.seed).pedicles if truth.ct is None else truth.ct.pedicles
    _refuse_unknown("pedicle_unknown", wanted.pedicles, planned)
    twice = [name for name, count in Counter(wanted.pedicles).items() if count > 1]
    if twice:
        raise NothingStartedError("pedicle_repeated", f"{', '.join(twice)}: a case has each target once")
    _refuse_unknown("fault_unknown", wanted.faults, sorted([*RoomFault, *Fault]))


def chosen(planned: Sequence[str], names: Sequence[str]) -> tuple[str, ...]:
    """The pedicles that were asked for, else the usual ones, else all that the room has."""
    return tuple(names) or (_FOUR if set(planned) >= set(_FOUR) else tuple(planned))


def _truth(file: Path | None) -> Truth:
    """As the room reads it; what is in the CT's own files only the room looks at."""
    if file is None:
        return read_truth()
    try:
        truth = read_truth(file.read_bytes(), file.parent)
        if truth.ct is not None:
            truth.ct.path.stat()
    except OSError as error:
        raise NothingStartedError("truth_refused", f"{error.filename}: {error.strerror}") from error
    except ValueError as error:
        raise NothingStartedError("truth_refused", f"{file}: {error}") from error
    return truth


def _refuse_unknown(code: str, names: Sequence[str], known: Collection[str]) -> None:
    unknown = [name for name in names if name not in known]
    if unknown:
        raise NothingStartedError(code, f"{', '.join(unknown)}; there are {', '.join(known)}")
