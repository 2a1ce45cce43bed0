"""Driver of a UR5 on the unmodified ur-rtde: the only module that drives by RTDE, and the only one that knows metres.

It stays out of the library's known traps: control only while a motion is held, asynchronous moves only, never its
`reconnect` (a new object instead), never `play`, no call to a controller whose port does not answer.
"""

import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread

import numpy as np
from rtde_control import RTDEControlInterface
from rtde_receive import RTDEReceiveInterface
from scipy.spatial.transform import Rotation

from robot.arm import ArmState, LinearMove
from robot.arm_claim import ArmClaim
from robot.dashboard import DashboardLink
from robot.errors import ArmClaimedError, ArmUnreachableError, ControllerRefusedError, RobotError
from robot.feedback_probe import feedback_flows
from robot.frames import Array, Transform
from robot.library_waits import Waits
from robot.rtde_frames import RTDE_PORT
from robot.safety import PROGRAM_RUNNING_BIT, SafetyWords, classify

_PROBE_S = 0.3
_RUNTIME_STOPPED = (0, 1)  # stopping, stopped; a paused program could be resumed and counts as running
_TORN_READS = 3
_CLOSING_S = 2.0
# The library's destructor sleeps half a second in which no other thread runs and no stop could be sent: closed
# interfaces are kept until the process ends (docs/decisions/0011).
_CLOSED: list[RTDEControlInterface] = []


class UR5:
    """The `Arm` of a controller at an IPv4 address."""

    def __init__(self, address: str) -> None:
        self._address = address
        self._dashboard = DashboardLink(address)
        self._claim = ArmClaim(address)
        self._receive: RTDEReceiveInterface | None = None
        self._control: RTDEControlInterface | None = None
        self._ending: Thread | None = None
        self._closing: Thread | None = None
        self._closed_by_s = 0.0
        self._waits = Waits()
        self._read_time_s = -1.0

    def connect(self) -> bool:
        """Claim the arm (H19), open dashboard and feedback; whatever an earlier owner left running is stopped first."""
        if not self._may_have_it() or not self._dashboard.send_stop() or not feedback_flows(self._address):
            return False
        self._drop_receive()
        try:
            receive = RTDEReceiveInterface(self._address)
        except RuntimeError:
            return False
        self._receive = receive if receive.isConnected() else None
        return self._receive is not None

    def read(self) -> ArmState | None:
        """Newest reading not read before, or None."""
        receive = self._receive
        if receive is None or not receive.isConnected():
            return None
        time_s = receive.getTimestamp()
        if time_s == self._read_time_s:
            return None
        for _ in range(_TORN_READS):
            state = _state(receive, time_s)
            after_s = receive.getTimestamp()
            if after_s == time_s:
                break
            time_s = after_s  # a packet arrived between the getters: read again, so that all is of one packet
        self._read_time_s = time_s
        return state

    def take_control(self, watchdog_hz: float) -> None:
        """Upload the control script and arm the controller's watchdog (H17).

        Raises
        ------
        ArmUnreachableError
            If the controller does not answer.
        ControllerRefusedError
            If the script does not run or the watchdog is not armed.
        """
        if not self._answers():
            raise ArmUnreachableError(f"the controller at {self._address} does not answer")
        self._await_closing()
        self._waits.close()
        with _refused("its control"):
            with self._waits.noted():
                self._control = RTDEControlInterface(self._address)
            armed = self._control.isProgramRunning() and self._control.setWatchdog(watchdog_hz)
        if not armed:
            raise ControllerRefusedError("the control script does not run")

    def flange_from_tcp(self) -> Transform:
        """Active TCP of the controller, (4, 4) mm."""
        with _refused("the question for its TCP"):
            return _transform_in_mm(self._owned().getTCPOffset())

    def move_linear(self, move: LinearMove) -> None:
        """Start a linear motion and return while it runs; ControllerRefusedError if the controller would not."""
        pose = _pose_in_metres(move.base_from_goal)
        speed_m_s, acceleration_m_s2 = _metres_from_mm(np.array([move.speed_mm_s, move.acceleration_mm_s2]))
        with _refused("the motion"):
            taken = self._owned().moveL(pose, float(speed_m_s), float(acceleration_m_s2), True)
        if not taken:
            raise ControllerRefusedError("the controller did not take the motion")

    def feed_watchdog(self) -> None:
        """Send one packet; without them the controller stops by itself."""
        with _refused("a sign of life"):
            self._owned().kickWatchdog()

    def send_stop(self) -> bool:
        """Stop whatever program runs, by the dashboard: one write, from any thread."""
        return self._dashboard.send_stop()

    def stop_script(self) -> None:
        """End the control script over its own connection, in the background; harmless without control.

        The library may wait for ever for a controller whose answers have frozen; the dashboard's stop does not.
        """
        if self._control is not None and self._ending is None:
            self._ending = Thread(target=self._control.stopScript, name="ending", daemon=True)
            self._ending.start()

    def give_up_control(self) -> None:
        """Stop the control script and close its connection, in the background; harmless without control."""
        self.stop_script()
        if self._control is not None and self._ending is not None:
            self._closing = Thread(target=_close, args=(self._control, self._ending), name="closing", daemon=True)
            self._closing.start()
            self._closed_by_s = time.monotonic() + _CLOSING_S
            _CLOSED.append(self._control)
        self._control = self._ending = None

    def release_pendant(self) -> None:
        """Give up control and leave the dashboard; only the feedback is read on."""
        self.give_up_control()
        self._dashboard.close()

    def is_severed(self) -> bool:
        """Whether a connection broke while in control: the library connects again by itself, and uploads its script.

        It asks nobody, and only the end of the process ends it.
        """
        if self._control is None or self._receive is None:
            return False
        return not (self._control.isConnected() and self._receive.isConnected())

    def is_stuck(self) -> bool:
        """Whether the connection of an earlier motion does not close: only the end of the process closes it then."""
        return self._closing is not None and self._closing.is_alive() and time.monotonic() > self._closed_by_s

    def close(self) -> None:
        """Stop, and leave; the library's own connections end with the process."""
        self.send_stop()
        self._dashboard.close()
        self._claim.give_up()

    def _owned(self) -> RTDEControlInterface:
        if self._control is None:
            raise ControllerRefusedError("no control script runs")
        return self._control

    def _await_closing(self) -> None:
        """A second control connection would find the first one's registers in use."""
        if self._closing is not None:
            self._closing.join(_CLOSING_S)
            if self._closing.is_alive():
                raise ControllerRefusedError("the control connection of the last motion does not close")

    def _may_have_it(self) -> bool:
        """Whether the arm is ours; one that does not say whose it is is stopped all the same."""
        try:
            self._claim.take()
        except ArmClaimedError:
            return False
        except RobotError:
            self._dashboard.send_stop()
            return False
        return True

    def _answers(self) -> bool:
        """Whether the RTDE port takes connections: the library's constructors hang on one that does not."""
        try:
            socket.create_connection((self._address, RTDE_PORT), _PROBE_S).close()
        except OSError:
            return False
        return True

    def _drop_receive(self) -> None:
        receive, self._receive = self._receive, None
        if receive is not None:
            receive.disconnect()


