"""`coaxial case list`: an auditor finds a case without knowing the patient, and names it by the beginning of its id."""

import json

import pytest
from typer.testing import CliRunner, Result

from service.auth.users import UserStore
from service.cases import store
from service.cases.records import NewEvent
from service.cli.audit import audit
from service.cli.case import case
from service.database.current import current_database
from workflow.states import State

pytestmark = pytest.mark.usefixtures("remembered_jobs")


@pytest.fixture
def listed(make_site, tmp_path):
    """A folder with a closed case, an aborted one and one under way, and their ids, newest first."""
    folder = make_site(tmp_path / "site", State.CLOSED, State.ABORTED, State.MOVED).folder
    return folder, [one["id"] for one in map(json.loads, _run(folder, "list", "--json").stdout.splitlines())]


def _run(folder, *words: object, command=case) -> Result:
    return CliRunner().invoke(command, [*map(str, words), "--data-folder", str(folder)])


def _place(site, name: str) -> None:
    with current_database(site.settings) as database, database.write() as connection:
        last = store.newest_event(connection, site.case_id)
        data = {"planned_target": name, "placed": True}
        event = NewEvent("target_done", last.user_id, last.state, last.case_state, data)
        store.append(connection, site.case_id, event, expected_version=None)


def test_a_closed_case_is_listed_with_when_where_who_and_how_far(site):
    _place(site, "L3 left")
    with current_database(site.settings) as database, database.read() as connection:
        events = list(store.all_events(connection, site.case_id))
        (surgeon,) = UserStore(database).list()
        room = store.read_case(connection, site.case_id).room
    (closed,) = [one for one in events if one.trigger == "case_closed"]
    assert events[-1].recorded_at > closed.recorded_at, "what is noted later is not the end"
    (told,) = map(json.loads, _run(site.folder, "list", "--json").stdout.splitlines())
    assert told == {
        "id": site.case_id,
        "opened_at": told["opened_at"],
        "ended_at": closed.recorded_at,
        "state": "closed",
        "room": room,
        "opened_by": surgeon.name,
        "targets_placed": 1,
        "targets_abandoned": 0,
        "targets_planned": 1,
    }
    table = _run(site.folder, "list").stdout
    heading, row = table.splitlines()
    assert heading.startswith("case ")
    assert row.split() == [site.case_id, told["opened_at"][:19], closed.recorded_at[:19], "closed", room, "anna", "1/1"]
    assert "P1" not in table


def test_cases_come_newest_first_and_in_parts(listed):
    folder, ids = listed
    rows = [line.split() for line in _run(folder, "list").stdout.splitlines()[1:]]
    assert [row[0] for row in rows] == ids
    assert ["moved" in rows[0], "aborted" in rows[1], "closed" in rows[2]] == [True, True, True]
    first = _run(folder, "list", "--limit", "2")
    assert first.stderr == f"2 cases, and there are more: --before {ids[1]}\n"
    rest = _run(folder, "list", "--before", ids[1][:8])
    assert (rest.stdout.splitlines()[1].split()[0], rest.stderr) == (ids[2], "")


def test_the_beginning_of_an_id_names_a_case_where_it_is_clear_which(listed, tmp_path):
    folder, ids = listed
    out = tmp_path / "case.zip"
    assert _run(folder, "export", ids[2][:8], "--out", out).exit_code == 0
    assert f"case {ids[2]}:" in CliRunner().invoke(case, ["verify", str(out)]).stdout
    assert "1 cases" in _run(folder, "replay", ids[2][:8], command=audit).stdout
    entries = _run(folder, "list", "--case", ids[2][:8], command=audit)
    assert entries.stdout == _run(folder, "list", "--case", ids[2], command=audit).stdout != ""
    unknown = _run(folder, "export", "no-such", "--out", tmp_path / "none.zip")
    assert unknown.stderr.startswith("case_unknown: there is no case no-such")


def test_a_beginning_of_several_cases_is_refused(site):
    site.attack(
        lambda c: c.execute(
            "INSERT INTO cases SELECT id || 'x', room, patient_id, study_uid, opened_by, product_version,"
            " settings_sha256, devices, opened_at FROM cases"
        )
    )
    refused = _run(site.folder, "report", site.case_id[:8])
    assert refused.exit_code == 3
    assert refused.stderr.startswith(f"case_unknown: several cases begin with {site.case_id[:8]}")
    with current_database(site.settings) as database, database.read() as connection:
        assert store.whole_id(connection, site.case_id) == site.case_id, "a whole id is clear"
