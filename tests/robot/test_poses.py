import numpy as np
import pytest

from robot.frames import goal_in_base
from robot.poses import pose_of, retreat


def test_a_pose_turns_about_its_rotation_vector_and_keeps_its_translation() -> None:
    pose = pose_of(np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.0, np.pi / 2]))
    np.testing.assert_allclose(pose @ [1.0, 0.0, 0.0, 1.0], [1.0, 3.0, 3.0, 1.0], atol=1e-12)


def test_a_retreat_leads_along_the_guides_own_axis_against_the_insertion() -> None:
    tilted = pose_of(np.array([100.0, 0.0, 50.0]), np.array([np.pi, 0.0, 0.0]))
    goal = goal_in_base(tilted, retreat(30.0))
    np.testing.assert_allclose(goal[:3, 3], [100.0, 0.0, 20.0], atol=1e-9)
    np.testing.assert_allclose(goal[:3, :3], tilted[:3, :3], atol=1e-12)


def test_a_pose_that_is_no_number_is_refused() -> None:
    with pytest.raises(ValueError):
        pose_of(np.array([np.nan, 0.0, 0.0]), np.zeros(3))
