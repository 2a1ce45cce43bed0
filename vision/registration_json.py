"""A registration as JSON, exactly as the command-line contract prints it, and back.

The object is complete: `target` works from it without image or device files, so nothing in it is believed unseen.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision.conics import Ellipse, RingPair
from vision.device_json import carm_from_json, carm_to_json, guide_from_json, guide_to_json, sha256_from_json
from vision.distortion import DistortionMap
from vision.projection import Intrinsics, fiducials_in_guide
from vision.registered import (
    FittedDimensions,
    ImageIdentity,
    Method,
    PredictedError,
    Registration,
    joint_covariance,
)
from vision.result_json import predicted_error_to_json
from vision.table import Table

Array = NDArray[np.float64]

_GREATEST_SIDE_PX = 65536
_LEAST_ALPHA_PX, _GREATEST_ALPHA_PX = 100.0, 100_000.0
_LEAST_DISTANCE_MM, _GREATEST_DISTANCE_MM = 100.0, 2000.0  # small ring from the source
_ORTHONORMAL_WITHIN = 1e-6  # of a rotation matrix's columns
_SYMMETRIC_WITHIN = 1e-6  # of a covariance, relative to its variances


def to_json(registration: Registration, path: str | None = None) -> dict[str, Any]:
    """The JSON object of `coaxial register`; `path` is where the image came from, if from a file."""
    image, intrinsics, predicted = registration.image, registration.intrinsics, registration.predicted_error_95
    return {
        "status": "registered",
        "image": {"path": path, "sha256": image.sha256, "rows": image.rows, "columns": image.columns},
        "method": registration.method.value,
        "intrinsics_px": {
            "alpha_x": intrinsics.alpha_x_px,
            "alpha_y": intrinsics.alpha_y_px,
            "u0": intrinsics.u0_px,
            "v0": intrinsics.v0_px,
        },
        "source_from_guide": registration.source_from_guide.tolist(),
        "distortion": registration.distortion.to_json(),
        "fiducials_px": {name: point.tolist() for name, point in registration.fiducials_px.items()},
        "bead_px": None if registration.bead_px is None else registration.bead_px.tolist(),
        "rings_px": {
            "small": _ellipse_to_json(registration.rings.small),
            "big": _ellipse_to_json(registration.rings.big),
        },
        "residual_rms_px": registration.residual_rms_px,
        "covariance": registration.covariance.tolist(),
        "dimensions": _dimensions_to_json(registration.dimensions),
        "guide": guide_to_json(registration.guide),
        "carm": carm_to_json(registration.carm),
        "predicted_error_95": predicted_error_to_json(predicted),
        "elapsed_ms": registration.elapsed_ms,
    }


def _ellipse_to_json(ellipse: Ellipse) -> dict[str, Any]:
    return {
        "centre": list(ellipse.centre_px),
        "semi_axes": list(ellipse.semi_axes_px),
        "angle_rad": ellipse.angle_rad,
    }


def _dimensions_to_json(dimensions: FittedDimensions | None) -> dict[str, Any] | None:
    if dimensions is None:
        return None
    return {"values_mm": dimensions.values_mm.tolist(), "covariance": dimensions.covariance.tolist()}


def from_json(data: Any) -> Registration:
    """The registration in a JSON object; unknown keys are ignored.

    Raises
    ------
    ValueError
        One line naming what is missing or implausible.
    """
    top = Table.of(data, "registration")
    if top.get("status") != "registered":
        raise ValueError("registration: status is not registered")
    guide = guide_from_json(top.table("guide"))
    fiducials, rings = top.table("fiducials_px"), top.table("rings_px")
    return Registration(
        image=_image(top.table("image")),
        method=_method(top),
        guide=guide,
        carm=carm_from_json(top.table("carm")),
        intrinsics=_intrinsics(top.table("intrinsics_px")),
        source_from_guide=_pose(top),
        distortion=DistortionMap.from_json(dict(top.table("distortion").values)),
        fiducials_px={name: fiducials.numbers(name, 2) for name in fiducials_in_guide(guide)},
        bead_px=None if top.get("bead_px") is None else top.numbers("bead_px", 2),
        rings=RingPair(small=_ellipse(rings.table("small")), big=_ellipse(rings.table("big"))),
        residual_rms_px=_positive(top, "residual_rms_px"),
        covariance=_covariance(top),
        predicted_error_95=_predicted_error(top.table("predicted_error_95")),
        elapsed_ms=_positive(top, "elapsed_ms"),
        dimensions=_dimensions(top),
    )


def _image(table: Table) -> ImageIdentity:
    return ImageIdentity(
        sha256=sha256_from_json(table),
        rows=table.integer("rows", 1, _GREATEST_SIDE_PX),
        columns=table.integer("columns", 1, _GREATEST_SIDE_PX),
    )


def _method(top: Table) -> Method:
    method = top.text("method")
    if method not in tuple(Method):
        raise ValueError(f"{top.where}: method must be one of {', '.join(Method)}")
    return Method(method)


def _intrinsics(table: Table) -> Intrinsics:
    for key in ("alpha_x", "alpha_y"):
        if not _LEAST_ALPHA_PX <= table.number(key) <= _GREATEST_ALPHA_PX:
            raise ValueError(f"{table.where}: {key} = {table.number(key):g} px is implausible")
    return Intrinsics(table.number("alpha_x"), table.number("alpha_y"), table.number("u0"), table.number("v0"))


def _pose(top: Table) -> Array:
    pose = top.numbers("source_from_guide", 4, 4)
    rotation, distance_mm = pose[:3, :3], float(np.linalg.norm(pose[:3, 3]))
    is_rotation = np.abs(rotation.T @ rotation - np.eye(3)).max() <= _ORTHONORMAL_WITHIN and np.linalg.det(rotation) > 0
    if not is_rotation or pose[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
        raise ValueError(f"{top.where}: source_from_guide is no rigid transform")
    if not _LEAST_DISTANCE_MM <= distance_mm <= _GREATEST_DISTANCE_MM or pose[2, 3] <= 0.0:
        raise ValueError(f"{top.where}: source_from_guide puts the guide {distance_mm:g} mm from the source")
    return pose


def _ellipse(table: Table) -> Ellipse:
    centre, axes = table.numbers("centre", 2), table.numbers("semi_axes", 2)
    if not axes[0] >= axes[1] > 0.0:
        raise ValueError(f"{table.where}: semi_axes must be positive, the longer first")
    return Ellipse((float(centre[0]), float(centre[1])), (float(axes[0]), float(axes[1])), table.number("angle_rad"))


def _covariance(top: Table) -> Array:
    return _checked_covariance(top.numbers("covariance", 10, 10), top)


def _checked_covariance(covariance: Array, table: Table) -> Array:
    variances = np.diag(covariance)
    if not (variances > 0.0).all():
        raise ValueError(f"{table.where}: covariance has a variance that is not positive")
    correlation = covariance / np.sqrt(np.outer(variances, variances))
    symmetric = np.abs(correlation - correlation.T).max() <= _SYMMETRIC_WITHIN
    if not symmetric or np.linalg.eigvalsh(correlation)[0] < -_SYMMETRIC_WITHIN:
        raise ValueError(f"{table.where}: covariance is no covariance matrix")
    return covariance


def _dimensions(top: Table) -> FittedDimensions | None:
    if top.get("dimensions") is None:
        return None
    table = top.table("dimensions")
    dimensions = FittedDimensions(table.numbers("values_mm", 3), table.numbers("covariance", 3, 13))
    _checked_covariance(joint_covariance(_covariance(top), dimensions), table)
    return dimensions


def _predicted_error(table: Table) -> PredictedError:
    return PredictedError(
        angle_rad=math.radians(_positive(table, "angle_deg")),
        position_mm=_positive(table, "position_mm"),
        depth_mm=_positive(table, "depth_mm"),
    )


def _positive(table: Table, key: str) -> float:
    value = table.number(key)
    if value < 0.0:
        raise ValueError(f"{table.where}: {key} must not be negative")
    return value
