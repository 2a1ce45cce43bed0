"""The report of a recorded case: from the command line, of every state, the same bytes for the same record."""

from io import BytesIO

import pytest
from pypdf import PdfReader
from typer.testing import CliRunner

from service.cases import store
from service.cases.records import NewEvent
from service.cli.case import case
from service.database.current import current_database
from service.errors import ErrorCode, ServiceError
from service.report.making import make_report
from service.vision_jobs import JOBS
from workflow.states import State


class _Here:
    """The image worker's jobs in this process: it takes two seconds to start another."""

    async def run(self, job, *arguments):
        return JOBS[job](*arguments)


async def _report(site) -> bytes:
    with current_database(site.settings) as database:
        return await make_report(database, _Here(), site.case_id)


def _text(pdf: bytes) -> str:
    return " ".join(" ".join(page.extract_text() for page in PdfReader(BytesIO(pdf)).pages).split())


def _run(coroutine):
    import asyncio

    return asyncio.run(coroutine)


def test_the_command_writes_what_was_done_and_what_nobody_told(site, tmp_path):
    out = tmp_path / "report.pdf"
    arguments = ["report", site.case_id, "--out", str(out), "--data-folder", str(site.folder)]
    result = CliRunner().invoke(case, arguments)
    assert (result.exit_code, result.stdout) == (0, f"{out}\n")
    assert out.read_bytes() == _run(_report(site)), "the same record gives the same file"
    text = _text(out.read_bytes())
    assert "Case report CLOSED" in text
    assert f"Case {site.case_id}" in text
    assert "Target 1: L3 left" in text
    assert "L3 left not finished PASS" in text
    assert "Page 1 of" in text
    assert "Accession number not told" in text
    assert "Images 2 30" in text
    assert "Images per target – 7.5" in text, "none was placed, so there is none"


def test_a_case_that_is_not_over_has_one_and_it_says_so(make_site, tmp_path):
    open_case = make_site(tmp_path / "open", State.MOVED)
    assert "OPEN The case is still open, in the state “moved”." in _text(_run(_report(open_case)))


def test_an_aborted_case_has_one_with_the_reason(make_site, tmp_path):
    aborted = make_site(tmp_path / "aborted", State.MOVED)
    with current_database(aborted.settings) as database, database.write() as connection:
        last = store.newest_event(connection, aborted.case_id)
        event = NewEvent("case_aborted", last.user_id, "aborted", last.case_state, {"reason": "#[power] cut"})
        store.append(connection, aborted.case_id, event, expected_version=None)
    text = _text(_run(_report(aborted)))
    assert "Case report ABORTED" in text
    assert "Reason: #[power] cut." in text


@pytest.mark.parametrize(
    ("told", "words"),
    [({"reason": {"code": "evaluations_disagree"}}, "refused: evaluations disagree"), ({}, "refused")],
)
def test_an_image_that_the_rules_refused_says_so_with_the_reason_where_it_was_recorded(
    make_site, tmp_path, told, words
):
    site = make_site(tmp_path / "refused", State.MOVED)
    with current_database(site.settings) as database, database.write() as connection:
        last = store.newest_event(connection, site.case_id)
        image_id = store.events_of_kind(connection, site.case_id, ["image_arrived"])[-1].data["image_id"]
        event = NewEvent("verification_refused", None, "moved", last.case_state, {"image_id": image_id} | told)
        store.append(connection, site.case_id, event, expected_version=None)
    assert f"; {words}" in _text(_run(_report(site)))


def test_a_case_that_there_is_not_has_none(site):
    with current_database(site.settings) as database, pytest.raises(ServiceError) as refused:
        _run(make_report(database, _Here(), "none"))
    assert refused.value.code == ErrorCode.CASE_UNKNOWN
