"""A real browser at the real service in the simulated room; everything on the screen is done by touch."""

import os
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import pytest
from playwright.sync_api import Browser, ConsoleMessage, Request, sync_playwright
from rich.console import Console

from benchmarks.computed_results import compute
from benchmarks.recorded_cases import Results
from coaxial_client import Case
from service.auth.permissions import Role
from service.settings import Settings
from simulator.demo.stage import Stage, open_stage
from simulator.demo.telling import Teller
from tests.service.conftest import RunningService
from tests.tablet.hand import Hand
from tests.tablet.quiet_room import QuietRoom, answer_as_if_all_were_allowed, closed_case
from tests.tablet.tablet import Tablet
from workflow.states import State

CHROMIUM = "/usr/bin/chromium"
_SCREEN = {"width": 1280, "height": 800}
_LOOK_EVERY_S = 0.1
_FIRST_SCREEN_MS = 90_000.0  # a machine's patience; how soon it is there is measured by make tablet-speed
_NICENESS = -15  # so that even image work, which stands back by 10, comes first
PEDICLE = "L3-left"
STATUS = "**/cases/*/status"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A whole procedure, which takes longer than make test has, holds a button; screens alone keep no time.

    Beside what does they must not run: a browser draws with the processor.
    """
    for item in items:
        if item.path.is_relative_to(Path(__file__).parent):
            item.add_marker(pytest.mark.tablet)
            if item.get_closest_marker("lengthy"):
                item.add_marker(pytest.mark.real_time)


@contextmanager
def _precedence() -> Iterator[None]:
    """What is started here comes before what else runs, where the system lets us: a room's parts have processors of
    their own."""
    before = os.getpriority(os.PRIO_PROCESS, 0)
    with suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, _NICENESS)
    try:
        yield
    finally:
        os.setpriority(os.PRIO_PROCESS, 0, before)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Debian's Chromium; while it is open, this thread has an event loop, and no other test may run its own."""
    with ExitStack() as open_now:
        with _precedence():
            playwright = open_now.enter_context(sync_playwright())
            chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    """Service and room as processes of their own."""
    folder = tmp_path_factory.mktemp("stage")
    with ExitStack() as open_now:
        told = open_now.enter_context((folder / "told").open("w"))
        with _precedence():
            up = open_now.enter_context(open_stage(folder, 0, None, Teller(Console(file=told))))
        yield up


@pytest.fixture
def open_tablet(browser: Browser) -> Iterator[Callable[..., Tablet]]:
    """Tablets at any address; what their pages complain of fails the test."""
    opened: list[Tablet] = []

    def open_at(url: str, by: Browser = browser, **differing: object) -> Tablet:
        context = by.new_context(**{"has_touch": True, "viewport": _SCREEN, "locale": "en-GB"} | differing)
        page = context.new_page()
        page.set_default_navigation_timeout(_FIRST_SCREEN_MS)
        tablet = Tablet(page, Hand(page), url)
        page.on("request", lambda request: _note_request(tablet, request))
        page.on("console", lambda message: _note_message(tablet, message))
        page.on("pageerror", lambda error: tablet.complaints.append(str(error)))
        opened.append(tablet)
        return tablet

    yield open_at
    for tablet in opened:
        tablet.page.context.close()
        assert tablet.complaints == []
        assert tablet.strangers() == set()


def _note_request(tablet: Tablet, request: Request) -> None:
    tablet.asked.append(request.url)


def _note_message(tablet: Tablet, message: ConsoleMessage) -> None:
    # A refused request is told on the screen; the browser's own line about it is no complaint of the page.
    if message.type == "error" and "Failed to load resource" not in message.text:
        tablet.complaints.append(message.text)


@pytest.fixture
def surgeon(stage: Stage, open_tablet: Callable[..., Tablet]) -> Tablet:
    """The surgeon's tablet, signed in."""
    tablet = open_tablet(stage.url)
    tablet.sign_in("surgeon", stage.people["surgeon"].pin)
    return tablet


@pytest.fixture(scope="module")
def case(stage: Stage) -> Iterator[Case]:
    """An open case, by the public client: to bring it quickly to where a screen is looked at."""
    room, planned = stage.door.room(), {one.name: one for one in stage.door.pedicles()}[PEDICLE]
    target = {"name": planned.name, "entry_mm": planned.entry_mm, "target_mm": planned.target_mm}
    plan = {"patient_id": room["patient"]["id"], "study_uid": room["study_uid"], "position": "prone"}
    with stage.sign_in("surgeon") as client:
        opened = client.open_case(plan | {"targets": [target]})
        while not opened.status()["arm"]["connected"]:
            time.sleep(_LOOK_EVERY_S)
        yield opened


@pytest.fixture(scope="session")
def results() -> Results:
    """What a case's record holds; computed once, for it takes longer than a test."""
    return compute(Settings())


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory, results: Results) -> Iterator[tuple[RunningService, str]]:
    with closed_case(tmp_path_factory.mktemp("quiet"), results) as up:
        yield up


@pytest.fixture
def room(recorded: tuple[RunningService, str], open_tablet: Callable[..., Tablet]) -> QuietRoom:
    return QuietRoom(*recorded, open_tablet)


@pytest.fixture
def open_case(room: QuietRoom) -> Iterator[str]:
    """A case in the quiet room, aborted after the test."""
    yield room.open_case()
    room.abort_case()


@pytest.fixture
def procedure(room: QuietRoom) -> Iterator[QuietRoom]:
    """The quiet room, whose recorded case is put into states that it had; closed again after the test."""
    yield room
    room.put(State.CLOSED)


@pytest.fixture
def at_the_case(procedure: QuietRoom) -> Callable[..., Tablet]:
    """A tablet of the surgeon's at the recorded case."""

    def go(**differing: object) -> Tablet:
        return procedure.tablet_of(Role.SURGEON, f"#case/{procedure.case_id}", **differing)

    return go


@pytest.fixture
def allowed_at(procedure: QuietRoom, at_the_case: Callable[..., Tablet]) -> Iterator[Callable[..., Tablet]]:
    """A tablet at the case in some state, allowed everything; what it still asks at the end is let go."""
    opened: list[Tablet] = []

    def go(state: State, **differing: object) -> Tablet:
        procedure.put(state)
        opened.append(at_the_case(**differing))
        opened[-1].page.route(STATUS, lambda route: answer_as_if_all_were_allowed(route, route.fetch()))
        return opened[-1]

    yield go
    for tablet in opened:
        tablet.page.unroute_all(behavior="ignoreErrors")
