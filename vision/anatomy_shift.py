"""Whether the patient moved between two images (H34): the shift of the anatomy about the target, without the metal.

Both images are laid on one corrected grid about the target. The guide with its housing and the plate's balls are
masked: the first moves with the arm, the others never, and neither says anything of the patient. Robust weights leave
out what else does not move as the rest does (an instrument, a hand), which a correlation by FFT or ECC could not.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.alignment import target_in_source
from vision.common_grid import Similarity, similarity_between
from vision.corrected_image import CorrectedImage
from vision.devices import Guide
from vision.projection import View, project
from vision.registered import Registration
from vision.wire_model import sample_wires

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

_REACH_MM = 70.0  # about the target: its vertebra and the neighbours', three times the area that a guide covers
_STEP_MM = 0.6  # of the grid, at the target's depth
_SMOOTHED_MM = (3.2, 1.6, 0.8)  # coarse to fine; the first catches shifts of some 5 mm
_GROUND_MM = 9.0  # what changes more slowly is scatter and veiling glare, not bone
_HOUSING_RADIUS, _HOUSING_BEYOND_MM = 1.4, 8.0  # of the big ring; over both rings along the axis
_MARGIN_MM = 1.2  # around metal: blur, and the error of where it is
_NEIGHBOURS = 4.0 * np.pi * (_SMOOTHED_MM[-1] / _STEP_MM) ** 2  # pixels of one independent value, once smoothed
_ROUNDS = 12
_WHOLLY = 0.99  # of a pixel that is interpolated between clear ones
_SETTLED_MM = 0.005
_TUKEY = 4.685  # standard deviations beyond which a pixel has no weight
_GREATEST_SD_MM = 0.1  # a fifth of the procedure's limit across the beam
_LEAST_CORRELATION = 0.6  # of what was aligned; other anatomy, or none, correlates by chance alone


@dataclass(frozen=True, slots=True)
class AnatomyShift:
    """How far the anatomy went, at the target's depth, and what says whether it was anatomy that was measured."""

    across_mm: float
    along_mm: float
    across_sd_mm: float  # largest, from what is left between the aligned images
    correlation: float  # of the aligned images

    @property
    def is_measured(self) -> bool:
        """Enough was seen about the target, and it was the same in both images."""
        return self.across_sd_mm <= _GREATEST_SD_MM and self.correlation >= _LEAST_CORRELATION


@dataclass(frozen=True, slots=True, eq=False)
class Exposed:
    """An image with its registration."""

    image: CorrectedImage
    registration: Registration


@dataclass(frozen=True, slots=True, eq=False)
class _Field:
    """The grid about the target.

    Attributes
    ----------
    offsets_mm : Array
        (n, n, 2), from the target, at its depth.
    before_px : Array
        (n, n, 2), corrected pixels of the first image.
    distance_mm : float
        Of the target from the source, along z.
    """

    offsets_mm: Array
    before_px: Array
    distance_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class _Alignment:
    """Shift u, v (mm), relative growth, gain, offset; their covariance (5, 5), and the weighted correlation."""

    values: Array
    covariance: Array
    correlation: float


def compare_anatomy(before: Exposed, after: Exposed, pixel_corrected: Array, depth_mm: float) -> AnatomyShift:
    """The shift from the first image to the second.

    Parameters
    ----------
    before, after : Exposed
        Of one C-arm pose.
    pixel_corrected : Array
        (2,): the target in the first image.
    depth_mm : float
        Of the target below the big ring of the first image.

    Returns
    -------
    AnatomyShift
        To be believed only where `is_measured`.
    """
    field = _field(before.registration, pixel_corrected, depth_mm)
    onto_before = similarity_between(before.registration.distortion, after.registration.distortion)
    (first, clear), (second, also_clear) = _laid(before, field, None), _laid(after, field, onto_before)
    inside = clear & also_clear
    values = np.array([0.0, 0.0, 0.0, 1.0, 0.0])
    for smoothed_mm in _SMOOTHED_MM:
        bands = _band(first, inside, smoothed_mm), _band(second, inside, smoothed_mm)
        alignment = _aligned(bands, inside, field, values, grows=smoothed_mm == _SMOOTHED_MM[-1])
        values = alignment.values
    return AnatomyShift(
        across_mm=float(np.linalg.norm(values[:2])),
        along_mm=abs(float(values[2])) * field.distance_mm,
        across_sd_mm=float(np.sqrt(np.linalg.eigvalsh(alignment.covariance[:2, :2])[-1])),
        correlation=alignment.correlation,
    )


