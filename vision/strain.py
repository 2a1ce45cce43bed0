"""How an image strains against the device files, and what the solution owes to each of their words.

A prior's pull is no test by itself: where an image says little of a quantity, its pull stays near zero however wrong
the file is. With p = R (x - mu) the pulls in their priors' standard deviations and H the information of image and
priors together, right files give p the covariance V = 1 - R H^-1 R^T; p_i / sqrt(V_ii) is the sharpest test of one
quantity alone. With prior i dropped the solution moves by H^-1 r_i p_i / (1 - r_i^T H^-1 r_i): what trust in that one
word is worth.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LEAST_SEEN = 1e-6  # of a prior's variance: an image that knows a quantity a thousand times worse says nothing of it
_LEAST_SEEN_TOGETHER = 1e-3  # the same for a mixture of quantities, whose pull must stand out from what is not linear


@dataclass(frozen=True, slots=True, eq=False)
class Strain:
    """The tests of the priors.

    Attributes
    ----------
    names : tuple of str
        Of the k priors.
    deviations : Array
        (k,): each pull over the standard deviation that it has with right files; 0 where the image says nothing.
    joint, freedom
        Chi-square of all pulls together and its degrees of freedom.
    freed_steps : Array
        (k, n): how the n parameters move when one prior is dropped.
    """

    names: tuple[str, ...]
    deviations: Array
    joint: float
    freedom: int
    freed_steps: Array


def strain(pulls_sd: dict[str, float], rows: Array, inverse: Array) -> Strain:
    """Test the priors of a solution.

    Parameters
    ----------
    pulls_sd : dict[str, float]
        k pulls, in the priors' standard deviations.
    rows : Array
        (k, n), derivative of the pulls by the parameters.
    inverse : Array
        (n, n), inverse of the information of image and priors.
    """
    pulls, gain = np.array(list(pulls_sd.values())), inverse @ rows.T
    spread = np.eye(len(pulls)) - rows @ gain
    seen = np.diag(spread) > _LEAST_SEEN
    deviations = np.where(seen, pulls / np.sqrt(np.maximum(np.diag(spread), _LEAST_SEEN)), 0.0)
    steps = np.where(seen, pulls / np.maximum(np.diag(spread), _LEAST_SEEN), 0.0)[:, None] * gain.T
    variances, directions = np.linalg.eigh(spread)
    told = variances > _LEAST_SEEN_TOGETHER
    joint = float((((directions.T @ pulls) ** 2)[told] / variances[told]).sum())
    return Strain(tuple(pulls_sd), deviations, joint, int(told.sum()), steps)
