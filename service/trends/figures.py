"""What each finished case measured, and with which devices: from its events and artefacts, without its patient."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from statistics import median

import numpy as np
import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.cases.records import ArtefactKind, Json
from service.database import tables
from service.devices.store import DeviceKind
from vision.distortion import DistortionMap
from workflow.triggers import Trigger

_GRID = 11  # places across the image that its distortion is taken at
CHARTED_DEVICES = (DeviceKind.GUIDE, DeviceKind.CARM, DeviceKind.TCP)
_JUDGED = (Trigger.VERIFICATION_PASSED, Trigger.VERIFICATION_FAILED)
_AIMED = (Trigger.TARGET_CONFIRMED, Trigger.CORRECTION_REQUESTED)
_OVER = (Trigger.CASE_CLOSED, Trigger.CASE_ABORTED)
_READ = (
    *_JUDGED,
    *_AIMED,
    *_OVER,
    Trigger.CARM_POSITION_CONFIRMED,
    Trigger.IMAGE_ARRIVED,
    Trigger.TARGET_DONE,
    Trigger.DEVICE_CHANGED,
)


class Measure(StrEnum):
    """What is followed from case to case; the name ends with the unit."""

    POSITION_ERROR = "position_error_mm"  # at each target's first verification, before any correction
    ANGLE_ERROR = "angle_error_deg"
    RESIDUAL = "residual_rms_px"
    DISTORTION = "distortion_rms_px"
    EXPOSURES = "exposures_per_target"
    TIME = "minutes_per_target"


@dataclass(frozen=True, slots=True)
class CaseFigures:
    """A finished case: its figures where it has any, and the device of each kind that it used from begin to end."""

    case_id: str
    opened_at: str
    values: Mapping[Measure, float]
    devices: Mapping[DeviceKind, str]


@dataclass(frozen=True, slots=True)
class _Event:
    sequence: int
    trigger: str
    data: Json
    recorded_at: str


def finished_cases(connection: Connection) -> list[CaseFigures]:
    """Every closed or aborted case in the order of their opening."""
    events, evaluations = _events(connection), _contents(connection, ArtefactKind.EVALUATION)
    registrations, names = _contents(connection, ArtefactKind.REGISTRATION), _device_names(connection)
    cases = tables.cases.c
    query = sa.select(cases.id, cases.opened_at, cases.devices).order_by(cases.opened_at, cases.id)
    found = []
    for case_id, opened_at, devices in connection.execute(query):
        happened = events[case_id]
        if any(event.trigger in _OVER for event in happened):
            values = _values(happened, evaluations[case_id], list(registrations[case_id].values()))
            found.append(CaseFigures(case_id, opened_at, values, _used(devices, happened, names)))
    return found


def _events(connection: Connection) -> Mapping[str, list[_Event]]:
    events = tables.events.c
    columns = (events.case_id, events.sequence, events.trigger, events.data, events.recorded_at)
    query = sa.select(*columns).where(events.trigger.in_(_READ)).order_by(events.case_id, events.sequence)
    found: defaultdict[str, list[_Event]] = defaultdict(list)
    for row in connection.execute(query):
        found[row.case_id].append(_Event(row.sequence, row.trigger, row.data, row.recorded_at))
    return found


def _contents(connection: Connection, kind: ArtefactKind) -> Mapping[str, dict[int, Json]]:
    """Contents by case and sequence."""
    table = tables.metadata.tables[kind].c
    found: defaultdict[str, dict[int, Json]] = defaultdict(dict)
    for case_id, sequence, content in connection.execute(sa.select(table.case_id, table.sequence, table.content)):
        found[case_id][sequence] = content
    return found


def _device_names(connection: Connection) -> dict[str, str]:
    files = tables.device_files.c
    rows = connection.execute(sa.select(files.id, files.name, files.version))
    return {device_id: f"{name} {version}" for device_id, name, version in rows}


def _used(opened_with: Mapping[str, str], events: Sequence[_Event], names: Mapping[str, str]) -> dict[DeviceKind, str]:
    """What was changed meanwhile belongs to neither device."""
    changes = [event for event in events if event.trigger == Trigger.DEVICE_CHANGED]
    changed = {kind for event in changes for kind in event.data.get("devices", {})}
    return {kind: names[opened_with[kind]] for kind in CHARTED_DEVICES if kind not in changed and kind in opened_with}


def _values(
    events: Sequence[_Event], evaluations: Mapping[int, Json], registrations: Sequence[Json]
) -> dict[Measure, float]:
    errors = [evaluations[sequence]["contour"] for sequence in _first_verifications(events) if sequence in evaluations]
    samples = {
        Measure.POSITION_ERROR: [float(one["position_error_mm"]) for one in errors],
        Measure.ANGLE_ERROR: [float(one["angle_error_deg"]) for one in errors],
        Measure.RESIDUAL: [float(one["residual_rms_px"]) for one in registrations],
        Measure.DISTORTION: [_distortion_rms_px(one) for one in registrations],
    }
    values = {measure: median(sample) for measure, sample in samples.items() if sample}
    return values | _efforts(events)


def _first_verifications(events: Sequence[_Event]) -> list[int]:
    """Sequences of the first judged verification behind each confirmed target: a correction hides what drifts."""
    aim, found = None, []
    for event in events:
        if event.trigger in _AIMED:
            aim = event.trigger
        elif event.trigger in _JUDGED:
            if aim == Trigger.TARGET_CONFIRMED:
                found.append(event.sequence)
            aim = None
    return found


def _efforts(events: Sequence[_Event]) -> dict[Measure, float]:
    """Exposures and time for each target placed, from the first position of the C-arm to the last target."""
    placed = [event for event in events if event.trigger == Trigger.TARGET_DONE and event.data.get("placed")]
    begun = [event for event in events if event.trigger == Trigger.CARM_POSITION_CONFIRMED]
    if not placed or not begun:
        return {}
    last = placed[-1]
    images = [event for event in events if event.trigger == Trigger.IMAGE_ARRIVED and event.sequence < last.sequence]
    values = {Measure.EXPOSURES: len(images) / len(placed)}
    lasted = datetime.fromisoformat(last.recorded_at) - datetime.fromisoformat(begun[0].recorded_at)
    if lasted.total_seconds() >= 0.0:  # else the clock was set back meanwhile (H23)
        values[Measure.TIME] = lasted.total_seconds() / 60.0 / len(placed)
    return values


def _distortion_rms_px(registration: Json) -> float:
    """How far raw and corrected pixels lie apart, root mean square over the round field."""
    distortion = DistortionMap.from_json(registration["distortion"])
    across = np.linspace(-1.0, 1.0, _GRID)
    places = np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2)
    field = places[np.hypot(*places.T) <= 1.0] * distortion.half_size_px + distortion.centre_px
    apart = distortion.corrected_from_raw(field) - field
    return float(np.sqrt(np.mean(np.sum(apart**2, axis=1))))
