"""The transition table: 44 numbered rows as data, and every cell that no row lists."""

from collections.abc import Iterable

from workflow import changes as do
from workflow.branches import branches_of
from workflow.changes import Change
from workflow.decisions import Effect
from workflow.links import Link
from workflow.rows import Branch, Goto, Row, Unlisted
from workflow.states import IDLE, INSERTION, LIVE, OVER, State
from workflow.triggers import Trigger

Entries = tuple[Row | Unlisted, ...]
S, T, B = State, Trigger, Branch
ALL = LIVE | OVER
_STOP = (Effect.STOP_SENT,)
_ADRIFT_VOIDS = (do.void_from(Link.IMAGE), do.forget_images)


def _row(
    number: int,
    trigger: Trigger,
    sources: Iterable[State],
    to: State | Goto,
    *changes: Change,
    on: Iterable[Branch] = (),
    effects: tuple[Effect, ...] = (),
    settles_to: Iterable[State] = (),
    taken_as: Trigger | None = None,
) -> Row:
    branches = frozenset(on) or branches_of(trigger)
    return Row(number, trigger, frozenset(sources), branches, to, changes, effects, frozenset(settles_to), taken_as)


def _unlisted(trigger: Trigger, states: Iterable[State], on: Iterable[Branch] = ()) -> Unlisted:
    return Unlisted(trigger, frozenset(states), frozenset(on) or branches_of(trigger))


_POSITIONED = (S.CASE_OPEN, S.CARM_POSITIONED)
_EXPOSING = (S.CARM_POSITIONED, S.MOVED)
_RETAKEN = (S.IMAGE_ACQUIRED, S.REGISTERED, S.TARGET_CHOSEN)
_AIMED_AT = (S.TARGET_CHOSEN, S.MOVED, S.VERIFIED, S.OFF_TARGET)
_JUDGED = (S.VERIFIED, S.OFF_TARGET)
_SLEEVE = (S.INSERTING, S.SLEEVE_INSERTED)
_BEFORE_THE_MOTION = (S.CASE_OPEN, S.CARM_POSITIONED, S.IMAGE_ACQUIRED, S.REGISTERED, S.TARGET_CHOSEN)

