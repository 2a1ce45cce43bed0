"""Whole procedures one behind the other in one service: open descriptors, memory, and the ledger in the end.

The C-arm sends two kept images, the guide before a motion of a millimetre and after it, each time with pixels of its
own. What the service holds is that of its process, its guard and its image worker together.
"""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.stats import linregress, t

from benchmarks.evidence.item import Trial
from benchmarks.evidence.kept_images import KeptImages
from benchmarks.evidence.served_room import serve_room
from coaxial_client import Case
from tests.system.conftest import CASE, prepare
from tests.system.service_process import PIN, Service
from tests.system.walk import Held, Walk

# Of a run, in which what is made once and kept is made: connections of pools, caches, the image worker's memory.
_SETTLING = 0.2
_SPARE_DESCRIPTORS = 8  # connections of two pools and of a client may be open or not just then
MOST_KB = 20.0  # that a procedure may cost for ever: 10 MB in 500, which is more than a year of one room
_BLOCKS = 10  # neighbouring procedures are no independent measurements of a slope
_TRIES = 5  # a crowded machine loses the feedback or the hold, and the case is held
_LONGEST_S = 60.0  # of a motion of a millimetre
_WAY = ("carm_positioned", "registered", "target_chosen", "moved", "verified", "inserting", "sleeve_inserted")


def procedures(folder: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """A procedure for each number, all in one process; behind the last one the slope is judged and the ledger read."""
    del folder  # nothing is prepared
    used: list[tuple[int, float]] = []
    with TemporaryDirectory() as place, ExitStack() as opened:
        room = SoakedRoom(opened, Path(place))
        for number in numbers:
            held = room.procedure()
            used.append(room.used())
            last = number == numbers[-1]
            said = "; ".join(filter(None, (leaking(used), growing(used), room.unverified()))) if last else ""
            tries = f"begun anew after {', '.join(held)}" if held else "held nowhere"
            kind = f"{len(used)} in one process, {told(used)}" if last else tries
            descriptors, memory_mb = used[-1]
            measured = {"descriptors": descriptors, "memory_mb": memory_mb}
            yield {"number": number, "kind": kind, "bad": bool(said), "said": said} | measured


class PatientWalk(Walk):
    """A case whose motion does not arrive is held, whatever ended it: the machine may be a crowded one."""

    def moved(self, kind: str = "targeting", **goal: object) -> None:
        """Plan, approve and hold until it is over."""
        with self.case.hold(self.case.approve(self.case.plan(kind, **goal), PIN)) as hold:
            cause = hold.wait(_LONGEST_S).cause
        if cause != "arrived":
            raise Held(cause)


class SoakedRoom:
    """A service over a simulated controller, and a C-arm with two images."""

    def __init__(self, opened: ExitStack, folder: Path) -> None:
        self._service, self._controller = serve_room(opened, folder, Service)
        self._images = KeptImages(self._service, str(CASE["patient_id"]), str(CASE["study_uid"]))
        self._report = folder / "report.pdf"
        self._start: dict[str, list[float]] | None = None  # the arm's pose before the first motion

    def procedure(self) -> list[str]:
        """One case to its report; why those before it were held, and aborted."""
        held: list[str] = []
        while len(held) < _TRIES:
            self._controller.release()
            with self._service.sign_in() as client:
                case = prepare(client.open_case(CASE))
                try:
                    self._go(case)
                except Held as why:
                    held.append(str(why))
                    case.command("case-aborted", reason="the machine is too busy")
                else:
                    case.report(self._report)
                    return held
                finally:
                    client.sign_out()
        raise RuntimeError(f"the machine is too busy, cases were held one after the other: {', '.join(held)}")

    def _go(self, case: Case) -> None:
        walk = PatientWalk(case, self._images)
        walk.source_from_guide = self._images.source_from_start
        self._start = self._start or _pose(case)
        for step in _WAY:
            getattr(walk, step)()
        case.command("sleeve-removed", guide="empty")
        case.command("target-done", placed=True)
        case.command("carm-moved", what="away, and the arm back to where it began")
        walk.moved("approach", base_from_goal=self._start)
        case.command("case-closed", pin=PIN, abandoned={"L3 right": "the procedure is a short one"})

    def used(self) -> tuple[int, float]:
        """Open descriptors and the memory, MB, that service, guard and image worker have for themselves."""
        each = [_used(process) for process in _family(self._service.process.pid)]
        return sum(descriptors for descriptors, _ in each), sum(memory_mb for _, memory_mb in each)

    def unverified(self) -> str:
        """What `coaxial audit verify` finds; nothing where all is well."""
        ran = self._service.run("audit", "verify")
        return "" if ran.returncode == 0 else (ran.stdout + ran.stderr).strip()[-500:]


def told(used: Sequence[tuple[int, float]]) -> str:
    """What came of it, in words."""
    slope_kb = _slope_kb(used)
    grown = f"{slope_kb[0]:+.1f} to {slope_kb[1]:+.1f} kB a procedure (95 %)" if slope_kb else "not judged, too few"
    return f"{used[-1][0]} descriptors, memory {grown}"


def leaking(used: Sequence[tuple[int, float]]) -> str:
    """Descriptors that were not closed."""
    (first, _), (last, _) = _settled(used)[0], used[-1]
    return f"{last} descriptors, {first} once all was settled" if last > first + _SPARE_DESCRIPTORS else ""


def growing(used: Sequence[tuple[int, float]]) -> str:
    """Memory that may grow by more than is allowed."""
    slope_kb = _slope_kb(used)
    return f"memory may grow by {slope_kb[1]:.1f} kB a procedure" if slope_kb and slope_kb[1] >= MOST_KB else ""


def _settled(used: Sequence[tuple[int, float]]) -> Sequence[tuple[int, float]]:
    return used[int(_SETTLING * len(used)) :]


def _slope_kb(used: Sequence[tuple[int, float]]) -> tuple[float, float] | None:
    """The 95 % confidence interval of the growth a procedure, kB, None of too few.

    Of the means of blocks, for neighbours depend on one another.
    """
    settled = np.array([memory_mb for _, memory_mb in _settled(used)]) * 1e3
    size = len(settled) // _BLOCKS
    if size == 0:
        return None
    means = settled[: size * _BLOCKS].reshape(_BLOCKS, size).mean(axis=1)
    line = linregress(np.arange(_BLOCKS) * size, means)
    half = t.ppf(0.975, _BLOCKS - 2) * line.stderr
    return float(line.slope - half), float(line.slope + half)


def _pose(case: Case) -> dict[str, list[float]]:
    pose = np.array(case.status()["arm"]["base_from_tcp"])
    vector_deg = Rotation.from_matrix(pose[:3, :3]).as_rotvec(degrees=True)
    return {"translation_mm": pose[:3, 3].tolist(), "rotation_vector_deg": vector_deg.tolist()}


def _family(process: int) -> list[int]:
    """A process and all that it started."""
    tasks = Path(f"/proc/{process}/task").glob("*/children")
    children = [int(child) for task in tasks for child in task.read_text().split()]
    return [process, *(one for child in children for one in _family(child))]


def _used(process: int) -> tuple[int, float]:
    status = Path(f"/proc/{process}/status").read_text()
    anonymous = next(line for line in status.splitlines() if line.startswith("RssAnon:"))
    return len(list(Path(f"/proc/{process}/fd").iterdir())), int(anonymous.split()[1]) / 1e3
