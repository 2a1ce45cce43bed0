"""The tests of the priors on linear models, where every answer is known."""

import numpy as np
import pytest
from numpy.typing import NDArray

from vision.strain import Strain, strain

Array = NDArray[np.float64]

NAMES = ("first", "second", "third")
PRIOR_SD = np.array([0.5, 2.0, 1.0])


def solved(design: Array, measured: Array, priors: Array) -> tuple[Array, Array]:
    """Solution (4,) and inverse information (4, 4) of unit-noise data and priors at 0 of the first three parameters."""
    inverse = np.linalg.inv(design.T @ design + priors.T @ priors)
    return inverse @ (design.T @ measured), inverse


def strained(design: Array, measured: Array) -> tuple[Strain, Array]:
    """The tests and the solution."""
    rows = np.hstack((np.diag(1.0 / PRIOR_SD), np.zeros((3, 1))))
    solution, inverse = solved(design, measured, rows)
    return strain(dict(zip(NAMES, rows @ solution, strict=True)), rows, inverse), solution


def test_deviations_have_unit_spread_and_their_chi_square_its_degrees_of_freedom() -> None:
    rng = np.random.default_rng(1)
    design = rng.normal(0.0, 0.4, (9, 4))
    tests = []
    for _ in range(2000):
        truth = np.append(rng.normal(0.0, PRIOR_SD), rng.normal(0.0, 100.0))
        tests.append(strained(design, design @ truth + rng.normal(size=9))[0])
    spread = np.std([test.deviations for test in tests], axis=0)
    np.testing.assert_allclose(spread, 1.0, atol=0.06)  # 2000 draws know it to 0.016
    assert {test.freedom for test in tests} == {3}
    assert np.mean([test.joint for test in tests]) == pytest.approx(3.0, abs=0.25)


def test_freed_step_leads_to_the_solution_without_that_prior() -> None:
    rng = np.random.default_rng(2)
    design, measured = rng.normal(size=(9, 4)), rng.normal(0.0, 5.0, 9)
    tests, solution = strained(design, measured)
    for dropped, step in enumerate(tests.freed_steps):
        kept = np.delete(np.hstack((np.diag(1.0 / PRIOR_SD), np.zeros((3, 1)))), dropped, axis=0)
        np.testing.assert_allclose(solution + step, solved(design, measured, kept)[0], atol=1e-9)


def test_a_quantity_that_the_image_hardly_sees_is_tested_by_its_own_small_spread() -> None:
    faint = np.diag([1.0, 1.0, 0.05, 1.0])  # the third is measured twenty times worse than its prior knows it
    tests, solution = strained(faint, np.array([0.0, 0.0, 0.05 * 100.0, 0.0]))
    assert abs(solution[2]) < 0.3  # of its prior's standard deviations, though it is 100 of them off
    assert tests.deviations[2] == pytest.approx(5.0, rel=0.01)


def test_what_the_image_does_not_see_is_not_tested() -> None:
    blind = np.diag([1.0, 1.0, 0.0, 1.0])
    tests, _ = strained(blind, np.array([1.0, 1.0, 0.0, 1.0]))
    assert tests.deviations[2] == 0.0
    assert np.all(tests.freed_steps[2] == 0.0)
    assert tests.freedom == 2