IMAGE_ROWS: Entries = (
    _row(1, T.CARM_POSITION_CONFIRMED, _POSITIONED, S.CARM_POSITIONED, do.new_view),
    _row(2, T.EXPOSURE_REQUESTED, _EXPOSING, Goto.SAME, do.open_window),
    _row(
        3,
        T.IMAGE_ARRIVED,
        [S.CARM_POSITIONED],
        S.IMAGE_ACQUIRED,
        do.count_image,
        do.remember_image,
        do.new_image,
        on=[B.ACCEPTED],
        effects=(Effect.REGISTRATION_STARTS,),
    ),
    _row(
        4,
        T.IMAGE_ARRIVED,
        [S.MOVED],
        Goto.SAME,
        do.count_image,
        do.remember_image,
        do.evaluate_image,
        on=[B.ACCEPTED],
        effects=(Effect.EVALUATION_STARTS,),
    ),
    _row(5, T.IMAGE_ARRIVED, ALL, Goto.SAME, do.count_image, do.remember_clean_image, on=[B.OTHERWISE]),
    _row(
        5,
        T.IMAGE_ARRIVED,
        ALL - set(_EXPOSING),
        Goto.SAME,
        do.count_image,
        do.remember_clean_image,
        on=[B.ACCEPTED],
    ),
    _row(
        6,
        T.NEWEST_IMAGE_REUSED,
        [S.CARM_POSITIONED],
        S.IMAGE_ACQUIRED,
        do.reuse_image,
        effects=(Effect.REGISTRATION_STARTS,),
    ),
    _row(7, T.REGISTRATION_COMPLETED, [S.IMAGE_ACQUIRED], S.REGISTERED, do.new_registration, on=[B.SOUND]),
    _row(7, T.REGISTRATION_COMPLETED, [S.SAFE_HOLD], Goto.SAME, do.new_registration, on=[B.SOUND]),
    _row(
        8,
        T.REGISTRATION_COMPLETED,
        [S.IMAGE_ACQUIRED],
        S.CARM_POSITIONED,
        do.void_from(Link.IMAGE),
        on=[B.UNSOUND],
        taken_as=T.REGISTRATION_REFUSED,
    ),
    _row(
        8,
        T.REGISTRATION_COMPLETED,
        [S.SAFE_HOLD],
        Goto.SAME,
        do.void_from(Link.IMAGE),
        on=[B.UNSOUND],
        taken_as=T.REGISTRATION_REFUSED,
    ),
    _row(8, T.REGISTRATION_REFUSED, [S.IMAGE_ACQUIRED], S.CARM_POSITIONED, do.void_from(Link.IMAGE), on=[B.CURRENT]),
    _row(8, T.REGISTRATION_REFUSED, [S.SAFE_HOLD], Goto.SAME, do.void_from(Link.IMAGE), on=[B.CURRENT]),
    _row(9, T.RETAKE, _RETAKEN, S.CARM_POSITIONED, do.void_from(Link.IMAGE)),
    _unlisted(T.CARM_POSITION_CONFIRMED, ALL - set(_POSITIONED)),
    _unlisted(T.EXPOSURE_REQUESTED, ALL - set(_EXPOSING)),
    _unlisted(T.NEWEST_IMAGE_REUSED, ALL - {S.CARM_POSITIONED}),
    _unlisted(T.REGISTRATION_COMPLETED, ALL - {S.IMAGE_ACQUIRED, S.SAFE_HOLD}),
    _unlisted(T.REGISTRATION_COMPLETED, [S.IMAGE_ACQUIRED, S.SAFE_HOLD], on=[B.LATE]),
    _unlisted(T.REGISTRATION_REFUSED, ALL - {S.IMAGE_ACQUIRED, S.SAFE_HOLD}),
    _unlisted(T.REGISTRATION_REFUSED, [S.IMAGE_ACQUIRED, S.SAFE_HOLD], on=[B.LATE]),
    _unlisted(T.RETAKE, ALL - set(_RETAKEN)),
)

MOTION_ROWS: Entries = (
    _row(10, T.TARGET_CONFIRMED, [S.REGISTERED, *_AIMED_AT], S.TARGET_CHOSEN, do.new_target),
    _row(11, T.TARGET_WITHDRAWN, _AIMED_AT, Goto.SETTLE, do.withdraw_target, settles_to=[S.REGISTERED, S.CASE_OPEN]),
    _row(12, T.PLAN_REQUESTED, IDLE, Goto.SAME, do.new_plan),
    _row(13, T.MOVE_APPROVED, IDLE, Goto.SAME, do.new_permit),
    _row(14, T.MOVE_STARTED, IDLE, S.MOVING, do.start_motion, do.forget_images),
    _row(15, T.ARRIVED, [S.MOVING], S.MOVED, do.complete_motion, on=[B.AT_GOAL]),
    _row(16, T.ARRIVED, [S.MOVING], Goto.SETTLE, do.close_motion, on=[B.ELSEWHERE], settles_to=_BEFORE_THE_MOTION),
    _row(16, T.MISSED, [S.MOVING], Goto.SETTLE, do.close_motion, on=[B.AT_REST], settles_to=_BEFORE_THE_MOTION),
    _row(17, T.RELEASED, [S.MOVING], Goto.SETTLE, do.close_motion, on=[B.AT_REST], settles_to=_BEFORE_THE_MOTION),
    # A motion that is reported to be over while the arm still moves: the arm moves without an M.
    *(
        _row(
            35,
            ended,
            [S.MOVING],
            S.SAFE_HOLD,
            do.close_motion,
            *_ADRIFT_VOIDS,
            on=[B.ADRIFT],
            effects=_STOP,
            taken_as=T.ARM_DISTURBED,
        )
        for ended in (T.ARRIVED, T.MISSED, T.RELEASED)
    ),
    _unlisted(T.TARGET_CONFIRMED, ALL - {S.REGISTERED, *_AIMED_AT}),
    _unlisted(T.TARGET_WITHDRAWN, ALL - set(_AIMED_AT)),
    *(_unlisted(request, ALL - IDLE) for request in (T.PLAN_REQUESTED, T.MOVE_APPROVED, T.MOVE_STARTED)),
    *(_unlisted(ended, ALL - {S.MOVING}) for ended in (T.ARRIVED, T.MISSED, T.RELEASED)),
    *(_unlisted(ended, [S.MOVING], on=[B.LATE]) for ended in (T.ARRIVED, T.MISSED, T.RELEASED)),
)

