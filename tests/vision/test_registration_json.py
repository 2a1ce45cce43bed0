import copy
import json
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import date
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision.devices import CArm
from vision.distortion import DistortionMap
from vision.projection import View
from vision.registered import FittedDimensions, PixelSpace, Registration
from vision.registration_json import from_json, to_json
from vision.targeting import Targeting, target

HOSTILE = [
    None,
    True,
    -1,
    0,
    1e300,
    -1e300,
    10**400,
    math.nan,
    math.inf,
    "",
    "x" * 1000,
    "nan",
    [],
    {},
    [[]],
    [1, 2, 3],
]


@pytest.fixture(scope="module")
def registration(vector_view: View, make_registration: Callable[..., Registration]) -> Registration:
    """A registration with a real distortion map."""
    return replace(make_registration(vector_view), distortion=DistortionMap.identity(1024, 1024, 360.0 / 1024.0))


@pytest.fixture(scope="module")
def printed(registration: Registration) -> dict[str, Any]:
    """The registration as it was printed and read."""
    parsed = json.loads(json.dumps(to_json(registration, "image.png"), allow_nan=False))
    assert isinstance(parsed, dict)
    return parsed


def paths(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Where every value in nested tables and lists stands."""
    items: Any = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield (*path, key)
        yield from paths(item, (*path, key))


def with_value(data: dict[str, Any], path: tuple[Any, ...], value: Any) -> dict[str, Any]:
    """A copy with one value replaced."""
    changed = copy.deepcopy(data)
    inner: Any = changed
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    return changed


def without(data: dict[str, Any], *path: str) -> dict[str, Any]:
    """A copy with one key left out."""
    changed = copy.deepcopy(data)
    inner: Any = changed
    for key in path[:-1]:
        inner = inner[key]
    del inner[path[-1]]
    return changed


def test_output_has_the_keys_of_the_contract(printed: dict[str, Any]) -> None:
    assert {
        "status", "image", "method", "intrinsics_px", "source_from_guide", "distortion", "fiducials_px", "rings_px",
        "residual_rms_px", "predicted_error_95", "elapsed_ms",
    } <= set(printed)  # fmt: skip
    assert printed["image"] == {"path": "image.png", "sha256": "ab" * 32, "rows": 1024, "columns": 1024}
    assert len(printed["fiducials_px"]) == 12
    assert printed["rings_px"]["small"]["centre"] == pytest.approx([549.4267, 492.1907], abs=5e-5)
    assert printed["predicted_error_95"]["angle_deg"] == pytest.approx(math.degrees(1e-3))


def test_round_trip_keeps_every_number(registration: Registration, printed: dict[str, Any]) -> None:
    back = from_json(printed)
    assert to_json(back, "image.png") == printed
    assert (back.guide, back.carm, back.image) == (registration.guide, registration.carm, registration.image)
    assert back.covariance.tolist() == registration.covariance.tolist()


def test_round_trip_keeps_the_fitted_dimensions_and_refuses_impossible_ones(registration: Registration) -> None:
    covariance = np.hstack((np.zeros((3, 10)), np.diag([4e-4, 4e-4, 9e-4])))
    whole = replace(registration, dimensions=FittedDimensions(np.array([20.01, 29.98, 60.02]), covariance))
    printed = json.loads(json.dumps(to_json(whole)))
    back = from_json(printed).dimensions
    assert back is not None
    assert back.values_mm.tolist() == [20.01, 29.98, 60.02]
    assert back.covariance.tolist() == covariance.tolist()
    assert from_json(with_value(printed, ("dimensions",), None)).dimensions is None
    with pytest.raises(ValueError, match="covariance"):
        from_json(with_value(printed, ("dimensions", "covariance", 0, 10), -1.0))


def test_round_trip_of_a_guide_without_bead_and_of_devices_that_expire(
    registration: Registration, intensifier: CArm
) -> None:
    guide = replace(registration.guide, bead=None, expires=date(2027, 12, 31))
    other = replace(registration, guide=guide, carm=intensifier, bead_px=None)
    back = from_json(json.loads(json.dumps(to_json(other))))
    assert (back.guide, back.carm, back.bead_px) == (guide, intensifier, None)


@given(st.tuples(st.floats(100.0, 900.0), st.floats(100.0, 900.0)))
def test_target_is_the_same_from_the_json_alone(
    registration: Registration, printed: dict[str, Any], pixel: tuple[float, float]
) -> None:
    before = target(registration, pixel, PixelSpace.RAW)
    after = target(from_json(printed), pixel, PixelSpace.RAW)
    assert isinstance(before, Targeting)
    assert isinstance(after, Targeting)
    assert after.guide_from_goal.tolist() == before.guide_from_goal.tolist()
    assert after.predicted_error_95 == before.predicted_error_95


def test_unknown_keys_are_ignored(printed: dict[str, Any]) -> None:
    grown = with_value(with_value(printed, ("later",), {"a": 1}), ("guide", "serial_number"), "7")
    assert to_json(from_json(grown), "image.png") == printed


@pytest.mark.parametrize("data", [None, 3, [], "registered", {}, {"status": "refused"}, {"status": "registered"}])
def test_what_is_no_registration_is_refused(data: Any) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]+$"):
        from_json(data)


def test_every_missing_key_is_refused(printed: dict[str, Any]) -> None:
    names = [path for path in paths(printed) if all(isinstance(key, str) for key in path)]
    for path in names:
        if path != ("image", "path"):
            with pytest.raises(ValueError, match=r"^[^\n]+$"):
                from_json(without(printed, *path))


def read_or_complaint(data: dict[str, Any]) -> Registration | str:
    """The registration, or what was said against it."""
    try:
        return from_json(data)
    except ValueError as error:
        return str(error)


def test_hostile_values_are_refused_with_one_line_or_harmless(printed: dict[str, Any]) -> None:
    for path in paths(printed):
        for value in HOSTILE:
            read = read_or_complaint(with_value(printed, path, value))
            if isinstance(read, str):
                assert len(read.splitlines()) == 1, path
                continue
            result = target(read, (600.0, 480.0), PixelSpace.RAW)
            if isinstance(result, Targeting):
                assert np.isfinite(result.guide_from_goal).all(), path
                assert math.isfinite(result.predicted_error_95.angle_rad), path


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("method",), "magic"),
        (("image", "sha256"), "AB" * 32),
        (("image", "rows"), 0),
        (("source_from_guide", 0, 0), -1.0),  # a reflection
        (("source_from_guide", 0, 0), 1.001),  # a stretch
        (("source_from_guide", 3, 0), 1.0),
        (("source_from_guide", 2, 3), 0.75),  # metres
        (("source_from_guide", 2, 3), -750.0),
        (("intrinsics_px", "alpha_x"), 2.8),
        (("rings_px", "big", "semi_axes"), [10.0, 20.0]),
        (("covariance", 0, 0), -1.0),
        (("covariance", 0, 1), 1e9),
        (("covariance", 0, 0), math.nan),
        (("guide", "separation_mm"), 0.06),
        (("guide", "tolerance", "radius_sd_mm"), 20.0),
        (("carm", "detector"), "film"),
        (("carm", "source_to_image_mm"), 1.0),
        (("guide", "expires"), "soon"),
        (("guide", "expires"), 2027),
        (("residual_rms_px",), -0.1),
        (("predicted_error_95", "angle_deg"), -1.0),
    ],
)
def test_implausible_values_are_refused(printed: dict[str, Any], path: tuple[Any, ...], value: Any) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]+$"):
        from_json(with_value(printed, path, value))
