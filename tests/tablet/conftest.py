"""A real browser at the real service in the simulated room; everything on the screen is done by touch."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, ConsoleMessage, Request, sync_playwright
from rich.console import Console

from service.client import Coaxial
from simulator.demo.stage import Stage, open_stage
from simulator.demo.telling import Teller
from tests.tablet.hand import Hand
from tests.tablet.tablet import Tablet

_CHROMIUM = "/usr/bin/chromium"
_SCREEN = {"width": 1280, "height": 800}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A held button keeps its 50 ms; a procedure with a browser takes longer than make test has."""
    for item in items:
        if item.path.is_relative_to(Path(__file__).parent):
            item.add_marker(pytest.mark.real_time)
            item.add_marker(pytest.mark.tablet)


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Debian's Chromium; in a room it has a processor of its own, so that it comes before what else runs here."""
    program = tmp_path_factory.mktemp("browser") / "chromium"
    program.write_text(f'#!/bin/sh\nexec nice -n -10 {_CHROMIUM} "$@"\n')
    program.chmod(0o755)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    """Service and room as processes of their own."""
    folder = tmp_path_factory.mktemp("stage")
    with (folder / "told").open("w") as told, open_stage(folder, 0, None, Teller(Console(file=told))) as up:
        yield up


@pytest.fixture
def open_tablet(browser: Browser) -> Iterator[Callable[..., Tablet]]:
    """Tablets at any address; what their pages complain of fails the test."""
    opened: list[Tablet] = []

    def open_at(url: str, **differing: object) -> Tablet:
        context = browser.new_context(**{"has_touch": True, "viewport": _SCREEN, "locale": "en-GB"} | differing)
        page = context.new_page()
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


@pytest.fixture
def surgeon_client(stage: Stage) -> Iterator[Coaxial]:
    """The surgeon again, by the public client: to bring a case quickly to where a screen is looked at."""
    with stage.sign_in("surgeon") as client:
        yield client
