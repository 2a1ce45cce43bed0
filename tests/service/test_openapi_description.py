"""The interface description is complete: every operation with every error, every error a problem."""

import pytest

from service.app import create_app
from service.auth.dependencies import COOKIE
from service.errors import ANSWERS
from service.settings import Settings


@pytest.fixture(scope="module")
def description(tmp_path_factory):
    return create_app(Settings(data_folder=tmp_path_factory.mktemp("none"))).openapi()


def _operations(description):
    for path, item in description["paths"].items():
        for method, operation in item.items():
            yield f"{method} {path}", operation


def test_every_operation_has_a_summary_and_its_errors_as_problems(description):
    for name, operation in _operations(description):
        assert operation.get("description"), name
        errors = {status: one for status, one in operation["responses"].items() if status >= "400"}
        assert {"401", "403", "413", "422", "500", "503"} <= errors.keys(), name
        for status, error in errors.items():
            assert error["content"].keys() == {"application/problem+json"}, f"{name} {status}"


def test_every_documented_code_exists_and_has_that_status(description):
    for name, operation in _operations(description):
        for status, response in operation["responses"].items():
            if status >= "400":
                for code in response["description"].split(", "):
                    assert str(ANSWERS[code].status) == status, name


def test_every_reference_resolves(description):
    def references(value):
        if isinstance(value, dict):
            yield from ([value["$ref"]] if "$ref" in value else [])
            for one in value.values():
                yield from references(one)
        elif isinstance(value, list):
            for one in value:
                yield from references(one)

    schemas = description["components"]["schemas"]
    for reference in references(description):
        assert reference.removeprefix("#/components/schemas/") in schemas


def test_operation_ids_are_unique(description):
    ids = [operation["operationId"] for _, operation in _operations(description)]
    assert len(ids) == len(set(ids))


def test_every_success_says_what_kind_of_body_it_has(description):
    for name, operation in _operations(description):
        for status, response in operation["responses"].items():
            if status < "400" and status != "204":
                assert response.get("content"), f"{name} {status}"


def test_the_events_are_described_as_the_stream_that_they_are(description):
    answer = description["paths"]["/api/cases/{case_id}/events"]["get"]["responses"]["200"]
    assert answer["content"].keys() == {"text/event-stream"}


def test_a_session_is_described_where_one_is_needed(description):
    """A client made from the description has to know how the token goes with a request."""
    schemes = description["components"]["securitySchemes"]
    assert (schemes["bearer"]["scheme"], schemes["cookie"]["name"]) == ("bearer", COOKIE)
    assert description["security"] == [{"bearer": []}, {"cookie": []}]
    without = {name for name, operation in _operations(description) if operation.get("security") == []}
    assert without == {"post /api/session", "get /api/health/live", "get /api/health/ready"}