_EVALUATED_IN = (S.MOVED, S.SAFE_HOLD)


def _seen_to_move(judged: Trigger) -> Entries:
    """Rows of a verification image in which the C-arm, the base or the patient is seen to have moved."""
    view = (do.void_view_keeping_passed, do.forget_images)
    patient = (do.void_from(Link.IMAGE), do.forget_images)
    entries: list[Row | Unlisted] = []
    for number, branch, changes, settled, moved in (
        (30, B.VIEW_MOVED, view, S.CASE_OPEN, T.CARM_MOVED),
        (31, B.PATIENT_SHIFTED, patient, S.CARM_POSITIONED, T.PATIENT_MOVED),
    ):
        on, held = [branch], (*changes, do.flag_insertion)
        entries += (
            _row(number, judged, [S.MOVED], Goto.SETTLE, *changes, on=on, settles_to=[settled], taken_as=moved),
            _row(34, judged, [S.SAFE_HOLD], Goto.SAME, *held, on=on, effects=(Effect.ALARM,), taken_as=moved),
        )
    return tuple(entries)


VERIFICATION_ROWS: Entries = (
    _row(18, T.VERIFICATION_PASSED, [S.MOVED], S.VERIFIED, do.pass_verification, on=[B.PASSED]),
    _row(18, T.VERIFICATION_PASSED, [S.SAFE_HOLD], Goto.SAME, do.pass_verification, on=[B.PASSED]),
    _row(
        19,
        T.VERIFICATION_PASSED,
        [S.MOVED],
        S.OFF_TARGET,
        do.fail_verification,
        on=[B.EXCEEDED],
        taken_as=T.VERIFICATION_FAILED,
    ),
    _row(
        19,
        T.VERIFICATION_PASSED,
        [S.SAFE_HOLD],
        Goto.SAME,
        do.fail_verification,
        on=[B.EXCEEDED],
        taken_as=T.VERIFICATION_FAILED,
    ),
    _row(19, T.VERIFICATION_FAILED, [S.MOVED], S.OFF_TARGET, do.fail_verification, on=[B.EXCEEDED]),
    _row(19, T.VERIFICATION_FAILED, [S.SAFE_HOLD], Goto.SAME, do.fail_verification, on=[B.EXCEEDED]),
    *(
        _row(
            20,
            judged,
            _EVALUATED_IN,
            Goto.SAME,
            do.drop_evaluation,
            on=[B.UNUSABLE],
            taken_as=T.VERIFICATION_REFUSED,
        )
        for judged in (T.VERIFICATION_PASSED, T.VERIFICATION_FAILED)
    ),
    # The image itself shows that something moved: rows 30, 31 and, in safe_hold, 34 by another way.
    *(row for judged in (T.VERIFICATION_PASSED, T.VERIFICATION_FAILED) for row in _seen_to_move(judged)),
    _row(20, T.VERIFICATION_REFUSED, _EVALUATED_IN, Goto.SAME, do.drop_evaluation, on=[B.CURRENT]),
    _row(21, T.CORRECTION_REQUESTED, _JUDGED, S.TARGET_CHOSEN, do.correct),
    _row(22, T.VERIFICATION_REJECTED, _JUDGED, Goto.SETTLE, do.void_verification, settles_to=[S.MOVED, S.CASE_OPEN]),
    *(
        _unlisted(judged, ALL - set(_EVALUATED_IN))
        for judged in (T.VERIFICATION_PASSED, T.VERIFICATION_FAILED, T.VERIFICATION_REFUSED)
    ),
    *(
        _unlisted(judged, _EVALUATED_IN, on=[B.LATE])
        for judged in (T.VERIFICATION_PASSED, T.VERIFICATION_FAILED, T.VERIFICATION_REFUSED)
    ),
    _unlisted(T.CORRECTION_REQUESTED, ALL - set(_JUDGED)),
    _unlisted(T.VERIFICATION_REJECTED, ALL - set(_JUDGED)),
)

