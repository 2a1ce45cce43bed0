"""The writing system calls of a whole case, each in turn the last thing that the process does, or one that fails."""

import shutil
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.evidence.item import Trial
from benchmarks.evidence.power_loss import look
from benchmarks.evidence.system_calls import WRITING, Call, with_fault
from benchmarks.evidence.whole_case import SMALL, settings_of
from service.audit import record_audit
from service.database.engines import Database, open_database
from service.errors import ServiceError
from service.ledger.keys import signing_key

CALLS = "writing-calls"  # a file of the inputs: the name of each that a whole case makes, in order
KILLED = ("signal=SIGKILL",)
# A call fails once, or from then on: a full disk, a disk that is broken.
FAILING = ("error=ENOSPC", "error=EIO", "error=ENOSPC from then on", "error=EIO from then on")
_FOREVER = " from then on"


def writing_calls(calls: Iterable[Call]) -> list[str]:
    """Names of those that are met in turn: what writes the files of the database, in order."""
    return [call.name for call in calls if call.path.startswith("coaxial.sqlite") and call.name in WRITING]


def trials(inputs: Path, numbers: Sequence[int], faults: Sequence[str]) -> Iterator[Trial]:
    """Trial n meets call n // len(faults) with fault n % len(faults)."""
    calls = (inputs / CALLS).read_text().split()
    for number in numbers:
        place_of_call, which = divmod(number, len(faults))
        with TemporaryDirectory() as place:
            victim = Path(place) / "data"
            shutil.copytree(inputs / SMALL, victim)
            tried = _tried(victim, faults[which], calls, place_of_call)
            yield {"number": number, "kind": f"{calls[place_of_call]} {faults[which]}", "call": place_of_call} | tried


def _tried(folder: Path, fault: str, calls: Sequence[str], at: int) -> Trial:
    """What came of one run, and what the next one finds."""
    ran = with_fault(folder, fault.removesuffix(_FOREVER), _counted(calls, at, lasting=fault.endswith(_FOREVER)))
    lines = [line.split() for line in ran.said.splitlines()]
    acknowledged = max((int(number) for word, number in lines if word == "entry"), default=0)
    entries, corrupt = look(folder)
    told = _told(fault, [word for word, _ in lines], ran.status, ran.errors)
    goes_on = "" if corrupt else _goes_on(folder)
    missed = "" if ran.met else "the fault did not come: nothing was tried"
    said = "; ".join(text for text in (missed, corrupt, told, goes_on) if text)
    return {"bad": bool(said) or entries < acknowledged, "acknowledged": acknowledged, "entries": entries, "said": said}


def _counted(calls: Sequence[str], at: int, *, lasting: bool) -> dict[str, str]:
    """Which call of each name is met: the tracer counts those of a name by themselves.

    What lasts meets the call and whatever is called behind it.
    """
    if not lasting:
        return {calls[at]: f"{calls[: at + 1].count(calls[at])}"}
    return {name: f"{calls[:at].count(name) + 1}+" for name in sorted(set(calls))}


def _told(fault: str, words: list[str], status: int, errors: str) -> str:
    """What is wrong with how a fault was told; a killed process tells nothing.

    Every refusal is typed, and what is recorded is read nevertheless. Once only: the step that was refused succeeds.
    """
    if fault in KILLED:
        return ""
    if "Traceback" in errors:
        return errors.splitlines()[-1]
    if status and "refused" not in words:
        return f"it ended with {status} and said nothing"
    if status and not fault.endswith(_FOREVER) and "read" in words:
        return "one fault that passed kept it from going on"
    return ""


def _goes_on(folder: Path) -> str:
    """Space is back, the process has been started again: what is said against recording."""
    settings = settings_of(folder)
    try:
        with closing(open_database(settings.database_url, signing_key(settings.key_file))) as database:
            _record_once(database)
    except ServiceError as error:
        return f"nothing can be recorded afterwards: {error}"
    return ""


def _record_once(database: Database) -> None:
    with database.write() as connection:
        record_audit(connection, "restarted", None, {})
