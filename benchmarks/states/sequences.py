"""Random sequences of commands, facts and observations through HTTP, each step compared with the reference model.

A number is the seed of one sequence, and each of its steps is drawn as it comes: the steps up to a difference are the
shortest prefix that shows it.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

from benchmarks.states import happenings
from benchmarks.states.asking import state
from benchmarks.states.drawing import be_careless, go_on, repeat, request_anything, state_anything
from benchmarks.states.play import Difference, Play, is_over
from benchmarks.states.room import Room, scripted_room

Trial = dict[str, Any]
STEPS = 50
_ONWARDS = 0.6  # share of steps that lead on, so that whole procedures happen
# Everything that may happen beside, with its weight.
_ANYTHING: dict[Callable[[Play], str], int] = {
    request_anything: 40,
    state_anything: 12,
    repeat: 5,
    be_careless: 3,
    happenings.send_image: 5,
    happenings.finish_work: 5,
    happenings.end_motion: 4,
    happenings.press_stop: 3,
    happenings.fault: 2,
    happenings.disturb: 2,
    happenings.restart: 1,
    happenings.change_arm: 5,
    happenings.let_time_pass: 6,
}


def sequences(_folder: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """Sequences by number, in one service."""
    with TemporaryDirectory() as place, scripted_room(Path(place)) as room:
        yield from played(room, numbers)


def played(room: Room, numbers: Iterable[int], steps: int = STEPS) -> Iterator[Trial]:
    """Sequences of so many steps, each in a case of its own."""
    devices = room.upload_devices("1"), room.upload_devices("2")
    for number in numbers:
        play, done = Play(room, devices, Random(number), number), list[str]()
        try:
            for _ in range(steps):
                done.append(_step(play))
                play.compare()
            _end(play)
        except Difference as difference:
            play.leave()
            said = {"said": str(difference), "prefix": done}
            yield {"number": number, "kind": "differed", "bad": True, "steps": len(done)} | said
        else:
            kind = f"came to {play.furthest}"
            yield {"number": number, "kind": kind, "bad": False, "steps": len(done), "requests": play.requests}


def _step(play: Play) -> str:
    """One step, done and told."""
    drawn = play.random.choices(list(_ANYTHING), list(_ANYTHING.values()))[0]
    return go_on(play) if play.random.random() < _ONWARDS else drawn(play)


def _end(play: Play) -> None:
    """The case is over, its image work ends late, and its whole record is the model's."""
    if not is_over(play):
        state(play, "case_aborted", "surgeon", {"reason": "the end"})
        play.compare()
    while play.work:
        happenings.finish_work(play)
        play.compare()
    play.compare_record()
