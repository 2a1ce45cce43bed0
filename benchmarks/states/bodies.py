"""What a sequence sends with a request, and what that is to the model."""

from typing import Any

from benchmarks.states.play import PLANNED_TARGET, Play
from benchmarks.states.refusals import Given

_KINDS = ("targeting", "corrective", "approach", "calibration", "nudge", "retreat")
Body = dict[str, Any]


def body_of(play: Play, trigger: str, *, wild: bool) -> tuple[Body, Given]:
    """The body of a request; of a wild one, one in five names what is not there."""
    random, model = play.random, play.model
    right = not wild or random.random() < 0.8
    match trigger:
        case "plan_requested":
            usual = "corrective" if model.corrections else "targeting"
            kind = random.choice(_KINDS) if wild else usual
            return {"kind": kind} | _goal(play, kind), Given(kind=kind)
        case "move_approved":
            right = right and model.plan is not None
            return {"plan_id": play.ids["plan"] if right else "none"}, Given(right=right)
        case "newest_image_reused":
            return _reused(play, right=right)
        case "target_confirmed":
            echo = _echo(play) if right else None
            planned = PLANNED_TARGET if random.random() < 0.8 else None
            return {"echo_id": echo or "none", "planned_target": planned}, Given(
                right=echo is not None, planned=planned
            )
        case "correction_requested":
            return {"reason": "because" if right else ""}, Given(reason=right)
        case "target_done":
            placed, reason = random.random() < 0.7, random.random() < 0.7
            return {"placed": placed, "reason": "because" if reason else ""}, Given(placed=placed, reason=reason)
        case "acknowledged":
            guide = model.guide if right else "instrument"
            return {"guide": guide}, Given(right=guide == model.guide)
        case "case_closed":
            abandoned = random.random() < 0.6
            return {"abandoned": {PLANNED_TARGET: "because"} if abandoned else {}}, Given(abandoned=abandoned)
        case "insertion_started" | "carm_position_confirmed" | "exposure_requested":
            return {}, Given()
        case _:
            return {"reason": "because"}, Given()


def _reused(play: Play, *, right: bool) -> tuple[Body, Given]:
    """The newest image, another one, or none; the guide is found in it or not."""
    image = play.model.newest if right else play.random.choice([None, *range(len(play.images))])
    play.room.vision.found_again = found = play.random.random() < 0.8
    return {"image_id": "none" if image is None else play.images[image]}, Given(image=image, found=found)


def _echo(play: Play) -> str | None:
    """A picked point drawn back; None where there is no registered image."""
    image = play.model.chain["I"]
    if not play.model.has("R") or not isinstance(image, int):
        return None
    body = {"image_id": play.images[image], "pixel_px": [30.0, 30.0], "space": "raw"}
    answer = play.send("POST", play.path("target_echo"), "surgeon", body)
    play.expect(answer, None)
    return str(answer.body["echo_id"])


def _goal(play: Play, kind: str) -> Body:
    """A short way, which the room leaves free."""
    guard = play.room.guard
    match kind:
        case "nudge":
            return {"step": {"translation_mm": [0.0, 6.0, 0.0]}}
        case "retreat":
            return {"distance_mm": 10.0}
        case "approach" | "calibration":
            x_mm, y_mm, z_mm = guard.base_from_tcp[:3, 3].tolist()
            pose = {"translation_mm": [x_mm, y_mm, z_mm + 10.0], "rotation_vector_deg": guard.rotation_vector_deg}
            return {"base_from_goal": pose}
    return {}
