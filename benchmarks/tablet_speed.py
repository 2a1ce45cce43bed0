"""How fast the tablet is in headless Chromium: first screen, image on screen, frames of a window drag.

    python -m benchmarks.tablet_speed [--count N]

Service and simulated room run beside the browser, as processes of their own; nobody asks for the images, so that none
is registered. Asked for are: the first screen within 1 s, with nothing kept from before; an image of 1024 x 1024 pixels
and 16 bits drawn within 300 ms after the service recorded its arrival; and 30 frames a second while a finger drags the
window. Exit status 1 where a median misses that.
"""

import argparse
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from datetime import datetime
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright
from rich.console import Console
from rich.progress import track

from coaxial_client import Case
from simulator.demo.imaging import turn_carm
from simulator.demo.patience import HELD, leave_hold
from simulator.demo.stage import Stage, open_stage
from simulator.demo.team import Team
from simulator.demo.telling import Teller
from simulator.demo.watching import await_event

_CHROMIUM = "/usr/bin/chromium"
_PEDICLE = "L3-left"
_DRAG_FRAMES = 120
_RESULT_WITHIN_S = 120.0
_FIRST_S, _IMAGE_S, _FRAMES_PER_S = 1.0, 0.3, 30.0

_SIGN_IN = """([name, pin]) => fetch('/api/session', {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({name, pin})})"""
# When each canvas was first drawn on, seconds since 1970.
_WATCH = """() => {
    const seen = new WeakSet();
    window.firstDrawn = [];
    new MutationObserver((changes) => {
        for (const { target } of changes) {
            if (seen.has(target)) continue;
            seen.add(target);
            window.firstDrawn.push((performance.timeOrigin + Number(target.dataset.painted)) / 1000);
        }
    }).observe(document.body, { subtree: true, attributes: true, attributeFilter: ['data-painted'] });
}"""
# One step of a finger each frame; the times of all drawings, milliseconds.
_DRAG = """async (frames) => {
    const image = document.querySelector('.stage-image');
    const { left, top } = image.getBoundingClientRect();
    image.setPointerCapture = () => {};  // no real finger is there to be captured
    const send = (kind, x) => image.dispatchEvent(new PointerEvent(kind, {
        pointerId: 1, bubbles: true, clientX: left + x, clientY: top + 200, isPrimary: true, button: 0 }));
    const drawn = new Set();
    send('pointerdown', 100);
    for (let frame = 0; frame < frames; frame += 1) {
        send('pointermove', 100 + 2 * frame);
        await new Promise(requestAnimationFrame);
        drawn.add(Number(image.querySelector('canvas').dataset.painted));
    }
    send('pointerup', 100);
    return [...drawn];
}"""


def main() -> int:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=10, help="repetitions of each")
    count = parser.parse_args().count
    with _room() as (stage, team), _browser() as browser:
        print(f"load of the machine's {os.cpu_count()} processors before: {os.getloadavg()[0]:.1f}")
        page = _in_the_case(browser, stage, team.surgeon)
        first = [_first_screen(browser, stage) for _ in track(range(count), "first screens")]
        images = [_image(page, team) for _ in track(range(count), "images")]
        drags = [_frames_per_s(page) for _ in track(range(count), "drags")]
    print(f"load after: {os.getloadavg()[0]:.1f}")
    kept = [
        _tell("first screen, s", first, max, lambda median: median <= _FIRST_S, _FIRST_S),
        _tell("image drawn after it arrived, s", images, max, lambda median: median <= _IMAGE_S, _IMAGE_S),
        _tell("frames a second", drags, min, lambda median: median >= _FRAMES_PER_S, _FRAMES_PER_S),
    ]
    return 0 if all(kept) else 1


@contextmanager
def _room() -> Iterator[tuple[Stage, Team]]:
    """A case that waits for its first image."""
    with ExitStack() as up:
        folder = Path(up.enter_context(tempfile.TemporaryDirectory(prefix="coaxial-tablet-")))
        teller = Teller(Console(quiet=True))
        stage = up.enter_context(open_stage(folder, 0, None, teller))
        surgeon, operator = (up.enter_context(stage.sign_in(role)) for role in ("surgeon", "operator"))
        room, planned = stage.door.room(), {one.name: one for one in stage.door.pedicles()}[_PEDICLE]
        target = {"name": planned.name, "entry_mm": planned.entry_mm, "target_mm": planned.target_mm}
        plan = {"patient_id": room["patient"]["id"], "study_uid": room["study_uid"], "position": "prone"}
        case = surgeon.open_case(plan | {"targets": [target]})
        while not case.status()["arm"]["connected"]:
            time.sleep(0.1)
        case.take_lease("speed of the tablet")
        team = Team(case, operator.case(case.id), stage.people["surgeon"].pin, stage.door, teller)
        turn_carm(team, _PEDICLE)
        team.operator.command("guide-state-stated", guide="empty")
        yield stage, team


@contextmanager
def _browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=_CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


def _in_the_case(browser: Browser, stage: Stage, case: Case) -> Page:
    """A tablet that shows the case."""
    page, person = browser.new_page(viewport={"width": 1280, "height": 800}), stage.people["surgeon"]
    page.goto(stage.url)
    page.evaluate(_SIGN_IN, [person.name, person.pin])
    page.goto(f"{stage.url}/#case/{case.id}")
    page.reload()
    page.locator("main[data-state]").wait_for()
    page.evaluate(_WATCH)
    return page


def _first_screen(browser: Browser, stage: Stage) -> float:
    """Seconds until something is drawn, by a browser that has never been here."""
    page = browser.new_page()
    page.goto(stage.url)
    page.get_by_label("Name").wait_for()
    drawn_ms = page.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime")
    page.close()
    return float(drawn_ms) / 1000.0


def _image(page: Page, team: Team) -> float:
    """Seconds from the record of an image's arrival to its drawing."""
    status = team.operator.status()
    if status["state"] == HELD:
        leave_hold(team)
    after = int(status["sequence"])
    team.door.expose()
    arrived = await_event(team.surgeon, after, ("image_arrived",), _RESULT_WITHIN_S)
    arrived_s = datetime.fromisoformat(arrived["recorded_at"]).timestamp()
    page.wait_for_function("arrived => window.firstDrawn.at(-1) > arrived", arg=arrived_s)
    drawn_s = min(at_s for at_s in page.evaluate("window.firstDrawn") if at_s > arrived_s)
    return float(drawn_s - arrived_s)


def _frames_per_s(page: Page) -> float:
    """Of the image that is shown, while its window is dragged."""
    page.locator(".stage-image canvas[data-painted]").first.wait_for()
    drawn_ms = sorted(page.evaluate(_DRAG, _DRAG_FRAMES))
    return float((len(drawn_ms) - 1) / (drawn_ms[-1] - drawn_ms[0]) * 1000.0)


def _tell(
    name: str, values: list[float], worst: Callable[[list[float]], float], holds: Callable[[float], bool], asked: float
) -> bool:
    median = statistics.median(values)
    print(f"{name}: median {median:.3f}, worst {worst(values):.3f} of {len(values)}; asked for {asked:g}")
    return holds(median)


if __name__ == "__main__":
    sys.exit(main())
