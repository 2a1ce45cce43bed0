"""Every code that a package can refuse with: mapped, documented, meaning one thing."""

import inspect
from enum import StrEnum
from pathlib import Path

import robot.errors
import robot.refusal
import vision.refusal
import workflow.refusals
from service.error_page import page
from service.errors import ANSWERS, ErrorCode, ServiceError, code_for_status, refused

_DOCUMENT = Path(__file__).parents[2] / "docs" / "error-codes.md"


def _faults() -> set[str]:
    classes = (one for _, one in inspect.getmembers(robot.errors, inspect.isclass))
    return {one.code for one in classes if issubclass(one, robot.errors.RobotError)}


def _codes() -> dict[str, set[str]]:
    enums: dict[str, type[StrEnum]] = {
        "service": ErrorCode,
        "vision": vision.refusal.RefusalCode,
        "workflow": workflow.refusals.RefusalCode,
        "robot": robot.refusal.RefusalCode,
    }
    codes = {package: {member.value for member in enum} for package, enum in enums.items()}
    codes["robot"] |= _faults()
    return codes


def test_every_code_of_every_package_has_an_answer_and_no_answer_is_left_over():
    codes = set().union(*_codes().values())
    assert codes - ANSWERS.keys() == set(), "give these codes a status and what to do, in service/errors.py"
    assert ANSWERS.keys() - codes == set(), "these codes exist no more"


def test_no_two_packages_use_one_code_for_different_things():
    packages = list(_codes().items())
    for index, (name, codes) in enumerate(packages):
        for other, others in packages[index + 1 :]:
            assert not codes & others, f"{name} and {other}"


def test_statuses_are_errors_and_what_to_do_is_a_sentence():
    for code, answer in ANSWERS.items():
        assert 400 <= answer.status < 600, code
        assert answer.what_to_do.removesuffix(".") not in {answer.what_to_do, ""}, code


def test_the_page_of_codes_is_the_table():
    assert _DOCUMENT.read_text() == page()


def test_a_refusal_keeps_what_was_measured():
    refusal = vision.refusal.Refusal(vision.refusal.RefusalCode.SCALE_MISMATCH, "scale is off", 0.5, 0.05)
    error = refused(refusal)
    assert (error.code, error.message, error.measured, error.limit) == ("scale_mismatch", "scale is off", 0.5, 0.05)
    assert isinstance(error, ServiceError)


def test_the_frameworks_own_errors_get_codes_of_the_same_status():
    for status in (404, 405, 413):
        assert ANSWERS[code_for_status(status)].status == status
    assert code_for_status(418) is ErrorCode.REQUEST_REFUSED
    assert code_for_status(500) is ErrorCode.INTERNAL_FAULT