_SEEN_TO_STAND = [S.VERIFIED, S.CARM_POSITIONED, S.CASE_OPEN]

INSERTION_ROWS: Entries = (
    _row(23, T.INSERTION_STARTED, [S.VERIFIED], S.INSERTING, do.open_insertion),
    _row(24, T.SLEEVE_IN, _SLEEVE, S.SLEEVE_INSERTED, do.finish_insertion),
    _row(25, T.SLEEVE_IN, LIVE - INSERTION, S.SAFE_HOLD, do.close_motion, do.finish_unverified, effects=_STOP),
    _row(26, T.INSERTION_CANCELLED, [S.INSERTING], Goto.SETTLE, do.cancel_insertion, settles_to=_SEEN_TO_STAND),
    _row(26, T.INSERTION_CANCELLED, [S.SAFE_HOLD], Goto.SAME, do.cancel_insertion, on=[B.INSERTION_OPEN]),
    _row(27, T.SLEEVE_REMOVED, [S.SLEEVE_INSERTED, S.SAFE_HOLD], Goto.SAME, do.state_guide),
    _row(
        28,
        T.TARGET_DONE,
        [S.SLEEVE_INSERTED],
        Goto.SETTLE,
        do.archive_insertion,
        settles_to=[S.REGISTERED, S.IMAGE_ACQUIRED, S.CARM_POSITIONED, S.CASE_OPEN],
    ),
    _row(29, T.GUIDE_STATE_STATED, LIVE, Goto.SAME, do.state_guide, on=[B.EMPTY]),
    _row(29, T.GUIDE_STATE_STATED, LIVE - {S.MOVING}, Goto.SAME, do.state_guide, on=[B.NOT_EMPTY]),
    _row(
        35,
        T.GUIDE_STATE_STATED,
        [S.MOVING],
        S.SAFE_HOLD,
        do.close_motion,
        do.void_from(Link.PLAN),
        do.state_guide,
        on=[B.NOT_EMPTY],
        effects=_STOP,
    ),
    _unlisted(T.INSERTION_STARTED, ALL - {S.VERIFIED}),
    _unlisted(T.SLEEVE_IN, OVER),
    _unlisted(T.INSERTION_CANCELLED, ALL - {S.INSERTING, S.SAFE_HOLD}),
    _unlisted(T.INSERTION_CANCELLED, [S.SAFE_HOLD], on=[B.INSERTION_NOT_OPEN]),
    _unlisted(T.SLEEVE_REMOVED, ALL - {S.SLEEVE_INSERTED, S.SAFE_HOLD}),
    _unlisted(T.TARGET_DONE, ALL - {S.SLEEVE_INSERTED}),
    _unlisted(T.GUIDE_STATE_STATED, LIVE, on=[B.INSERTED]),
    _unlisted(T.GUIDE_STATE_STATED, OVER),
)

