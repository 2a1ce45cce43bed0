"""What the evidence consists of."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from benchmarks import check_removal, interlock_removal
from benchmarks.evidence import failing_calls, power_loss, soak, tampering
from benchmarks.evidence.failing_calls import CALLS, FAILING, KILLED
from benchmarks.evidence.inputs import prepare_all
from benchmarks.evidence.item import Item, Trials
from benchmarks.fuzz import child, http_requests
from benchmarks.fuzz import trials as fuzzing
from benchmarks.fuzz.targets import TARGETS, Target
from benchmarks.removal import Removal
from benchmarks.removal import trials as trials_of_removal
from benchmarks.states import kills, races, sequences

_SCHEMA = "migrations/versions/*.py"
_SOAKED = 500  # procedures
_DEVICES = tuple(f"tests/devices/{name}.toml" for name in ("guide", "flat-panel", "tcp", "room"))
# What `coaxial serve`, its guard and its image worker are started with; nobody imports them.
_SERVICE = ("service.cli.main", "service.cli.serve", "robot.guard.__main__", "service.vision_jobs")


def _always(count: int) -> Callable[[Path], int]:
    return partial(_constant, count)


def _constant(count: int, _inputs: Path) -> int:
    return count


def _calls(faults: int, inputs: Path) -> int:
    return len((inputs / CALLS).read_text().split()) * faults


# An item whose trials are about one whole case and its record.
_of_a_whole_case = partial(
    Item,
    modules=(failing_calls.__name__, power_loss.__name__, tampering.__name__),
    files=(_SCHEMA, *_DEVICES),
    prepare=prepare_all,
)


def _of_every_call(name: str, what: str, asked: str, faults: Sequence[str]) -> Item:
    """Every call in turn with every fault."""
    count, trials = partial(_calls, len(faults)), partial(failing_calls.trials, faults=faults)
    return _of_a_whole_case(name, what, asked, count, trials, at_once=20, waits=True)


def _contested(database: str, trials: Trials, *, waits: bool) -> Item:
    return Item(
        f"contested_permits_{database.lower()}",
        f"one permit held by {races.FEWEST} to {races.MOST} clients at once, {database}",
        "exactly one motion",
        _always(10_000),
        trials,
        at_once=200,
        modules=(races.__name__,),
        files=(_SCHEMA, *_DEVICES),
        waits=waits,
    )


def _fuzzed(name: str, target: Target) -> Item:
    """Some thousand executions a trial."""
    return Item(
        f"fuzz_{name}",
        f"fuzzing: {target.what}",
        "taken or refused with a type; 0 crashes, 0 beyond 1 s",
        _always(target.planned // target.of_a_trial),
        partial(fuzzing.trials, name),
        at_once=1,
        modules=(fuzzing.__name__, child.__name__, target.module),
        files=_DEVICES,
        executions=target.of_a_trial,
    )


def _removed(name: str, what: str, names: Sequence[str], removal: Removal) -> Item:
    """Each in turn, until the first test fails."""
    return Item(
        name,
        f"each {what} taken out in turn",
        "a test fails",
        _always(len(names)),
        partial(trials_of_removal, removal, names),
        at_once=10,
        modules=(*removal.modules, "tests.conftest", f"{removal.modules[1].rpartition('.')[0]}.conftest"),
        files=(_SCHEMA, *_DEVICES),
    )


ITEMS = (
    _removed("interlock_removal", "interlock of the rules", interlock_removal.NAMES, interlock_removal.REMOVAL),
    _removed("check_removal", "check of the guard", check_removal.NAMES, check_removal.REMOVAL),
    _of_every_call(
        "kill_at_every_write",
        "SIGKILL at every write or sync of one whole case",
        "0 acknowledged lost, 0 corrupt",
        KILLED,
    ),
    _of_every_call(
        "failing_writes",
        "every write or sync of one whole case fails once, and from then on: disk full, I/O error",
        "typed refusal, reads served, 0 acknowledged lost, goes on when space returns",
        FAILING,
    ),
    _of_a_whole_case(
        "power_loss",
        "power cut: unsynced writes dropped, kept, cut, reordered or torn",
        "0 acknowledged lost, 0 corrupt",
        _always(200_000),
        power_loss.power_cuts,
        at_once=10_000,  # the more, the more of them leave the same
    ),
    _of_a_whole_case(
        "losing_modes",
        "the same with modes of SQLite that are known to lose",
        "each is flagged",
        _always(len(power_loss.LOSING)),
        power_loss.losing_modes,
        at_once=1,
    ),
    _of_a_whole_case(
        "tampering",
        "one bit of the database's file flipped",
        "found, or no record changed",
        _always(20_000),
        tampering.flips,
        at_once=500,
    ),
    Item(
        "reference_model",
        f"random sequences of {sequences.STEPS} commands, facts and observations over HTTP against a reference model",
        "0 differences",
        _always(20_000),
        sequences.sequences,
        at_once=100,
        modules=(sequences.__name__,),
        files=(_SCHEMA, *_DEVICES),
    ),
    Item(
        "kill_at_any_moment",
        "SIGKILL of the running service at random moments of a procedure",
        "0 acknowledged lost, 0 there twice, 0 motion after the start",
        _always(2_000),
        kills.kills,
        at_once=50,
        modules=(kills.__name__, *_SERVICE, "simulator.controller.__main__"),
        files=(_SCHEMA, *_DEVICES),
        waits=True,
    ),
    Item(
        "soak",
        "whole procedures one behind the other in one process, from the opened case to the closed one and its report",
        f"no more descriptors, memory grows by less than {soak.MOST_KB:g} kB a procedure (95 %), the ledger verifies",
        _always(_SOAKED),
        soak.procedures,
        at_once=_SOAKED,  # all in one process, unless the run is interrupted
        modules=(soak.__name__, *_SERVICE, "simulator.controller.__main__"),
        files=(_SCHEMA, *_DEVICES),
        waits=True,
    ),
    _contested("SQLite", races.on_sqlite, waits=False),
    _contested("PostgreSQL", races.on_postgresql, waits=True),  # on its server
    *(_fuzzed(name, target) for name, target in TARGETS.items()),
    Item(
        "requests",
        "requests made from the interface description (schemathesis), as each role and as nobody",
        "0 of 5xx",
        _always(100_000 // http_requests.OF_A_TRIAL),
        http_requests.trials,
        at_once=100,
        modules=(http_requests.__name__, "service.vision_jobs"),
        files=(_SCHEMA, *_DEVICES),
        executions=http_requests.OF_A_TRIAL,
    ),
)
