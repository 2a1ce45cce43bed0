"""The beam of the C-arm as arm and image together put it into the arm's base."""

import numpy as np

from robot.frames import Transform, check_rigid


def beam_tilt(base_from_guide: Transform, source_from_guide: Transform) -> float:
    """Angle of the beam against the vertical, rad in [0, pi/2]; the base is mounted upright.

    Parameters
    ----------
    base_from_guide : (4, 4), mm
        As the controller reported it during the exposure.
    source_from_guide : (4, 4), mm
        As the image was registered; the beam is the source's z.

    Raises
    ------
    ValueError
        If one of the two is not a rigid transform.
    """
    base_from_source = check_rigid(base_from_guide)[:3, :3] @ check_rigid(source_from_guide)[:3, :3].T
    x, y, z = base_from_source[:, 2]
    return float(np.arctan2(np.hypot(x, y), abs(z)))
