"""Whether a motion may begin: asked with the command, and again once control is taken."""

from robot.guard.course import Course
from robot.guard.feedback import STALE_S
from robot.guard.force import refuse_force
from robot.guard.heartbeat import SILENCE_S, HeartbeatMonitor
from robot.guard.journal import FLUSH_S, Journal
from robot.guard.messages import BeginMove, Phase
from robot.guard.observer import Observer
from robot.guard.preflight import refuse_arm, refuse_late
from robot.refusal import Refusal, RefusalCode

_HEARD_WITHIN_S = 0.4  # taking control blocks, and heartbeats with it; a hold that is there shows within this after
_YOUNG_S = 0.1  # a motion that starts on an older echo would end at the next hiccup


class Admission:
    """Permits are spent here, whether their motion starts or not."""

    def __init__(self, observer: Observer, heartbeats: HeartbeatMonitor, journal: Journal) -> None:
        self._observer = observer
        self._heartbeats = heartbeats
        self._journal = journal
        self._spent: set[str] = set()

    def refuse_begin(self, move: BeginMove, phase: Phase, now_s: float) -> Refusal | None:
        """Refusal of a motion as it is asked for; the permit is spent either way."""
        spent = move.permit_id in self._spent
        self._spent.add(move.permit_id)
        if phase not in (Phase.IDLE, Phase.HELD):
            return Refusal(RefusalCode.MOTION_RUNNING, "a motion is running", None, None)
        if spent:
            return Refusal(RefusalCode.PERMIT_REUSED, "a permit starts one motion", None, None)
        if phase is Phase.HELD:
            return Refusal(RefusalCode.GUARD_HELD, "a stop or fault is not acknowledged", None, None)
        return self._refuse_program() or self._refuse_now(move, now_s) or self._refuse_unwritten(move)

    def refuse_launch(self, course: Course, now_s: float) -> Refusal | None:
        """Refusal of a motion once control is taken, which took its time (H04, H16, H18)."""
        return self._refuse_now(course.move, now_s) or self._refuse_unseen(course, now_s)

    def awaits_script(self, course: Course, now_s: float) -> bool:
        """Whether sound feedback does not show yet that the control script runs, and may do so in time (H21)."""
        newest = self._observer.newest
        if newest is None or newest.program_running or not self._observer.is_sound(now_s):
            return False
        return now_s - course.controlled_at_s <= STALE_S

    def may_wait(self, course: Course, now_s: float) -> bool:
        """Whether the hold goes on but was not heard while control was being taken, and may yet be heard in time."""
        same = self._heartbeats.permit_id == course.move.permit_id and self._heartbeats.held
        age_s = self._heartbeats.age_s(now_s)
        old = age_s is None or age_s > _YOUNG_S
        return same and old and now_s - course.controlled_at_s < _HEARD_WITHIN_S

    def _refuse_now(self, move: BeginMove, now_s: float) -> Refusal | None:
        newest = self._observer.newest
        if self._observer.late_s > STALE_S:
            return refuse_late("the controller's feedback comes late (s)", self._observer.late_s, STALE_S)
        if newest is None or not self._observer.is_sound(now_s):
            return Refusal(RefusalCode.ARM_UNREACHABLE, "no sound feedback from the controller", None, None)
        return (
            refuse_arm(move, newest)
            or refuse_force(self._observer.resting_force_n)
            or self._refuse_silence(move, now_s)
        )

    def _refuse_silence(self, move: BeginMove, now_s: float) -> Refusal | None:
        if self._heartbeats.is_live(move.permit_id, now_s):
            return None
        age_s = self._heartbeats.age_s(now_s)
        return Refusal(RefusalCode.NO_LIVE_HEARTBEAT, "no live hold under this permit (s)", age_s, SILENCE_S)

    def _refuse_program(self) -> Refusal | None:
        newest = self._observer.newest
        if newest is None or not newest.program_running:
            return None
        return Refusal(RefusalCode.ARM_NOT_READY, "another program runs on the controller", None, None)

    def _refuse_unseen(self, course: Course, now_s: float) -> Refusal | None:
        """Feedback that is as late as on its first packet, which no comparison with the promptest one shows (H21)."""
        newest = self._observer.newest
        if newest is None or newest.program_running:
            return None
        return refuse_late("the feedback does not show the control script (s)", now_s - course.controlled_at_s, STALE_S)

    def _refuse_unwritten(self, move: BeginMove) -> Refusal | None:
        """The intent is on the disk before the motion is on the wire (H24)."""
        self._journal.record(move)
        if self._journal.flush(FLUSH_S):
            return None
        return Refusal(RefusalCode.JOURNAL_UNWRITABLE, "the guard's journal cannot be written", None, None)
