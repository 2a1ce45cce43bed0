"""Many ellipses at once, as rows of centre u, v and the A, B, C of A x^2 + B x y + C y^2 = 1 about it, px."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LEAST_DETERMINANT = 1.0  # px^6, of the squares of three points: below it they lie on one line through the centre


def semi_axes(forms: Array) -> tuple[Array, Array]:
    """Semi-axes (h,), major and minor; not finite where it is no ellipse."""
    _, _, a, b, c = forms.T
    mean, spread = (a + c) / 2.0, np.sqrt((a - c) ** 2 / 4.0 + b**2 / 4.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return 1.0 / np.sqrt(mean - spread), 1.0 / np.sqrt(mean + spread)


def gradients(forms: Array, offsets: Array) -> Array:
    """Gradients (h, k, 2) of the forms (h, 5) at offsets (h, k, 2) from their centres."""
    a, b, c = (column[:, None] for column in forms[:, 2:].T)
    x, y = offsets[:, :, 0], offsets[:, :, 1]
    return np.stack((2.0 * a * x + b * y, b * x + 2.0 * c * y), axis=2)


def around(forms: Array, samples: int) -> tuple[Array, Array]:
    """Points (h, samples, 2) at even angles about each centre, as offsets from it, and the unit normals there."""
    angle = np.linspace(0.0, 2.0 * np.pi, samples, endpoint=False)
    x, y = np.cos(angle), np.sin(angle)
    a, b, c = (column[:, None] for column in forms[:, 2:].T)
    radius = 1.0 / np.sqrt(a * x * x + b * x * y + c * y * y)
    normals = np.stack((2.0 * a * x + b * y, b * x + 2.0 * c * y), axis=2)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    return radius[:, :, None] * np.stack((x, y), axis=1), normals


def centres(p: Array, n: Array) -> Array:
    """Centres (h, 2) from three points (h, 3, 2) with normals (h, 3, 2); not finite where tangents are parallel.

    The line from where two tangents meet through the middle of their points passes the centre.
    """
    lines = []
    for first, second in ((0, 1), (1, 2)):
        a, b = n[:, first], n[:, second]
        meet = _crossing(a, b, (a * p[:, first]).sum(axis=1), (b * p[:, second]).sum(axis=1))
        middle = (p[:, first] + p[:, second]) / 2.0
        across = np.column_stack((meet[:, 1] - middle[:, 1], middle[:, 0] - meet[:, 0]))
        with np.errstate(invalid="ignore", over="ignore"):
            lines.append((across, (across * middle).sum(axis=1)))
    (a, right_a), (b, right_b) = lines
    return _crossing(a, b, right_a, right_b)


def _crossing(a: Array, b: Array, right_a: Array, right_b: Array) -> Array:
    """Where the lines a . x = right_a and b . x = right_b meet: (h, 2)."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        determinant = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        u = (right_a * b[:, 1] - right_b * a[:, 1]) / determinant
        v = (a[:, 0] * right_b - b[:, 0] * right_a) / determinant
    return np.column_stack((u, v))


def form_from(centre: Array, p: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Forms (k, 5) about centres (h, 2) through three points (h, 3, 2), and for which of the h there is one."""
    with np.errstate(invalid="ignore", over="ignore"):
        x, y = np.moveaxis(p - centre[:, None, :], 2, 0)
        squares = np.stack((x * x, x * y, y * y), axis=2)
        # Cramer's rule: the determinant of each solution's column replaced by ones
        minors = np.cross(squares[:, [1, 2, 0]], squares[:, [2, 0, 1]])
        determinant = (squares[:, 0] * minors[:, 0]).sum(axis=1)
    solvable = np.isfinite(determinant) & (np.abs(determinant) > _LEAST_DETERMINANT)
    abc = minors[solvable].sum(axis=1) / determinant[solvable, None]
    return np.column_stack((centre[solvable], abc)), solvable


def fitted(forms: Array, points: Array, weight: Array) -> Array:
    """Ellipses (h, 5) of least algebraic distance to points (h, k, 2) of weight (h, k), close to the forms given.

    About the old centre and in units of its size the square of a pixel is no smaller than the constant term.
    """
    size = semi_axes(forms)[0][:, None]
    x, y = np.moveaxis((points - forms[:, None, :2]) / size[:, :, None], 2, 0)
    design = np.stack((x * x, x * y, y * y, x, y), axis=1) * weight[:, None, :]
    normal = design @ design.swapaxes(1, 2) + 1e-9 * np.eye(5)
    a, b, c, d, e = np.linalg.solve(normal, (design @ weight[:, :, None]))[:, :, 0].T
    with np.errstate(divide="ignore", invalid="ignore"):
        determinant = 4.0 * a * c - b * b
        shift_x, shift_y = (b * e - 2.0 * c * d) / determinant, (b * d - 2.0 * a * e) / determinant
        constant = 1.0 + a * shift_x**2 + b * shift_x * shift_y + c * shift_y**2
        moved = forms[:, :2] + size * np.column_stack((shift_x, shift_y))
        return np.column_stack((moved, np.column_stack((a, b, c)) / (constant[:, None] * size**2)))
