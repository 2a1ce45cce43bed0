"""Whoever holds the button is signed out, locked or disabled: the motion ends as if the hold were lost (H27)."""

import time
from collections.abc import Callable, Iterator
from contextlib import closing
from itertools import count

import pytest
import sqlalchemy as sa
from argon2 import PasswordHasher

from coaxial_client import Case, Coaxial
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.database import tables
from service.database.engines import Database, open_database
from tests.system.service_process import PASSWORD, PIN, Service
from tests.system.walk import lift, lifting

# The guard's limit of silence, which this must be no worse than, from the commit of whatever ends the session.
_LIMIT_S = 0.2
_QUICK = PasswordHasher(time_cost=1, memory_cost=8, parallelism=1)
_numbers = count(1)


@pytest.fixture
def database(service: Service) -> Iterator[Database]:
    """The service's database as a second process has it, such as `coaxial user`."""
    with closing(open_database(service.database_url)) as opened:
        yield opened


@pytest.fixture
def holder(service: Service, database: Database) -> Iterator[Coaxial]:
    """A surgeon of this test alone, signed in."""
    name = f"holder{next(_numbers)}"
    UserStore(database, _QUICK).add(name, Role.SURGEON, PASSWORD, PIN)
    with service.sign_in(name) as client:
        yield client


@pytest.fixture
def held_case(case: Case, holder: Coaxial) -> Case:
    """The case, the holder in control of it."""
    theirs = holder.case(case.id)
    theirs.take_lease("holding")
    return theirs


def _user(holder: Coaxial) -> dict:
    return holder._transport.request("GET", "/session").json()


def _change(table: sa.Table, **values: object) -> Callable[[Coaxial, Database], None]:
    """The rows of the holder as another process would write them."""
    column = table.c.id if table is tables.users else table.c.user_id

    def change(holder: Coaxial, database: Database) -> None:
        with database.write() as connection:
            connection.execute(sa.update(table).where(column == _user(holder)["user_id"]).values(values))

    return change


def _disable(holder: Coaxial, database: Database) -> None:
    UserStore(database).disable(_user(holder)["user"])


def _sign_out(holder: Coaxial, _: Database) -> None:
    holder._transport.request("DELETE", "/session")


def _lock(holder: Coaxial, _: Database) -> None:
    holder.post("/session/lock")


@pytest.mark.hazard("H27")
@pytest.mark.parametrize(
    ("end", "code"),
    [
        (_sign_out, "not_signed_in"),
        (_lock, "session_locked"),
        (_disable, "not_signed_in"),
        (_change(tables.users, role=Role.AUDITOR.value), "permission_missing"),
        (_change(tables.sessions, expires_at_s=0.0), "session_expired"),
    ],
    ids=["signed_out", "locked", "disabled", "role_changed", "expired"],
)
def test_a_session_that_ends_amid_a_held_motion_ends_the_motion(
    case, held_case, holder, database, controller, until, end, code
) -> None:
    with lifting(held_case, controller, 60.0) as hold:
        newest = controller.wire()[-1].number
        end(holder, database)
        ended_at_s = time.monotonic()
        ended = hold.wait(5.0)
    stops = [record.at_s for record in controller.wire(newest) if record.text == "stop" or record.command == 255]
    assert min(stops) - ended_at_s < _LIMIT_S
    assert (ended.cause, ended.state, ended.problem["code"]) == ("session_over", "safe_hold", code)
    until(lambda: controller.state().program == "" and not controller.state().moving, 2.0)
    status = case.status()
    assert (status["state"], status["held_for"]) == ("safe_hold", "session_over")
    fault = next(event for event in case.record() if event["trigger"] == "fault")
    assert fault["data"]["code"] == code


@pytest.mark.hazard("H27")
def test_a_session_that_ends_while_the_start_waits_for_the_record_starts_nothing(
    case, held_case, holder, database, controller, until
) -> None:
    permit, newest = held_case.approve(lift(held_case, 20.0), PIN), controller.wire()[-1].number
    with closing(open_database(database.writer.url.render_as_string(hide_password=False))) as other:
        with other.write() as connection:
            hold = held_case.hold(permit)
            hold.__enter__()
            until(lambda: hold.progress.get("held"))
            time.sleep(0.3)  # the start of the motion waits behind this transaction
            mine = tables.sessions.c.user_id == _user(holder)["user_id"]
            connection.execute(sa.update(tables.sessions).where(mine).values(locked_at="2026-01-01T00:00:00Z"))
        ended = hold.wait(5.0)
        hold.__exit__(None, None, None)
    assert (ended.cause, ended.problem["code"]) == ("refused", "session_locked")
    assert case.status()["state"] == "case_open"
    assert "script" not in {record.kind for record in controller.wire(newest)}


@pytest.mark.hazard("H27")
def test_a_session_that_ended_amid_a_held_motion_may_still_stop(case, held_case, holder, controller) -> None:
    with lifting(held_case, controller, 60.0):
        holder.post("/session/lock")
        assert holder.stop()["sent_to_guard"]
    assert case.wait_for("safe_hold")
