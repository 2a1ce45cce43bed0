"""One motion from its permit to its end: control taken, put on the wire, judged, stopped, at rest."""

from collections.abc import Callable

import numpy as np

from robot.arm import Arm, ArmState, LinearMove
from robot.errors import RobotError
from robot.frames import Array, Transform, distance_between
from robot.guard.deviation import has_kept_tcp
from robot.guard.journal import Journal, trajectory_file
from robot.guard.messages import BeginMove, EndCause, MotionEnded, MotionStarted, Phase
from robot.guard.motion import MotionJudge
from robot.guard.preflight import refuse_late, refuse_tcp
from robot.refusal import Refusal, RefusalCode

# Round trip of one question: two cycles of a controller and the way there and back, 10 to 25 ms at 125 Hz.
_ANSWER_S = 0.2
WATCHDOG_HZ = 2.5  # of the controller: 0.4 s without a packet and it stops by itself (H17, H20)
_STOP_AGAIN_S = 0.2  # a stop that shows no effect is sent again
_GIVE_UP_S = 3.0  # a UR5 needs up to 0.5 s to stop
_REST_S = 0.15  # at rest for so long after a stop, and the motion is over
_BLIND_S = 0.5  # without feedback nothing is gained by waiting longer


class Course:
    """A motion under way; `phase` is starting, moving or stopping.

    Parameters
    ----------
    asked : ArmState or None
        The reading with which it was asked for, from before the controller tells its TCP.
    """

    def __init__(
        self, move: BeginMove, asked: ArmState | None, arm: Arm, journal: Journal, clock: Callable[[], float]
    ) -> None:
        self.move = move
        self._asked = asked
        self.phase = Phase.STARTING
        self.controlled_at_s = clock()
        self._arm = arm
        self._journal = journal
        self._clock = clock
        self._flange_from_tcp: Transform = np.eye(4)
        self._judge: MotionJudge | None = None
        self._cause = EndCause.STOPPED
        self._stopping_since_s = 0.0
        self._stop_sent_at_s: float | None = None
        self._last_stop_s = 0.0
        self._samples = 0

    def take_control(self) -> Refusal | None:
        """Upload the control script and compare the active TCP (H10), which is to be told in time (H21)."""
        try:
            self._arm.take_control(WATCHDOG_HZ)
        except RobotError as error:
            return Refusal(RefusalCode.CONTROLLER_REFUSED, str(error), None, None)
        asked_s = self._clock()
        refusal = self._ask_for_tcp()
        self.controlled_at_s = self._clock()
        answered_s = self.controlled_at_s - asked_s
        if answered_s > _ANSWER_S:  # whether it answered in the end or not
            return refuse_late("the controller took this long to answer (s)", answered_s, _ANSWER_S)
        return refusal or refuse_tcp(self.move, self._flange_from_tcp)

    def _ask_for_tcp(self) -> Refusal | None:
        try:
            self._flange_from_tcp = self._arm.flange_from_tcp()
        except RobotError as error:
            return Refusal(RefusalCode.CONTROLLER_REFUSED, str(error), None, None)
        return None

    def launch(self, start: ArmState, resting_force_n: Array) -> MotionStarted | Refusal:
        """Put the motion on the wire; what is felt above the resting force (3,), base axes, will end it."""
        move = self.move
        if self._asked is None or not has_kept_tcp(move, self._asked, start):  # H10: it was told, and changed since
            return Refusal(RefusalCode.TCP_MISMATCH, "the TCP changed while control was taken", None, None)
        self._judge = MotionJudge(move, start, resting_force_n, self._clock())
        try:
            self._arm.move_linear(LinearMove(move.base_from_goal, move.speed_mm_s, move.acceleration_mm_s2))
        except RobotError as error:
            return Refusal(RefusalCode.CONTROLLER_REFUSED, str(error), None, None)
        self.phase = Phase.MOVING
        return MotionStarted(
            permit_id=move.permit_id,
            at_s=self._clock(),
            base_from_start=start.base_from_tcp,
            joints_rad=start.joints_rad,
            flange_from_tcp=self._flange_from_tcp,
            payload_kg=start.payload_kg,
            payload_centre_mm=start.payload_centre_mm,
        )

    def observe(self, reading: ArmState) -> EndCause | None:
        """Record a reading; the cause to end the motion, if there is one."""
        self._journal.sample(self.move.permit_id, reading)
        self._samples += 1
        return self._judge.judge(reading) if self._judge is not None and self.phase is Phase.MOVING else None

    def feed_watchdog(self) -> EndCause | None:
        """Pass a sign of life of the surgeon on; control lost if the controller does not take it."""
        try:
            self._arm.feed_watchdog()
        except RobotError:
            return EndCause.CONTROL_LOST
        return None

    def stop(self, cause: EndCause, sent_at_s: float | None = None) -> None:
        """End the motion; the first cause counts."""
        if self.phase is Phase.STOPPING:
            return
        self.phase = Phase.STOPPING
        self._cause = cause
        self._stopping_since_s = self._clock()
        self._stop_sent_at_s = sent_at_s
        self._send_stop()

    def settle(self, newest: ArmState | None, sound: bool, rest_s: float) -> MotionEnded | None:
        """The end of the motion once the arm is seen at rest without a program, or after the time that may take."""
        now_s = self._clock()
        waited_s = now_s - self._stopping_since_s
        at_rest = sound and min(rest_s, waited_s) >= _REST_S  # a rest from before the stop may be one before the motion
        over = at_rest and newest is not None and not newest.program_running
        if over or waited_s > (_GIVE_UP_S if sound else _BLIND_S):
            return self._ended(newest, at_rest, over)
        if now_s - self._last_stop_s > _STOP_AGAIN_S:
            self._send_stop()
        return None

    def abandon(self, newest: ArmState | None) -> MotionEnded:
        """The end as far as it was seen."""
        return self._ended(newest, at_rest=False, program_stopped=False)

    def _send_stop(self) -> None:
        self._last_stop_s = self._clock()
        self._arm.stop_script()  # first, since it does not wait; a dashboard that has to be found again may
        if self._arm.send_stop() and self._stop_sent_at_s is None:
            self._stop_sent_at_s = self._last_stop_s

    def _ended(self, newest: ArmState | None, at_rest: bool, program_stopped: bool) -> MotionEnded:
        off = None if newest is None else distance_between(newest.base_from_tcp, self.move.base_from_goal)
        return MotionEnded(
            permit_id=self.move.permit_id,
            cause=self._cause,
            at_s=self._clock(),
            at_rest=at_rest,
            program_stopped=program_stopped,
            distance_mm=None if off is None else off[0],
            angle_rad=None if off is None else off[1],
            arm=newest,
            stop_sent_at_s=self._stop_sent_at_s,
            trajectory_file=trajectory_file(self.move.permit_id),
            trajectory_samples=self._samples,
        )
