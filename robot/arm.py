"""What an arm is to the rest of the product."""

from dataclasses import dataclass
from typing import Protocol

from robot.frames import Array, Transform
from robot.safety import SafetyState


@dataclass(frozen=True, slots=True, eq=False)
class ArmState:
    """One reading of the arm, all of it from the same packet.

    Attributes
    ----------
    controller_time_s : float
        The controller's own clock; advances by one cycle a reading.
    received_at_s : float
        Monotonic clock of this machine (CLOCK_MONOTONIC: the same in every process).
    joints_rad, joint_speeds_rad_s : (6,)
        Base to wrist 3; windings kept.
    base_from_tcp : (4, 4), mm
        As the controller reports it, with its active TCP.
    tcp_speed_mm_s, tcp_turn_speed_rad_s : float
        Magnitudes of the TCP's linear and angular velocity.
    tcp_force_n : (3,)
        Force at the TCP as the controller estimates it, base axes.
    payload_kg, payload_centre_mm : float, (3,)
        Active payload, centre in the flange frame.
    safety_bits, robot_status_bits, robot_mode, runtime_state : int
        As on the wire; `safety` is their classification.
    program_running : bool
        Whether any program runs on the controller.
    """

    controller_time_s: float
    received_at_s: float
    joints_rad: Array
    joint_speeds_rad_s: Array
    base_from_tcp: Transform
    tcp_speed_mm_s: float
    tcp_turn_speed_rad_s: float
    tcp_force_n: Array
    payload_kg: float
    payload_centre_mm: Array
    safety_bits: int
    robot_status_bits: int
    robot_mode: int
    runtime_state: int
    program_running: bool
    safety: SafetyState


@dataclass(frozen=True, slots=True, eq=False)
class LinearMove:
    """One straight-line motion of the TCP.

    Attributes
    ----------
    base_from_goal : (4, 4), mm
    speed_mm_s, acceleration_mm_s2 : float
        Of the TCP along the line.
    """

    base_from_goal: Transform
    speed_mm_s: float
    acceleration_mm_s2: float


class Arm(Protocol):
    """A driver; every call is made from one thread, `send_stop` from any."""

    def read(self) -> ArmState | None:
        """Newest reading not read before, or None; raises nothing while the controller is away."""

    def connect(self) -> bool:
        """Open what is needed to read and to stop; False if the controller is away."""

    def take_control(self, watchdog_hz: float) -> None:
        """Upload the control script and arm the controller's watchdog."""

    def flange_from_tcp(self) -> Transform:
        """Active TCP of the controller, (4, 4) mm; needs control."""

    def move_linear(self, move: LinearMove) -> None:
        """Start a motion and return; needs control."""

    def feed_watchdog(self) -> None:
        """Tell the controller that the surgeon still holds; needs control."""

    def send_stop(self) -> bool:
        """Put a stop on the wire at once; True if it was written."""

    def stop_script(self) -> None:
        """End the control script over its own connection, beside `send_stop`; harmless without control."""

    def give_up_control(self) -> None:
        """Stop the control script and close its connection; harmless without control."""

    def release_pendant(self) -> None:
        """Give up everything but the feedback; the next stop or control opens it again."""

    def is_severed(self) -> bool:
        """Whether a connection broke while in control: what would be opened anew must be ended with the process."""

    def is_stuck(self) -> bool:
        """Whether only a new process can take control again."""

    def close(self) -> None:
        """Stop, and leave the controller; nothing can be asked afterwards."""
