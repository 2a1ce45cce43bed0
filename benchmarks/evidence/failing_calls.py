"""The writing system calls of a whole case, each in turn the last thing that the process does, or one that fails."""

import shutil
from collections.abc import Iterator, Sequence
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

CALLS = "writing-calls"  # a file of the inputs: how many of them a whole case makes
KILLED = ("signal=SIGKILL",)
# A call fails once, or from then on: a full disk, a disk that is broken.
FAILING = ("error=ENOSPC", "error=EIO", "error=ENOSPC from then on", "error=EIO from then on")
_FOREVER = " from then on"


def is_of_the_database(call: Call) -> bool:
    """Whether a call is one of those that are met, in turn."""
    return call.path.startswith("coaxial.sqlite") and call.name in WRITING


def trials(inputs: Path, numbers: Sequence[int], faults: Sequence[str]) -> Iterator[Trial]:
    """Trial n meets call n // len(faults) + 1 with fault n % len(faults)."""
    for number in numbers:
        nth, which = divmod(number, len(faults))
        with TemporaryDirectory() as place:
            victim = Path(place) / "data"
            shutil.copytree(inputs / SMALL, victim)
            yield {"number": number, "kind": faults[which], "call": nth + 1} | _tried(victim, faults[which], nth + 1)


def _tried(folder: Path, fault: str, nth: int) -> Trial:
    """What came of one run, and what the next one finds."""
    lasting = fault.endswith(_FOREVER)
    ran = with_fault(folder, fault.removesuffix(_FOREVER), f"{nth}+" if lasting else f"{nth}")
    lines = [line.split() for line in ran.said.splitlines()]
    acknowledged = max((int(number) for word, number in lines if word == "entry"), default=0)
    entries, corrupt = look(folder)
    told = _told(fault, [word for word, _ in lines], ran.status, ran.errors)
    goes_on = "" if corrupt else _goes_on(folder)
    missed = "" if ran.met else "the fault did not come: nothing was tried"
    said = "; ".join(text for text in (missed, corrupt, told, goes_on) if text)
    return {"bad": bool(said) or entries < acknowledged, "acknowledged": acknowledged, "entries": entries, "said": said}


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