@contextmanager
def _refused(what: str) -> Iterator[None]:
    """What the library raises, such as for a broken connection, as the protocol of an arm has it."""
    try:
        yield
    except (RuntimeError, ValueError) as error:
        raise ControllerRefusedError(f"the controller did not take {what}: {error}") from error


def _close(control: RTDEControlInterface, ending: Thread) -> None:
    ending.join()
    control.disconnect()


def _state(receive: RTDEReceiveInterface, time_s: float) -> ArmState:
    words = SafetyWords(receive.getSafetyStatusBits(), receive.getRobotStatus(), receive.getRobotMode())
    tcp_speed = receive.getActualTCPSpeed()
    runtime_state = receive.getRuntimeState()
    return ArmState(
        controller_time_s=time_s,
        received_at_s=time.monotonic(),
        joints_rad=np.array(receive.getActualQ()),
        joint_speeds_rad_s=np.array(receive.getActualQd()),
        base_from_tcp=_transform_in_mm(receive.getActualTCPPose()),
        tcp_speed_mm_s=float(np.linalg.norm(_mm_from_metres(tcp_speed[:3]))),
        tcp_turn_speed_rad_s=float(np.linalg.norm(tcp_speed[3:])),
        tcp_force_n=np.array(receive.getActualTCPForce()[:3]),
        payload_kg=receive.getPayload(),
        payload_centre_mm=_mm_from_metres(receive.getPayloadCog()),
        safety_bits=words.safety_bits,
        robot_status_bits=words.robot_status_bits,
        robot_mode=words.robot_mode,
        runtime_state=runtime_state,
        program_running=bool(words.robot_status_bits >> PROGRAM_RUNNING_BIT & 1)
        or runtime_state not in _RUNTIME_STOPPED,
        safety=classify(words),
    )


def _transform_in_mm(pose: list[float]) -> Transform:
    """4x4 in mm from the controller's pose (metres, rotation vector in rad)."""
    transform = np.eye(4)
    transform[:3, :3] = Rotation.from_rotvec(pose[3:6]).as_matrix()
    transform[:3, 3] = _mm_from_metres(pose[:3])
    return transform


def _pose_in_metres(transform: Transform) -> list[float]:
    """The controller's pose (metres, rotation vector in rad) from a 4x4 in mm."""
    turn = Rotation.from_matrix(transform[:3, :3]).as_rotvec()
    return [*_metres_from_mm(transform[:3, 3]).tolist(), *turn.tolist()]


def _mm_from_metres(lengths: list[float]) -> Array:
    return np.asarray(lengths, dtype=np.float64) * 1000.0


def _metres_from_mm(lengths: Array) -> Array:
    return lengths / 1000.0
