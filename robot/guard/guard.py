"""The guard itself: takes commands, watches the arm, starts motions and ends them.

One thread owns it and calls `handle` and `tick`; `stop_now` alone may be called from any.
"""

import time
from collections.abc import Callable
from itertools import count
from typing import TypeAlias, assert_never

from robot.arm import Arm, ArmState
from robot.guard.admission import Admission
from robot.guard.course import Course
from robot.guard.heartbeat import HeartbeatMonitor
from robot.guard.journal import FLUSH_S, Journal
from robot.guard.messages import (
    Acknowledge,
    BeginMove,
    EndCause,
    Event,
    Fault,
    FaultKind,
    Heartbeat,
    MotionStarted,
    MoveRefused,
    PendantReleased,
    Phase,
    ReleasePendant,
    Status,
    StopSent,
)
from robot.guard.observer import Observer
from robot.guard.rest import DisplacementWatch
from robot.refusal import Refusal, RefusalCode

STATUS_S = 0.025  # 40 a second: a challenge is at most so old when the tablet gets it
_CALM = (EndCause.ARRIVED, EndCause.MISSED, EndCause.RELEASED)

Taken: TypeAlias = BeginMove | Heartbeat | ReleasePendant | Acknowledge | StopSent


class Guard:
    """Alone may move the arm.

    Parameters
    ----------
    arm : Arm
    journal : Journal
    emit : callable
        Takes every event; must not block.
    """

    def __init__(
        self, arm: Arm, journal: Journal, emit: Callable[[Event], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._arm = arm
        self._journal = journal
        self._emit = emit
        self._clock = clock
        self._observer = Observer(arm)
        self._heartbeats = HeartbeatMonitor()
        self._admission = Admission(self._observer, self._heartbeats, journal)
        self._displacement = DisplacementWatch()
        self._idle_phase = Phase.HELD
        self._course: Course | None = None
        self._fault: FaultKind | None = FaultKind.FEEDBACK_LOST
        self._stops = 0
        self._stops_seen = 0
        self._sequence = count()
        self._next_status_s = 0.0
        self._releasing = False
        self.severed = False  # the arm's library is not to be trusted any more: the process has to end

    @property
    def phase(self) -> Phase:
        """Where the guard is."""
        return self._idle_phase if self._course is None else self._course.phase

    def stop_now(self, reason: str) -> StopSent:
        """Put a stop on the wire before anything else is done about it; hand what it returns to `handle`."""
        self._stops += 1
        at_s = self._clock()
        return StopSent(reason, at_s, self._arm.send_stop())

    def handle(self, taken: Taken) -> None:
        """Act on a command, or on a stop that was sent."""
        match taken:
            case Heartbeat():
                self._hear(taken)
            case StopSent():
                self._stopped(taken, EndCause.STOPPED)
            case BeginMove():
                self._begin(taken)
            case ReleasePendant():
                self._releasing = True
            case Acknowledge():
                self._heartbeats.retire()  # an order on its way since before has a hand on it, and no consent
                self._idle_phase = Phase.IDLE
                self._journal.record(taken)
            case _:
                assert_never(taken)

    def lose_parent(self) -> None:
        """The service is gone: stop, and never start again."""
        self._stopped(self.stop_now("parent lost"), EndCause.PARENT_LOST)

    def tick(self) -> None:
        """One turn: read, judge, act, report."""
        now_s = self._clock()
        reading = self._observer.read()
        if self._course is None:
            self._watch(reading, now_s)
        else:
            self._drive(self._course, reading, now_s)
        if now_s >= self._next_status_s:
            self._report(now_s)

    def _hear(self, heartbeat: Heartbeat) -> None:
        fresh = self._heartbeats.receive(heartbeat)
        course = self._course
        if course is None or not fresh or course.phase is Phase.STOPPING:
            return
        if self._heartbeats.is_live(course.move.permit_id, self._clock()):  # H20: nothing else feeds it
            cause = course.feed_watchdog()
            if cause is not None:
                course.stop(cause)

    def _stopped(self, sent: StopSent, cause: EndCause) -> None:
        self._stops_seen += 1
        self._tell(sent)
        self._idle_phase = Phase.HELD
        if self._course is None:
            return
        if self._course.phase is Phase.STARTING:
            self._refuse(self._course, Refusal(RefusalCode.STOPPED, "a stop came before the motion", None, None))
        else:
            self._course.stop(cause, sent.at_s)

    def _begin(self, move: BeginMove) -> None:
        now_s = self._clock()
        refusal = self._admission.refuse_begin(move, self.phase, now_s)
        if refusal is not None:
            self._tell(MoveRefused(move.permit_id, now_s, refusal))
            return
        self._course = Course(move, self._observer.newest, self._arm, self._journal, self._clock)
        self._report(now_s)  # taking control blocks: the parent learns beforehand why it hears nothing
        answer = self._course.take_control()
        if answer is not None:
            self._refuse(self._course, answer)

    def _drive(self, course: Course, reading: ArmState | None, now_s: float) -> None:
        if self._arm.is_severed():
            self._sever(course)
            return
        match course.phase:
            case Phase.STARTING:
                self._launch(course, now_s)
            case Phase.MOVING:
                cause = self._cause_to_end(course, reading, now_s)
                if cause is not None:
                    course.stop(cause)
            case _:
                self._settle(course, reading, now_s)

    def _launch(self, course: Course, now_s: float) -> None:
        if self._stops != self._stops_seen:
            return  # a stop was sent and is on its way to `handle`
        if self._admission.awaits_script(course, now_s):
            return
        refusal = self._admission.refuse_launch(course, now_s)
        silent = refusal is None or refusal.code is RefusalCode.NO_LIVE_HEARTBEAT
        if silent and self._admission.may_wait(course, now_s):
            return
        start, resting_n = self._observer.newest, self._observer.resting_force_n
        if refusal is None and start is not None and resting_n is not None:
            answer: MotionStarted | Refusal | None = course.launch(start, resting_n)
        else:
            answer = refusal
        if isinstance(answer, Refusal):
            self._refuse(course, answer)
        elif answer is not None:
            self._tell(answer)

    def _refuse(self, course: Course, refusal: Refusal) -> None:
        """End a motion that never started: its script is stopped, nothing was moved."""
        self._course = None
        self._arm.send_stop()
        self._tell(MoveRefused(course.move.permit_id, self._clock(), refusal))
        self._arm.give_up_control()

    def _cause_to_end(self, course: Course, reading: ArmState | None, now_s: float) -> EndCause | None:
        """The arm's own reason first: it explains the others."""
        cause = None if reading is None else course.observe(reading)
        if cause is not None:
            return cause
        if not self._observer.is_sound(now_s):
            return EndCause.FEEDBACK_LOST
        if self._heartbeats.is_live(course.move.permit_id, now_s):
            return None
        return EndCause.RELEASED if self._heartbeats.is_let_go(course.move.permit_id) else EndCause.HEARTBEAT_LOST

    def _sever(self, course: Course) -> None:
        """Stop by the dashboard, and leave the rest to the next guard."""
        self.severed = True
        self._idle_phase = Phase.HELD
        if course.phase is Phase.STARTING:
            message = "the connection to the controller broke"
            self._refuse(course, Refusal(RefusalCode.ARM_UNREACHABLE, message, None, None))
            return
        course.stop(EndCause.FEEDBACK_LOST)
        self._course = None
        self._tell(course.abandon(self._observer.newest))

    def _settle(self, course: Course, reading: ArmState | None, now_s: float) -> None:
        if reading is not None:
            course.observe(reading)
        ended = course.settle(self._observer.newest, self._observer.is_sound(now_s), self._observer.rest_s)
        if ended is None:
            return
        self._course = None
        if ended.cause not in _CALM:  # after a calm end a fault is news, after the others it was the reason
            self._fault = self._observer.fault(now_s)
        if ended.cause not in _CALM or not (ended.at_rest and ended.program_stopped):
            self._idle_phase = Phase.HELD
        self._displacement.account(self._observer.newest)
        self._journal.flush(FLUSH_S)
        self._tell(ended)
        self._arm.give_up_control()

    def _watch(self, reading: ArmState | None, now_s: float) -> None:
        """Without a motion: keep the link, latch faults, notice a displaced arm."""
        if self._releasing:
            self._release_pendant(now_s)
        fault = self._observer.fault(now_s)
        if fault is not None and fault is not self._fault:
            self._idle_phase = Phase.HELD
            late = f", the newest {self._observer.late_s:.3f} s late" if fault is FaultKind.FEEDBACK_LOST else ""
            self._tell(Fault(fault, now_s, f"the arm reports {fault}{late}"))
        self._fault = fault
        disturbed = None if reading is None else self._displacement.observe(reading)
        if disturbed is not None:
            self._tell(disturbed)
        self._observer.keep_connected(now_s)  # last, since it blocks: the parent learns beforehand why it hears nothing

    def _release_pendant(self, now_s: float) -> None:
        self._releasing = False
        self._arm.release_pendant()
        newest = self._observer.newest if self._observer.is_sound(now_s) else None
        self._tell(PendantReleased(now_s, None if newest is None else newest.program_running))

    def _report(self, now_s: float) -> None:
        self._next_status_s = now_s + STATUS_S
        course = self._course
        self._emit(
            Status(
                sequence=next(self._sequence),
                sent_at_s=now_s,
                phase=self.phase,
                challenge=self._heartbeats.issue(now_s),
                connected=self._observer.is_sound(now_s),
                arm=self._observer.newest,
                permit_id=self._heartbeats.permit_id if course is None else course.move.permit_id,
                held=self._heartbeats.held,
                heartbeat_age_s=self._heartbeats.age_s(now_s),
            )
        )

    def _tell(self, event: Event) -> None:
        """Emit an event, after the status that belongs to it, and put it into the journal."""
        self._report(self._clock())
        self._emit(event)
        self._journal.record(event)
