"""What the service's own image work and path check make of two rendered exposures: the contents of a recorded case."""

import math
from datetime import datetime
from io import BytesIO
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.recorded_cases import DEPTH_MM, DEVICES, PATIENT, STUDY, Results
from robot.frames import motion_between
from robot.kinematics import base_from_flange
from robot.path import Way, plan_path
from robot.path_limits import PathLimits
from robot.room_shapes import read_room
from robot.tool import read_tool
from service import vision_jobs
from service.conductor.bodies import RequestPlan
from service.conductor.goals import goal_asked_for, goal_at_target
from service.conductor.plan_content import plan_content
from service.devices.store import DeviceKind
from service.motion_errors import motion_errors
from service.settings import Settings
from simulator.carm.anatomy import Body
from simulator.carm.camera import Camera
from simulator.carm.dicom import Frame, Worklist, xa_image
from simulator.carm.geometry import Angles
from simulator.carm.guide import GuideShape
from simulator.carm.quick_render import render_quickly
from simulator.carm.scene import Exposure, PlacedGuide, Scene
from simulator.carm.solids import Shape, Solid
from workflow.plans import PlanKind

_PARKED_RAD = np.deg2rad([0.0, -90.0, 90.0, -90.0, -90.0, 0.0])
_TARGET_PX = (560.0, 470.0)
_CAMERA = Camera(source_to_image_mm=1000.0, pixel_mm=360.0 / 1024, principal_u_px=514.0, principal_v_px=508.0)
_BONES = tuple(
    Solid(Shape.ELLIPSOID, (x, y, 0.0), (9.0, 6.0, 12.0), 0.03)
    for x, y in ((-38.0, -22.0), (-14.0, 31.0), (4.0, -29.0), (21.0, 12.0), (44.0, -8.0), (-33.0, 9.0), (52.0, 34.0))
)


def compute(settings: Settings) -> Results:
    """One target: registered, planned, moved onto, verified."""
    guide, carm = DEVICES[DeviceKind.GUIDE], DEVICES[DeviceKind.CARM]
    tool = read_tool(DEVICES[DeviceKind.TCP])
    errors = motion_errors(settings.arm_accuracy, tool)
    start, source_from_guide = base_from_flange(_PARKED_RAD) @ tool.flange_from_guide, _tilted_guide()
    first = _image(source_from_guide, 1)
    registration = vision_jobs.register(first, guide, carm)
    targeting = vision_jobs.target(registration, _TARGET_PX, DEPTH_MM, errors)
    plan = _plan(PlanKind.TARGETING, goal_at_target(start, targeting), start)
    wanted = RequestPlan.model_validate({"kind": "retreat", "distance_mm": 40.0})
    lift = _plan(wanted.kind, goal_asked_for(wanted, start), start)
    goal = np.array(plan["base_from_goal"])
    second = _image(source_from_guide @ np.array(targeting["guide_from_goal"]), 2)
    moved = motion_between(start, goal).tolist()
    before = {
        "image": first,
        "registration": registration,
        "before_from_after": moved,
        "errors": errors,
        "handedness_proved": False,
    }
    evaluation = vision_jobs.evaluate(second, guide, carm, _TARGET_PX, DEPTH_MM, before)
    asked = {"requested": wanted.model_dump(mode="json", exclude_none=True)}
    return Results((first, second), (start, goal), registration, targeting, plan, lift | asked, evaluation)


def _plan(kind: PlanKind, goal: Any, start: np.ndarray) -> dict[str, Any]:
    way = Way(_PARKED_RAD, start, goal.base_from_goal, leaving=goal.axial)
    path = plan_path(way, read_tool(DEVICES[DeviceKind.TCP]), read_room(DEVICES[DeviceKind.ROOM]), PathLimits())
    return plan_content(kind, goal, start, path)


def _tilted_guide() -> np.ndarray:
    """source_from_guide of a guide 750 mm from the source, tilted by 8 deg: a plain view of it."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xy", [8.0, -3.0], degrees=True).as_matrix()
    pose[:3, 3] = [10.0, -5.0, 750.0]
    return pose


def _image(source_from_guide: np.ndarray, number: int) -> bytes:
    patient = np.eye(4)
    patient[:3, 3] = (0.0, 0.0, 590.0)
    scene = Scene(
        _CAMERA,
        (PlacedGuide(GuideShape(), source_from_guide),),
        (500.0, 500.0),
        intensifier=False,
        body=Body(bone=_BONES, soft=(), bone_textures=(), soft_textures=()),
        source_from_patient=patient,
        exposure=Exposure(bits=16),
    )
    frame = Frame(
        pixels=np.asarray(render_quickly(scene, seed=number).pixels, dtype=np.uint16),
        angles=Angles(math.pi, 0.0),
        source_to_image_mm=1000.0,
        source_to_patient_mm=700.0,
        pixel_mm=_CAMERA.pixel_mm,
        field_of_view_mm=360.0,
        round_field=False,
        number=number,
        at=datetime(2026, 1, 5, 12, 0, number),
        dose_share=1.0,
    )
    file = BytesIO()
    xa_image(frame, Worklist.of(PATIENT, "Doe^Jane", STUDY)).save_as(file, enforce_file_format=True)
    return file.getvalue()
