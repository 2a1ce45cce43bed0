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


def dot(a: Array, b: Array) -> Array:
    """Scalar products (...) of plane vectors (2, ...); NumPy's own sum over so short an axis takes longer."""
    return np.asarray(a[0] * b[0] + a[1] * b[1])


def length(a: Array) -> Array:
    """Lengths (...) of plane vectors (2, ...); NumPy's own `hypot` takes five times as long."""
    return np.asarray(np.sqrt(dot(a, a)))


def gradients(forms: Array, offsets: Array) -> Array:
    """Gradients (2, k, h) of the forms (5, h) at offsets (2, k, h) from their centres."""
    a, b, c = forms[2:]
    x, y = offsets
    return np.stack((2.0 * a * x + b * y, b * x + 2.0 * c * y))


def around(forms: Array, samples: int) -> tuple[Array, Array]:
    """Points (2, h, samples) at even angles about each centre, as offsets from it, and the unit normals there."""
    angle = np.linspace(0.0, 2.0 * np.pi, samples, endpoint=False)
    x, y = np.cos(angle), np.sin(angle)
    a, b, c = (column[:, None] for column in forms[:, 2:].T)
    slope = np.stack((2.0 * a * x + b * y, b * x + 2.0 * c * y))
    radius = np.sqrt(2.0 / (slope[0] * x + slope[1] * y))
    return np.stack((radius * x, radius * y)), slope / length(slope)


def centres(p: Array, n: Array) -> Array:
    """Centres (2, h) from three points (2, 3, h) with normals (2, 3, h); not finite where tangents are parallel.

    The line from where two tangents meet through the middle of their points passes the centre.
    """
    lines = []
    for first, second in ((0, 1), (1, 2)):
        a, b = n[:, first], n[:, second]
        meet = _crossing(a, b, dot(a, p[:, first]), dot(b, p[:, second]))
        middle = (p[:, first] + p[:, second]) / 2.0
        across = np.stack((meet[1] - middle[1], middle[0] - meet[0]))
        with np.errstate(invalid="ignore", over="ignore"):
            lines.append((across, dot(across, middle)))
    (a, right_a), (b, right_b) = lines
    return _crossing(a, b, right_a, right_b)


def _crossing(a: Array, b: Array, right_a: Array, right_b: Array) -> Array:
    """Where the lines a . x = right_a and b . x = right_b meet: (2, h)."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        determinant = a[0] * b[1] - a[1] * b[0]
        return np.asarray(np.stack((right_a * b[1] - right_b * a[1], a[0] * right_b - b[0] * right_a)) / determinant)


def form_from(centre: Array, p: Array) -> Array:
    """Forms (5, h) about centres (2, h) through three points (2, 3, h); not finite where there is none."""
    with np.errstate(invalid="ignore", over="ignore"):
        x, y = p - centre[:, None]
        squares = np.stack((x * x, x * y, y * y))
        # Cramer's rule: the determinant of each solution's column replaced by ones
        minors = [_cross(squares[:, second], squares[:, third]) for second, third in ((1, 2), (2, 0), (0, 1))]
        determinant = dot(squares[:2, 0], minors[0][:2]) + squares[2, 0] * minors[0][2]
        determinant = np.where(np.abs(determinant) > _LEAST_DETERMINANT, determinant, np.nan)
        return np.concatenate((centre, (minors[0] + minors[1] + minors[2]) / determinant))


def _cross(a: Array, b: Array) -> Array:
    """Vector products (3, h) of vectors (3, h)."""
    return np.stack((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


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