def _field(registration: Registration, pixel_corrected: Array, depth_mm: float) -> _Field:
    view = registration.view()
    distance_mm = float(target_in_source(view, pixel_corrected, registration.guide, depth_mm)[2])
    side = np.arange(-_REACH_MM, _REACH_MM + _STEP_MM / 2.0, _STEP_MM)
    offsets = np.stack(np.meshgrid(side, side), axis=-1)
    return _Field(offsets, pixel_corrected + offsets * (view.intrinsics.alpha_x_px / distance_mm), distance_mm)


def _laid(exposed: Exposed, field: _Field, onto_before: Similarity | None) -> tuple[Array32, NDArray[np.bool_]]:
    """Absorption on the grid, and where it is clear of all but anatomy: in the field, beside metal, in a round window.

    `onto_before` is None for the first image, whose grid it is.
    """
    points = field.before_px.reshape(-1, 2)
    points = points if onto_before is None else onto_before.inverted(points)
    raw = exposed.registration.distortion.raw_from_corrected(points).reshape(field.before_px.shape).astype(np.float32)
    seen, (u, v) = exposed.image.absorption, np.moveaxis(raw, -1, 0)
    picture: Array32 = cv2.remap(seen.values, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    inside = cv2.remap(seen.inside.astype(np.uint8), u, v, cv2.INTER_NEAREST, borderValue=(0,)) > 0
    round_window = np.linalg.norm(field.offsets_mm, axis=-1) <= _REACH_MM
    return picture, np.asarray(inside & ~_hidden(exposed, field, onto_before) & round_window)


def _hidden(exposed: Exposed, field: _Field, onto_before: Similarity | None) -> NDArray[np.bool_]:
    """Where the guide and metal are, with a margin."""
    hidden = np.zeros(field.before_px.shape[:2], dtype=np.uint8)
    view = exposed.registration.view()
    per_mm = view.intrinsics.alpha_x_px / field.distance_mm

    def on_grid(places: Array) -> NDArray[np.int32]:
        moved = places if onto_before is None else onto_before.applied(places)
        return np.asarray(np.rint((moved - field.before_px[0, 0]) / (per_mm * _STEP_MM)), dtype=np.int32)

    for places, radius_px in _metal(exposed, view):
        radius = round((radius_px / per_mm + _MARGIN_MM) / _STEP_MM)
        for u, v in on_grid(places).tolist():
            cv2.circle(hidden, (u, v), radius, (1,), cv2.FILLED)
    cv2.fillConvexPoly(hidden, cv2.convexHull(on_grid(_housing(exposed.registration.guide, view))), (1,))
    return hidden > 0


def _housing(guide: Guide, view: View) -> Array:
    """Corrected pixels (n, 2) of the rims of a tube that holds the guide's housing, which its file does not tell."""
    turn = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    radius = _HOUSING_RADIUS * guide.big_ring_radius_mm
    ends = (_HOUSING_BEYOND_MM, -guide.separation_mm - _HOUSING_BEYOND_MM)
    rims = [np.column_stack((radius * np.cos(turn), radius * np.sin(turn), np.full(64, z))) for z in ends]
    return project(view, np.vstack(rims))


def _metal(exposed: Exposed, view: View) -> list[tuple[Array, float]]:
    """Places (n, 2), corrected px, and radius (px): balls, wires, bead."""
    guide, per_mm = exposed.registration.guide, view.intrinsics.alpha_x_px / float(view.source_from_guide[2, 3])
    balls = exposed.image.balls_corrected
    metal = [(sample_wires(view, guide).points[::3], guide.wire_diameter_mm / 2.0 * per_mm)]
    if guide.bead is not None:
        metal.append((project(view, np.array([guide.bead.position_mm])), guide.bead.diameter_mm / 2.0 * per_mm))
    if len(balls):
        metal.append((balls[:, :2], exposed.image.ball_radius_px))
    return metal


def _band(picture: Array32, inside: NDArray[np.bool_], smoothed_mm: float) -> Array:
    """Structures between the smoothing and the ground, from clear pixels alone."""
    return np.asarray(_smooth(picture, inside, smoothed_mm) - _smooth(picture, inside, _GROUND_MM), dtype=np.float64)


def _smooth(picture: Array32, inside: NDArray[np.bool_], sd_mm: float) -> Array32:
    """Normalised convolution: what is hidden counts for nothing."""
    weight = inside.astype(np.float32)
    sd = sd_mm / _STEP_MM
    total = cv2.GaussianBlur(picture * weight, (0, 0), sd)
    smooth: Array32 = total / np.maximum(cv2.GaussianBlur(weight, (0, 0), sd), np.float32(1e-3))
    return smooth


def _aligned(
    bands: tuple[Array, Array], inside: NDArray[np.bool_], field: _Field, start: Array, *, grows: bool
) -> _Alignment:
    """Gauss-Newton on second(place + shift + growth place) = gain first(place) + offset, with Tukey's weights."""
    (first, second), values = bands, start
    slopes = np.gradient(second, _STEP_MM, axis=(1, 0))
    for _ in range(_ROUNDS):
        at = field.offsets_mm * (1.0 + values[2]) + values[:2]
        seen = inside & (_at(inside.astype(np.float64), at) > _WHOLLY)
        moved, along_u, along_v = (_at(picture, at)[seen] for picture in (second, *slopes))
        u, v = field.offsets_mm[seen].T
        growth = (u * along_u + v * along_v) * grows
        design = np.column_stack((along_u, along_v, growth, -first[seen], -np.ones(len(u))))
        residual = moved - values[3] * first[seen] - values[4]
        weight = _tukey(residual)
        information = design.T @ (design * weight[:, None])
        step = np.linalg.lstsq(information, -design.T @ (weight * residual), rcond=None)[0]
        values = values + step
        if np.abs(step[:2]).max() < _SETTLED_MM:
            break
    spread = _NEIGHBOURS * float((weight * residual**2).sum() / max(weight.sum(), 1.0))
    return _Alignment(
        values, np.asarray(np.linalg.pinv(information) * spread), _correlation(first[seen], moved, weight)
    )


def _at(picture: Array, places_mm: Array) -> Array:
    """A picture on the grid at places (n, n, 2), mm from the target."""
    pixel = ((places_mm + _REACH_MM) / _STEP_MM).astype(np.float32)
    return np.asarray(cv2.remap(picture, pixel[..., 0], pixel[..., 1], cv2.INTER_LINEAR, borderValue=(0.0,)))


def _tukey(residual: Array) -> Array:
    sd = 1.4826 * float(np.median(np.abs(residual))) if len(residual) else 1.0
    return np.asarray(np.clip(1.0 - (residual / (_TUKEY * max(sd, 1e-12))) ** 2, 0.0, None) ** 2)


def _correlation(first: Array, second: Array, weight: Array) -> float:
    """Weighted; 0 where either shows nothing."""
    one = first - np.average(first, weights=weight)
    two = second - np.average(second, weights=weight)
    norm = float(np.sqrt((weight * one**2).sum() * (weight * two**2).sum()))
    return float((weight * one * two).sum()) / norm if norm > 0.0 else 0.0
