"""An open page over a restart of the service."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable

import pytest

from coaxial_client import Case
from simulator.demo.stage import Stage
from tests.tablet.tablet import Tablet

pytestmark = pytest.mark.lengthy

_SERVE = [sys.executable, "-c", "from service.cli.main import main; main()", "serve", "--config"]
_UP_WITHIN_S = 60.0


@pytest.fixture
def enter(open_tablet: Callable[..., Tablet], stage: Stage, case: Case) -> Callable[[str], Tablet]:
    """A tablet of somebody, in the open case."""

    def of(role: str) -> Tablet:
        tablet = open_tablet(stage.url)
        tablet.sign_in(role, stage.people[role].pin)
        tablet.press("Enter the case")
        tablet.page.locator("main[data-state]").wait_for()
        return tablet

    return of


def test_a_page_that_was_open_goes_on_after_a_restart_of_the_service(enter, stage, case):
    surgeon = enter("surgeon")
    surgeon.take_control()
    surgeon.leave_hold()
    service = stage.children[0]
    os.kill(service._process.pid, signal.SIGKILL)
    surgeon.page.get_by_text("No connection to the service").wait_for()
    surgeon.complaints.clear()  # a socket that nobody answers is the browser's complaint, not the page's
    port = stage.url.rsplit(":", 1)[1]
    environment = os.environ | {"COAXIAL_HTTP__PORT": port}
    log = (stage.folder / "restarted.log").open("w")
    again = subprocess.Popen([*_SERVE, str(stage.folder / "coaxial.toml")], env=environment, stdout=log, stderr=log)
    try:
        surgeon.is_at("safe_hold", _UP_WITHIN_S)
        surgeon.page.get_by_text("The service was started anew").wait_for()
        assert not surgeon.page.get_by_text("No connection to the service").is_visible()
    finally:
        surgeon.complaints.clear()
        surgeon.page.context.close()
        again.terminate()
        again.wait(20)
        log.close()