_VIEW_LEFT = [S.VERIFIED, S.CASE_OPEN]
_PATIENT_LEFT = [S.CARM_POSITIONED, S.CASE_OPEN]
_MOVED_THINGS: tuple[tuple[int, Trigger, Change, list[State]], ...] = (
    (30, T.CARM_MOVED, do.void_view_keeping_passed, _VIEW_LEFT),
    (31, T.PATIENT_MOVED, do.void_from(Link.IMAGE), _PATIENT_LEFT),
    (32, T.ARM_DISTURBED, do.void_from(Link.IMAGE), _PATIENT_LEFT),
    (32, T.HAND_GUIDED, do.void_from(Link.IMAGE), _PATIENT_LEFT),
    (33, T.DEVICE_CHANGED, do.void_from(Link.VIEW), [S.CASE_OPEN]),
)


def _movement_rows(number: int, trigger: Trigger, void: Change, settles_to: list[State]) -> Entries:
    """Rows 30 to 33 for one thing that moved, with their share of rows 34 and 35."""
    voids = (void, do.forget_images)
    held = INSERTION | {S.SAFE_HOLD}
    return (
        _row(number, trigger, IDLE, Goto.SETTLE, *voids, settles_to=settles_to),
        _row(34, trigger, held, Goto.SAME, *voids, do.flag_insertion, effects=(Effect.ALARM,)),
        _row(
            35,
            trigger,
            [S.MOVING],
            S.SAFE_HOLD,
            do.close_motion,
            *voids,
            do.void_from(Link.PLAN),
            effects=_STOP,
        ),
        _unlisted(trigger, OVER),
    )


MOVEMENT_ROWS: Entries = tuple(row for thing in _MOVED_THINGS for row in _movement_rows(*thing))

HOLD_ROWS: Entries = (
    _row(36, T.STOP, LIVE, S.SAFE_HOLD, do.close_motion, effects=_STOP),
    _row(36, T.STOP, OVER, Goto.SAME, effects=_STOP),
    _row(37, T.FAULT, LIVE, S.SAFE_HOLD, do.close_motion, effects=_STOP),
    _row(
        38,
        T.RESTARTED,
        LIVE,
        S.SAFE_HOLD,
        do.close_motion,
        do.void_from(Link.VIEW),
        do.forget_images,
    ),
    _row(39, T.HOLD_REQUESTED, LIVE - {S.MOVING}, S.SAFE_HOLD),
    _row(40, T.ACKNOWLEDGED, [S.SAFE_HOLD], Goto.SETTLE, settles_to=IDLE | INSERTION),
    _row(41, T.LEASE_TAKEN, LIVE - {S.MOVING}, Goto.SAME, do.take_lease),
    _row(41, T.LEASE_TAKEN, [S.MOVING], S.SAFE_HOLD, do.close_motion, do.take_lease, effects=_STOP),
    _row(42, T.CASE_CLOSED, IDLE, S.CLOSED, effects=(Effect.CHECKPOINT_SIGNED,)),
    _row(43, T.CASE_ABORTED, LIVE, S.ABORTED, do.close_motion, effects=_STOP),
    *(_row(44, paper, ALL, Goto.SAME) for paper in (T.NOTE, T.LABEL, T.READ, T.EXPORT)),
    _unlisted(T.FAULT, OVER),
    _unlisted(T.RESTARTED, OVER),
    _unlisted(T.HOLD_REQUESTED, OVER | {S.MOVING}),
    _unlisted(T.ACKNOWLEDGED, ALL - {S.SAFE_HOLD}),
    _unlisted(T.LEASE_TAKEN, OVER),
    _unlisted(T.CASE_CLOSED, ALL - IDLE),
    _unlisted(T.CASE_ABORTED, OVER),
)

TABLE: Entries = (
    *IMAGE_ROWS,
    *MOTION_ROWS,
    *VERIFICATION_ROWS,
    *INSERTION_ROWS,
    *MOVEMENT_ROWS,
    *HOLD_ROWS,
)
