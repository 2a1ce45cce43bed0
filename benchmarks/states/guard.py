"""A guard without an arm: takes the service's commands, and says what a sequence wants it to have seen.

It takes the place of the guard's client, so that every message of the guard's is of the product's own type and goes
the product's own way. What it says is the same whenever it is said: its clock stands still between two steps.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from robot.arm import ArmState
from robot.frames import Transform
from robot.guard.messages import (
    BeginMove,
    Disturbed,
    EndCause,
    Event,
    Fault,
    FaultKind,
    Heartbeat,
    MotionEnded,
    MotionStarted,
    Phase,
    Status,
    StopSent,
)
from robot.kinematics import base_from_flange
from robot.safety import SafetyState
from robot.tool import Tool

# Robot mode, status bits and runtime state of a UR5 that is switched on; the rules read their classification only.
_POWERED = {"robot_mode": 7, "robot_status_bits": 3, "runtime_state": 1, "safety_bits": 1}
_CYCLE_S = 0.008  # of the controller
# What ends a motion without a fault, so that the guard does not lock itself.
_CALM = (EndCause.ARRIVED, EndCause.MISSED, EndCause.RELEASED)


class Clock:
    """A monotonic clock that goes on when it is told to."""

    def __init__(self) -> None:
        self.now_s = 1000.0

    def __call__(self) -> float:
        return self.now_s


@dataclass
class Readings:
    """What the arm is seen to do beside being somewhere."""

    at_rest: bool = True
    safety: SafetyState = SafetyState.NORMAL
    program_running: bool = False
    payload_kg: float | None = None  # None: as the tool file says


@dataclass
class ScriptedGuard:
    """As the guard's client is to the bridge. The arm stands at `joints_rad` (6,) whatever is said of its motions."""

    clock: Clock
    tool: Tool
    joints_rad: np.ndarray
    readings: Readings = field(default_factory=Readings)

    def __post_init__(self) -> None:
        self.begun = threading.Semaphore(0)  # motions that were handed over
        self.moves: list[BeginMove] = []
        self.status: Status | None = None
        self.process_id = 0
        self._phase = Phase.HELD
        self._beat: Heartbeat | None = None
        self._move: BeginMove | None = None
        self._cycles = 0
        self._on_event: Callable[[Event], None] = _nobody
        self._lock = threading.RLock()

    def __call__(self, _config: object, on_event: Callable[[Event], None]) -> "ScriptedGuard":
        """In place of the client's constructor."""
        self._on_event = on_event
        return self

    def start(self) -> None:
        """The first statuses."""
        self.look()

    def close(self) -> None:
        """Nothing to end."""

    @property
    def status_age_s(self) -> float | None:
        """By its own clock."""
        return None if self.status is None else self.clock() - self.status.sent_at_s

    def look(self) -> None:
        """Two statuses of now: the controller's clock is seen to advance."""
        with self._lock:
            self._say_status()
            self._say_status()

    def begin_move(self, move: BeginMove) -> None:
        """The motion is on the wire at once."""
        with self._lock:
            self.moves.append(move)
            self._move, self._phase = move, Phase.MOVING
            arm, pose = self._arm(), move.flange_from_guide
            started = MotionStarted(
                move.permit_id, self.clock(), arm.base_from_tcp, arm.joints_rad, pose, arm.payload_kg, np.zeros(3)
            )
            self._on_event(started)
            self.look()
        self.begun.release()

    def heartbeat(self, heartbeat: Heartbeat) -> None:
        """Told at once where it says something new."""
        with self._lock:
            before, self._beat = self._beat, heartbeat
            if before is None or (before.permit_id, before.held) != (heartbeat.permit_id, heartbeat.held):
                self._say_status()

    def stop(self, reason: str) -> bool:
        """The arm stands, the guard is locked; a motion is over."""
        with self._lock:
            self._phase = Phase.HELD
            self._on_event(StopSent(reason, self.clock(), written=True))
            if self._move is not None:
                self.end(EndCause.STOPPED, at_goal=False)
            self.look()
        return True

    def release_pendant(self, reason: str) -> bool:
        """As a stop."""
        return self.stop(reason)

    def acknowledge(self) -> bool:
        """Unlocked."""
        with self._lock:
            self._phase = Phase.IDLE if self._phase is Phase.HELD else self._phase
            self.look()
        return True

    def end(self, cause: EndCause, *, at_goal: bool, at_rest: bool = True) -> None:
        """The motion under way is over."""
        with self._lock:
            move, self._move, self._beat = self._move, None, None
            if move is None:
                raise ValueError("no motion is under way")
            self._phase = Phase.IDLE if cause in _CALM and at_rest else Phase.HELD
            off_mm = 0.02 if at_goal else 7.0
            ended = MotionEnded(
                permit_id=move.permit_id,
                cause=cause,
                at_s=self.clock(),
                at_rest=at_rest,
                program_stopped=True,
                distance_mm=off_mm,
                angle_rad=0.0,
                arm=self._arm(),
                stop_sent_at_s=None,
                trajectory_file="",
                trajectory_samples=0,
            )
            self._on_event(ended)
            self.look()

    def let_go(self) -> None:
        """Nobody holds a button."""
        with self._lock:
            self._beat = None
            self.look()

    @property
    def is_locked(self) -> bool:
        """Whether it refuses every motion."""
        return self._phase is Phase.HELD

    def fault(self, kind: FaultKind) -> None:
        """A fault without a motion; it locks the guard."""
        with self._lock:
            self._phase = Phase.HELD
            self._on_event(Fault(kind, self.clock(), "scripted"))
            self.look()

    def disturb(self) -> None:
        """A push that leaves the arm where it was."""
        self._on_event(Disturbed(self.clock(), 0.2, 0.0))

    def lock(self) -> None:
        """As a guard that starts."""
        with self._lock:
            self._phase, self._move, self._beat, self.readings = Phase.HELD, None, None, Readings()
            self.look()

    def _say_status(self) -> None:
        self._cycles += 1
        beat = self._beat
        self.status = Status(
            sequence=self._cycles,
            sent_at_s=self.clock(),
            phase=self._phase,
            challenge=f"c{self._cycles}",
            connected=True,
            arm=self._arm(),
            permit_id=None if beat is None else beat.permit_id,
            held=beat is not None and beat.held,
            heartbeat_age_s=None if beat is None else 0.0,
        )
        self._on_event(self.status)

    def _arm(self) -> ArmState:
        still = self.readings.at_rest and self._move is None
        return ArmState(
            controller_time_s=self._cycles * _CYCLE_S,
            received_at_s=self.clock(),
            joints_rad=self.joints_rad,
            joint_speeds_rad_s=np.zeros(6),
            base_from_tcp=self.base_from_tcp,
            tcp_speed_mm_s=0.0 if still else 10.0,
            tcp_turn_speed_rad_s=0.0,
            tcp_force_n=np.zeros(3),
            payload_kg=self.tool.payload_kg if self.readings.payload_kg is None else self.readings.payload_kg,
            payload_centre_mm=self.tool.payload_centre_mm,
            program_running=self.readings.program_running or self._move is not None,
            safety=self.readings.safety,
            **_POWERED,
        )

    @property
    def base_from_tcp(self) -> Transform:
        """(4, 4), mm: by the nominal kinematics."""
        return np.asarray(base_from_flange(self.joints_rad) @ self.tool.flange_from_guide)

    @property
    def rotation_vector_deg(self) -> list[float]:
        """(3,): of that pose."""
        vector_rad = Rotation.from_matrix(self.base_from_tcp[:3, :3]).as_rotvec()
        return [float(angle) for angle in np.rad2deg(vector_rad)]


def _nobody(_event: Event) -> None:
    """Nobody listens yet."""
