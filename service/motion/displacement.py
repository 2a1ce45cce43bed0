"""How far the guide has moved without a commanded motion: the ledger behind H04 and H29."""

from dataclasses import dataclass

from robot.arm import ArmState
from robot.frames import Transform, distance_between


@dataclass(frozen=True, slots=True)
class Displacement:
    """Of the TCP."""

    offset_mm: float
    angle_rad: float


@dataclass(frozen=True, slots=True)
class Baseline:
    """A total of the ledger; worth nothing once the ledger was lost."""

    total: Displacement
    losses: int


class DisplacementLedger:
    """Adds up what no motion accounts for: closed stretches, and the distance from where the open one began.

    A stretch ends where a motion starts and where an exposure is requested; the next begins where the arm is at rest
    again. After a motion that ended without feedback nothing can be told any more.
    """

    def __init__(self) -> None:
        self._closed = Displacement(0.0, 0.0)
        self._base_from_anchor: Transform | None = None
        self._moving = False
        self._losses = 0

    def observe(self, reading: ArmState) -> None:
        """Anchor the first stretch at the first reading."""
        if self._base_from_anchor is None and not self._moving:
            self._base_from_anchor = reading.base_from_tcp

    def start_motion(self, base_from_start: Transform) -> None:
        """A commanded motion begins here: what happened up to it is closed."""
        self._close(base_from_start)
        self._moving = True

    def end_motion(self, left: ArmState | None) -> None:
        """The motion left the arm here; without a reading the ledger is lost."""
        self._moving = False
        self._base_from_anchor = None if left is None else left.base_from_tcp
        self._losses += left is None

    def lose_motion(self) -> None:
        """Nobody will tell how a motion under way ends: it has left the arm nobody knows where."""
        if self._moving:
            self.end_motion(None)

    def begin_stretch(self, reading: ArmState) -> Baseline:
        """Close the stretch at this reading; the total up to it."""
        self._close(reading.base_from_tcp)
        self._base_from_anchor = reading.base_from_tcp
        return Baseline(self._closed, self._losses)

    def since(self, baseline: Baseline, reading: ArmState) -> Displacement | None:
        """What came on top of an earlier total; None if the ledger was lost in between."""
        if baseline.losses != self._losses:
            return None
        offset_mm, angle_rad = self._open_stretch(reading.base_from_tcp)
        return Displacement(
            self._closed.offset_mm - baseline.total.offset_mm + offset_mm,
            self._closed.angle_rad - baseline.total.angle_rad + angle_rad,
        )

    def _close(self, base_from_here: Transform) -> None:
        offset_mm, angle_rad = self._open_stretch(base_from_here)
        self._closed = Displacement(self._closed.offset_mm + offset_mm, self._closed.angle_rad + angle_rad)

    def _open_stretch(self, base_from_here: Transform) -> tuple[float, float]:
        if self._base_from_anchor is None or self._moving:
            return 0.0, 0.0
        return distance_between(self._base_from_anchor, base_from_here)
