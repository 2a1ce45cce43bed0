"""The optical depth of a body by quadratic forms in the image: the same solids and textures as `anatomy`, sooner.

With a point of the image as p = (x, y, 1), x and y in focal lengths, a ray enters an ellipsoid where a quadratic in the
ray's length vanishes whose coefficients are quadratic forms of p; so a chord costs two of them and a root.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from simulator.carm.anatomy import STEP_PX, Body
from simulator.carm.camera import Camera
from simulator.carm.solids import Shape, Solid
from simulator.carm.texture import Texture, tile

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

_LEAST = np.float32(1e-9)
_MARGIN_PX = 40.0  # by which distortion may move an outline inside the round field
_STRETCH = {Shape.ELLIPSOID: 1.0, Shape.CYLINDER: 2.0**0.5, Shape.BOX: 3.0**0.5}  # of the ellipsoid that holds a solid


def quick_body_depths(body: Body, camera: Camera, source_from_patient: Array, ideal_px: Array) -> Array32:
    """Optical depth (rows, columns), as `Body.depths` has it."""
    focal_px = camera.source_to_image_mm / camera.pixel_mm
    x = ((ideal_px[..., 0] - camera.principal_u_px) / focal_px).astype(np.float32)
    y = ((ideal_px[..., 1] - camera.principal_v_px) / focal_px).astype(np.float32)
    bone, soft = (_sum(solids, camera, source_from_patient, x, y) for solids in (body.bone, body.soft))
    steps = _linear(source_from_patient[:3, :3].T, x, y)
    origin = -source_from_patient[:3, :3].T @ source_from_patient[:3, 3]
    for texture, share in body.bone_textures:
        bone *= np.float32(1.0) + np.float32(share) * _texture(texture, origin, steps)
    for texture, depth in body.soft_textures:
        soft += np.float32(depth) * _texture(texture, origin, steps)
    return np.asarray(bone + soft, dtype=np.float32)


def _linear(matrix: Array, x: Array32, y: Array32) -> tuple[Array32, ...]:
    """Each row of a matrix (k, 3) times (x, y, 1)."""
    return tuple(np.float32(row[0]) * x + (np.float32(row[1]) * y + np.float32(row[2])) for row in matrix)


def _sum(solids: tuple[Solid, ...], camera: Camera, source_from_patient: Array, x: Array32, y: Array32) -> Array32:
    total = np.zeros(x.shape, dtype=np.float32)
    for solid in solids:
        window = _window(solid, camera, source_from_patient, x.shape)
        total[window] += np.float32(solid.per_mm) * _chord(solid, source_from_patient, x[window], y[window])
    return np.asarray(total * np.sqrt(x * x + y * y + np.float32(1.0)))


def _window(solid: Solid, camera: Camera, source_from_patient: Array, shape: tuple[int, ...]) -> tuple[slice, slice]:
    """The part of the coarse grid that can see a solid, by the outline of an ellipsoid around it; maybe empty."""
    rotation = source_from_patient[:3, :3]
    centre = rotation @ np.array(solid.centre_mm) + source_from_patient[:3, 3]
    axes = rotation @ solid.patient_from_solid * np.array(solid.half_mm) * _STRETCH[solid.shape]
    # the lines that touch an outline make its dual conic, which for a quadric seen from the origin is this
    dual = axes @ axes.T - np.outer(centre, centre)
    if dual[2, 2] >= 0.0:
        return slice(0, shape[0]), slice(0, shape[1])
    middle = dual[:2, 2] / dual[2, 2]
    half = np.sqrt(np.maximum(middle**2 - np.diag(dual)[:2] / dual[2, 2], 0.0))
    focal_px = camera.source_to_image_mm / camera.pixel_mm
    middle_px = (camera.principal_u_px, camera.principal_v_px) + focal_px * middle
    reach_px = focal_px * half + _MARGIN_PX
    left, top = (middle_px - reach_px) / STEP_PX
    right, bottom = (middle_px + reach_px) / STEP_PX + 1.0
    return _span(top, bottom, shape[0]), _span(left, right, shape[1])


def _span(first: float, last: float, length: int) -> slice:
    return slice(min(max(0, int(first)), length), min(max(0, int(last)), length))


def _chord(solid: Solid, source_from_patient: Array, x: Array32, y: Array32) -> Array32:
    """Length (rows, columns) inside a solid, in lengths of (x, y, 1), mm."""
    to_unit = (solid.patient_from_solid / np.array(solid.half_mm)).T
    rotation, shift = source_from_patient[:3, :3], source_from_patient[:3, 3]
    start = to_unit @ (-rotation.T @ shift - np.array(solid.centre_mm))
    steps = to_unit @ rotation.T
    match solid.shape:
        case Shape.ELLIPSOID:
            _, half = _round(start, steps, x, y)
            return np.float32(2.0) * half
        case Shape.CYLINDER:
            middle, half = _round(start[:2], steps[:2], x, y)
            entry, leave = _slab(start[2], steps[2], x, y, middle - half, middle + half)
        case Shape.BOX:
            leave = np.full(x.shape, np.inf, dtype=np.float32)
            entry = -leave
            for axis in range(3):
                entry, leave = _slab(start[axis], steps[axis], x, y, entry, leave)
    return np.asarray(np.maximum(leave - entry, np.float32(0.0)))


def _round(start: Array, steps: Array, x: Array32, y: Array32) -> tuple[Array32, Array32]:
    """Middle and half of the chord of the unit ball, in lengths of (x, y, 1); half is 0 where it is missed."""
    a = _quadratic(steps.T @ steps, x, y)
    rest = _quadratic(steps.T @ (np.outer(start, start) - (start @ start - 1.0) * np.eye(len(start))) @ steps, x, y)
    (b,) = _linear((start @ steps)[None], x, y)
    along = a < _LEAST  # a cylinder's axis, where all of it is rounding: in it from end to end, or beside it
    a[along], rest[along] = _LEAST, _LEAST * np.float32(1.0 - start @ start)
    return -b / a, np.asarray(np.sqrt(np.maximum(rest, np.float32(0.0))) / a, dtype=np.float32)


def _quadratic(form: Array, x: Array32, y: Array32) -> Array32:
    """Value of the symmetric form (3, 3) at (x, y, 1)."""
    (xx, xy, x1), (_, yy, y1), (_, _, one) = (form + form.T - np.diag(np.diag(form))).astype(np.float32)
    value: Array32 = xx * x
    rest: Array32 = yy * y
    # in place: these arrays are most of what a body costs
    value += xy * y
    value += x1
    value *= x
    rest += y1
    rest *= y
    rest += one
    value += rest
    return value


def _slab(start: float, step: Array, x: Array32, y: Array32, entry: Array32, leave: Array32) -> tuple[Array32, Array32]:
    """What remains of an interval between the planes -1 and 1 of one coordinate."""
    (along,) = _linear(step[None], x, y)
    along = np.where(np.abs(along) < _LEAST, _LEAST, along)
    first, second = np.float32(-1.0 - start) / along, np.float32(1.0 - start) / along
    return np.maximum(entry, np.minimum(first, second)), np.minimum(leave, np.maximum(first, second))


def _texture(texture: Texture, origin: Array, steps: tuple[Array32, ...]) -> Array32:
    """Value (rows, columns) where rays cross the texture's plane, patient frame."""
    along = np.float32((texture.plane_mm - origin[1]) / texture.pixel_mm) / steps[1]
    across = along * steps[0] + np.float32(origin[0] / texture.pixel_mm)
    down = along * steps[2] + np.float32(origin[2] / texture.pixel_mm)
    period = tile(texture)
    for places in (across, down):
        places -= period.shape[0] * np.floor(places.min() / period.shape[0])
    # most places lie inside two periods, and inside is quicker than wrapped
    sampled = cv2.remap(np.tile(period, (2, 2)), across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
    return np.asarray(sampled, dtype=np.float32)
