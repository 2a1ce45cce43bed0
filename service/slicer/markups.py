"""Planned needle paths from 3D Slicer's markups file (`.mrk.json`): one line per pedicle, entry then target."""

import json
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from service.cases.opening import PlannedTarget, Point
from service.errors import ErrorCode, ServiceError

_MOST_BYTES = 4_000_000
# Slicer writes LPS since 5.0, RAS before: they differ in the signs of the first two axes.
_LPS_FROM = {"LPS": (1.0, 1.0, 1.0), "RAS": (-1.0, -1.0, 1.0), "0": (-1.0, -1.0, 1.0), "1": (1.0, 1.0, 1.0)}


class _ControlPoint(BaseModel):
    model_config = ConfigDict(extra="ignore")
    label: str = ""
    position: Point
    position_status: str = Field(default="defined", alias="positionStatus")


class _Markup(BaseModel):
    model_config = ConfigDict(extra="ignore")
    type: str
    name: str = ""
    coordinate_system: Literal["LPS", "RAS", "0", "1"] = Field(alias="coordinateSystem")
    coordinate_units: Any = Field(default="mm", alias="coordinateUnits")
    control_points: list[_ControlPoint] = Field(alias="controlPoints", max_length=10_000)


class _MarkupsFile(BaseModel):
    model_config = ConfigDict(extra="ignore")
    markups: list[_Markup] = Field(min_length=1, max_length=1000)


def planned_targets_from(content: bytes) -> list[PlannedTarget]:
    """Every line of the file as a planned target in patient coordinates (LPS, mm).

    The first point is the entry and the second the target, unless their labels say otherwise. Other markups are no
    paths and are left out. ServiceError MARKUPS_REFUSED says what is wrong with the file.
    """
    lines = [one for one in _read(content).markups if one.type == "Line"]
    if not lines:
        raise _refused("the file holds no line: draw one per pedicle, entry first")
    targets = [_target(one, number) for number, one in enumerate(lines, 1)]
    names = [target.name for target in targets]
    if len(set(names)) < len(names):
        raise _refused("two lines have the same name: give each pedicle its own")
    return targets


def _read(content: bytes) -> _MarkupsFile:
    if len(content) > _MOST_BYTES:
        raise _refused("the file is too large, bytes", measured=len(content), limit=_MOST_BYTES)
    try:
        return _MarkupsFile.model_validate(json.loads(content))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        raise _refused(f"no markups file of 3D Slicer: {where}: {first['msg']}") from error
    except (ValueError, RecursionError) as error:
        raise _refused("no JSON, so no markups file") from error


def _target(line: _Markup, number: int) -> PlannedTarget:
    name = line.name or f"line {number}"
    if line.coordinate_units not in ("mm", None):
        raise _refused(f"{name} is in other units than mm")
    if len(line.control_points) != 2 or any(one.position_status != "defined" for one in line.control_points):
        raise _refused(f"{name} needs two placed points", measured=len(line.control_points), limit=2)
    entry, target = _ordered(line.control_points)
    sign = _LPS_FROM[line.coordinate_system]
    try:
        return PlannedTarget(name=name, entry_mm=_signed(entry, sign), target_mm=_signed(target, sign))
    except ValidationError as error:
        raise _refused(f"{name}: {error.errors(include_url=False, include_input=False)[0]['msg']}") from error


def _ordered(points: list[_ControlPoint]) -> tuple[Point, Point]:
    first, second = points
    if "target" in first.label.lower() or "entry" in second.label.lower():
        return second.position, first.position
    return first.position, second.position


def _signed(point: Point, sign: Point) -> Point:
    return sign[0] * point[0], sign[1] * point[1], sign[2] * point[2]


def _refused(message: str, measured: float | None = None, limit: float | None = None) -> ServiceError:
    return ServiceError(ErrorCode.MARKUPS_REFUSED, message, measured=measured, limit=limit)
