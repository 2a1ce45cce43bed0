"""What happens in the room: images arrive, image work and motions end, somebody stops, the arm is seen otherwise."""

from uuid import uuid4

from benchmarks.states.guard import Readings
from benchmarks.states.images import Sender, pixels_of, xa_image
from benchmarks.states.model import INSERTION
from benchmarks.states.people import PEOPLE
from benchmarks.states.play import Difference, Play, is_over
from benchmarks.states.refusals import WINDOW_S
from robot.guard.messages import EndCause, FaultKind
from robot.safety import SafetyState
from service.conductor.recovery import recover

_WRONG = ("foreign", "same pixels", "old")
_UNSOUND = ("unsound", "refused", "crashed")
_UNVERIFIED = ("exceeded", "disagree", "unmeasured", "view_moved", "patient_shifted", "refused", "crashed")
# Cause, at the goal, at rest; most motions arrive.
_ENDS = (
    *((EndCause.ARRIVED, True, True),) * 6,
    (EndCause.ARRIVED, False, True),
    (EndCause.MISSED, False, True),
    (EndCause.RELEASED, False, True),
    (EndCause.RELEASED, False, False),
    (EndCause.PROTECTIVE_STOP, False, True),
)
_ODD_READINGS = (
    Readings(at_rest=False),
    Readings(safety=SafetyState.PROTECTIVE_STOP),
    Readings(safety=SafetyState.REDUCED),
    Readings(program_running=True),
    Readings(payload_kg=2.0),
)
_SECONDS = (1.0, 1.0, 10.0, 31.0, 31.0, 121.0, 901.0, 1801.0)


def send_image(play: Play) -> str:
    """An image arrives: the case's own and new, or not."""
    wrong = play.random.random() < 0.25 and not is_over(play)
    kind = play.random.choice(_WRONG) if wrong else "right"
    return arrive(play, "right" if kind == "same pixels" and not play.pixels else kind)


def arrive(play: Play, kind: str) -> str:
    """An image by HTTP; the service takes it in by itself."""
    image, model = len(play.images), play.model
    pixels = play.random.choice(play.pixels) if kind == "same pixels" else uuid4().int >> 64
    sender = Sender("P0", play.sender.study_uid) if kind == "foreign" else play.sender
    content = xa_image(sender, pixels_of(pixels), 0 if kind == "old" else play.room.next_second())
    answer = play.send("POST", "/images", "operator", content, Content_Type="application/dicom")
    play.expect(answer, None)
    play.images.append(str(answer.body["id"]))
    play.pixels.append(pixels)
    before = model.state
    model.image_arrived(image, play.now_s, of_the_case=kind == "right", window_s=WINDOW_S)
    if model.state != before:
        play.work.append(("registration", image))
    elif model.evaluated == image:
        play.work.append(("evaluation", image))
    return f"image {image}, {kind}"


def finish_work(play: Play) -> str:
    """The oldest image work ends."""
    if not play.work:
        return "no image work"
    if not play.room.wait(lambda: play.room.vision.is_at_work):
        raise Difference(f"not begun: {play.work[0]}")
    kind, image = play.work.pop(0)
    good, others = ("sound", _UNSOUND) if kind == "registration" else ("passed", _UNVERIFIED)
    outcome = good if play.random.random() < 0.8 else play.random.choice(others)
    play.room.vision.finish(outcome)
    if kind == "registration":
        play.model.registration_came(image, outcome)
    else:
        play.model.evaluation_came(image, outcome, play.now_s)
    return f"{kind} of image {image}: {outcome}"


def end_motion(play: Play) -> str:
    """The motion under way ends by itself."""
    if play.model.state != "moving":
        return "no motion"
    cause, at_goal, at_rest = play.random.choice(_ENDS)
    play.room.guard.end(cause, at_goal=at_goal, at_rest=at_rest)
    if cause is EndCause.PROTECTIVE_STOP:
        play.model.held("fault")
    else:
        play.model.motion_ended(cause.value, at_goal=at_goal, at_rest=at_rest)
    play.room.drift_known = cause is EndCause.ARRIVED
    return f"motion ended: {cause.value}, at goal {at_goal}, at rest {at_rest}"


def press_stop(play: Play) -> str:
    """Anybody stops, in the case or the room."""
    person, in_case = play.random.choice(PEOPLE), play.random.random() < 0.5
    play.expect(play.send("POST", play.path("stop") if in_case else "/stop", person, {}), None)
    if in_case or not is_over(play):
        play.stopping(lambda: play.model.held("stop"))
    return f"stop by {person}{' in the case' * in_case}"


def fault(play: Play) -> str:
    """The guard tells a fault."""
    play.room.guard.fault(FaultKind.PROTECTIVE_STOP)
    if not is_over(play):
        play.stopping(lambda: play.model.held("fault"))
    return "fault"


def disturb(play: Play) -> str:
    """The guard saw the arm pushed; with a sleeve in, the drift decides where it is known."""
    if play.model.state in INSERTION and play.room.drift_known:
        return "no disturbance"
    play.room.guard.disturb()
    if not is_over(play):
        play.stopping(lambda: play.model.seen_to_move("arm_disturbed"))
    return "disturbed"


def restart(play: Play) -> str:
    """What a start of the service records, amid no motion."""
    if is_over(play) or play.model.state == "moving":
        return "no restart"
    recover(play.room.conductor)
    play.model.restarted()
    return "restarted"


def change_arm(play: Play) -> str:
    """The arm is seen otherwise, or as it should be again."""
    guard = play.room.guard
    guard.readings = play.random.choice(_ODD_READINGS) if guard.readings == Readings() else Readings()
    guard.look()
    return f"the arm: {guard.readings}"


def let_time_pass(play: Play) -> str:
    """Seconds to half an hour."""
    seconds = play.random.choice(_SECONDS)
    play.room.clock.now_s += seconds
    play.room.guard.look()
    return f"{seconds} s pass"
