"""Plans as 3D Slicer writes them, and as it does not."""

import json

import pytest

from service.auth.permissions import Role
from service.errors import ErrorCode, ServiceError
from service.slicer.markups import planned_targets_from

_ENTRY, _TARGET = [32.0, 85.0, 12.0], [20.0, 40.0, 4.0]


def _line(name="L3 left", system="LPS", points=(_ENTRY, _TARGET), labels=("1", "2"), **more):
    placed = [
        {"id": label, "label": label, "position": list(point), "positionStatus": "defined", "visibility": True}
        for label, point in zip(labels, points, strict=True)
    ]
    return {"type": "Line", "name": name, "coordinateSystem": system, "controlPoints": placed, **more}


def _file(*markups) -> bytes:
    schema = "https://raw.githubusercontent.com/slicer/slicer/master/markups-schema-v1.0.3.json#"
    return json.dumps({"@schema": schema, "markups": markups}).encode()


def test_a_line_is_entry_then_target():
    (target,) = planned_targets_from(_file(_line(coordinateUnits="mm")))
    assert (target.name, list(target.entry_mm), list(target.target_mm)) == ("L3 left", _ENTRY, _TARGET)


def test_the_older_axes_are_turned():
    (target,) = planned_targets_from(_file(_line(system="RAS")))
    assert target.entry_mm == (-32.0, -85.0, 12.0)
    assert target.target_mm == (-20.0, -40.0, 4.0)


def test_labels_say_which_end_is_which():
    (target,) = planned_targets_from(_file(_line(points=(_TARGET, _ENTRY), labels=("Target L3", "Entry"))))
    assert list(target.entry_mm) == _ENTRY


def test_other_markups_are_no_paths_and_lines_without_a_name_get_one():
    curve = {"type": "Curve", "name": "canal", "coordinateSystem": "LPS", "controlPoints": []}
    first, second = planned_targets_from(_file(curve, _line(name=""), _line("L4 left")))
    assert (first.name, second.name) == ("line 1", "L4 left")


@pytest.mark.parametrize(
    "content",
    [
        b"\xff\x00",
        b"[" * 100_000,
        b"[]",
        b"{}",
        _file(),
        _file({"type": "Fiducial", "coordinateSystem": "LPS", "controlPoints": []}),
        _file(_line(points=(_ENTRY,), labels=("1",))),
        _file(_line(), _line()),
        _file(_line(coordinateUnits="m")),
        _file(_line(system="XYZ")),
        _file(_line(points=(_ENTRY, [0.02, 0.04, float("nan")]))),
        _file(_line(points=(_ENTRY, [20_000.0, 40.0, 4.0]))),
    ],
    ids=["bytes", "deep", "list", "empty", "none", "points", "one", "twice", "metres", "axes", "nan", "far"],
)
def test_what_is_no_plan_is_refused_in_words(content):
    with pytest.raises(ServiceError) as refused:
        planned_targets_from(content)
    assert refused.value.code == ErrorCode.MARKUPS_REFUSED


def test_the_service_reads_a_file_for_who_may_open_a_case(running):
    with running.client(Role.OPERATOR) as client:
        answer = client.post("/plans/markups", content=_file(_line()))
        assert answer.json() == [{"name": "L3 left", "entry_mm": _ENTRY, "target_mm": _TARGET}]
        assert client.post("/plans/markups", content=b"{}").status_code == 422
    with running.client(Role.AUDITOR) as client:
        assert client.post("/plans/markups", content=_file(_line())).status_code == 403
