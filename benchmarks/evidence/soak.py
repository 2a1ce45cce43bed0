"""Whole procedures one behind the other in one service: open descriptors, memory, and the ledger in the end.

The C-arm sends two kept images, the guide before a motion of a millimetre and after it, each time with pixels of its
own. What the service holds is that of its process, its guard and its image worker together; the growth is told of each.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

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

# What names a process in its command line.
_PARTS = {
    "robot.guard": "guard",
    "resource_tracker": "Python's resource tracker",
    "spawn_main": "image worker",
    "main() serve": "service",
}
_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class Used:
    """What a service holds with all that it started: open descriptors, and each part's own memory, MB."""

    descriptors: int
    parts_mb: Mapping[str, float]

    @property
    def memory_mb(self) -> float:
        """Of all parts together."""
        return sum(self.parts_mb.values())


def procedures(folder: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """A procedure for each number, all in one process; behind the last one the slope is judged and the ledger read."""
    del folder  # nothing is prepared
    used: list[Used] = []
    with TemporaryDirectory() as place, ExitStack() as opened:
        room = SoakedRoom(opened, Path(place))
        for number in numbers:
            held = room.procedure()
            used.append(room.used())
            last = number == numbers[-1]
            said = "; ".join(filter(None, (leaking(used), growing(used), room.unverified()))) if last else ""
            tries = f"begun anew after {', '.join(held)}" if held else "held nowhere"
            kind = f"{len(used)} in one process, {told(used)}" if last else tries
            measured = {"descriptors": used[-1].descriptors, "memory_mb": used[-1].memory_mb}
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

    def used(self) -> Used:
        """What service, guard and image worker have for themselves."""
        family = _family(self._service.process.pid)
        parts_mb: dict[str, float] = defaultdict(float)
        for one in family:
            parts_mb[_part(one)] += _memory_mb(one)
        return Used(sum(_descriptors(one) for one in family), parts_mb)

    def unverified(self) -> str:
        """What `coaxial audit verify` finds; nothing where all is well."""
        ran = self._service.run("audit", "verify")
        return "" if ran.returncode == 0 else (ran.stdout + ran.stderr).strip()[-500:]


def told(used: Sequence[Used]) -> str:
    """What came of it, in words."""
    together = _slope_kb([one.memory_mb for one in used])
    if together is None:
        return f"{used[-1].descriptors} descriptors, memory not judged, too few"
    low_kb, high_kb = together
    parts = ", ".join(f"{part} {grown_kb:+.1f}" for part, grown_kb in _grown_kb(used).items())
    return (
        f"{used[-1].descriptors} descriptors, "
        f"memory {low_kb:+.1f} to {high_kb:+.1f} kB a procedure (95 %), by part {parts}"
    )


def leaking(used: Sequence[Used]) -> str:
    """Descriptors that were not closed."""
    first, last = _settled(used)[0].descriptors, used[-1].descriptors
    return f"{last} descriptors, {first} once all was settled" if last > first + _SPARE_DESCRIPTORS else ""


def growing(used: Sequence[Used]) -> str:
    """Memory that may grow by more than is allowed."""
    slope_kb = _slope_kb([one.memory_mb for one in used])
    return f"memory may grow by {slope_kb[1]:.1f} kB a procedure" if slope_kb and slope_kb[1] >= MOST_KB else ""


def _grown_kb(used: Sequence[Used]) -> dict[str, float]:
    """The middle of each part's growth a procedure, kB, the largest first."""
    slopes_kb = {part: _slope_kb([one.parts_mb.get(part, 0.0) for one in used]) for part in used[-1].parts_mb}
    middle_kb = {part: (slope[0] + slope[1]) / 2 for part, slope in slopes_kb.items() if slope}
    return dict(sorted(middle_kb.items(), key=lambda one: -one[1]))


def _settled(used: Sequence[_T]) -> Sequence[_T]:
    return used[int(_SETTLING * len(used)) :]


def _slope_kb(memory_mb: Sequence[float]) -> tuple[float, float] | None:
    """The 95 % confidence interval of the growth a procedure, kB, None of too few.

    Of the means of blocks, for neighbours depend on one another.
    """
    settled = np.array(_settled(memory_mb)) * 1e3
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


def _part(process: int) -> str:
    command = Path(f"/proc/{process}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    return next((part for sign, part in _PARTS.items() if sign in command), f"process {process}")


def _descriptors(process: int) -> int:
    return len(list(Path(f"/proc/{process}/fd").iterdir()))


def _memory_mb(process: int) -> float:
    status = Path(f"/proc/{process}/status").read_text()
    anonymous = next(line for line in status.splitlines() if line.startswith("RssAnon:"))
    return int(anonymous.split()[1]) / 1e3
