"""The room's hidden errors come from a file, and none is zero by default."""

from dataclasses import astuple
from pathlib import Path

import pytest

from simulator.truth import read_truth


def test_no_default_error_is_zero() -> None:
    truth = read_truth()
    seed, *sections, ct = astuple(truth)
    assert seed > 0
    assert ct is None
    assert all(value != 0.0 for section in sections for value in section)


def test_defaults_are_those_of_real_devices() -> None:
    truth = read_truth()
    assert (truth.tool.translation_error_mm, truth.tool.rotation_error_deg) == (0.3, 0.1)
    assert truth.guide.ring_error_mm == 0.05
    assert (truth.arm.repeatability_mm, truth.arm.kinematic_error_mm) == (0.1, 0.5)
    assert (truth.carm.sag_mm, truth.patient.breathing_mm) == (0.3, 0.5)


def test_file_replaces_only_what_it_names() -> None:
    truth = read_truth(b"seed = 5\n[tool]\ntranslation_error_mm = 2\n")
    assert (truth.seed, truth.tool.translation_error_mm, truth.tool.rotation_error_deg) == (5, 2.0, 0.1)


def test_ct_is_found_beside_its_truth_file() -> None:
    text = b"[ct]\npath = 'a/ct.nii'\n[ct.pedicles.T12-left]\nentry_mm = [1, 2.5, 3]\ntarget_mm = [1, -2, 4]"
    planned = read_truth(text, Path("/folder")).ct
    assert planned.path == Path("/folder/a/ct.nii")
    assert planned.pedicles["T12-left"].entry_in_patient.tolist() == [1.0, 2.5, 3.0]
    assert planned.pedicles["T12-left"].target_in_patient.tolist() == [1.0, -2.0, 4.0]


@pytest.mark.parametrize(
    "text",
    [
        b"[tool]\ntranslation_error = 1.0",
        b"[robot]\nx = 1",
        b"[tool]\ntranslation_error_mm = nan",
        b"[tool]\ntranslation_error_mm = true",
        b"[tool]\ntranslation_error_mm = '1'",
        b"tool = 3",
        b"seed = -1",
        b"seed = 1.5",
        b"ct = 1",
        b"[ct]\npath = 'ct.nii'",
        b"[ct]\npath = 'ct.nii'\npedicles = {}",
        b"[ct]\npath = 1\n[ct.pedicles.A]\nentry_mm = [1, 2, 3]\ntarget_mm = [1, 2, 4]",
        b"[ct]\npath = 'ct.nii'\n[ct.pedicles.A]\nentry_mm = [1, 2, 3]",
        b"[ct]\npath = 'ct.nii'\n[ct.pedicles.A]\nentry_mm = [1, 2, 3]\ntarget_mm = [1, 2]",
        b"[ct]\npath = 'ct.nii'\n[ct.pedicles.A]\nentry_mm = [1, 2, 3]\ntarget_mm = [1, 2, inf]",
        b"[ct]\npath = 'ct.nii'\n[ct.pedicles.A]\nentry_mm = [1, 2, 3]\ntarget_mm = [1, 2, 3]",
        b"[[",
        b"\xff",
    ],
)
def test_wrong_file_is_refused_in_one_line(text: bytes) -> None:
    with pytest.raises(ValueError, match="truth") as refused:
        read_truth(text)
    assert "\n" not in str(refused.value).strip()
