"""The interface description is complete: every operation with every error, every error a problem."""

import pytest

from service.app import create_app
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
