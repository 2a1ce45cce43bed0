"""What can be seen in the room: patient, plan, devices, and the truth that only the room knows."""

from typing import Any

import numpy as np
from fastapi import APIRouter
from scipy.spatial.transform import Rotation

from simulator.devices import DEVICE_FILES
from simulator.pedal import Pedal
from simulator.pedicle import Pedicle
from simulator.room import Room

Json = dict[str, Any]


def router(room: Room, pedal: Pedal) -> APIRouter:
    """Routes that change nothing."""
    routes = APIRouter()

    @routes.get("/room")
    def whole_room() -> Json:
        worklist, destination, angles = pedal.worklist, pedal.destination, room.stand.angles
        return {
            "patient": {"id": worklist.patient_id, "name": worklist.patient_name, "position": "prone"},
            "study_uid": worklist.study_uid,
            "carm": {
                "primary_deg": float(np.rad2deg(angles.primary_rad)),
                "secondary_deg": float(np.rad2deg(angles.secondary_rad)),
                "from_vertical_deg": np.rad2deg(angles.from_vertical_rad).tolist(),
                "exposures": pedal.exposures,
            },
            "arm": {"address": room.controller.address},
            "dicom": {"host": destination.host, "port": destination.port, "ae_title": destination.ae_title},
            "devices": {kind: str(file) for kind, file in DEVICE_FILES.items()},
            "faults": sorted([*room.faults, *room.controller.state().faults]),
        }

    @routes.get("/pedicles")
    def pedicles() -> Json:
        return {"pedicles": [_planned(pedicle) for pedicle in room.patient.pedicles.values()]}

    @routes.get("/pedicles/{name}/pixel")
    def pixel(name: str) -> Json:
        """Where a surgeon would tap in the newest image."""
        u, v = pedal.pixel_of(name)
        return {"pixel_px": [u, v], "space": "raw", "sop_uid": str(pedal.newest.dataset.SOPInstanceUID)}

    @routes.get("/approach")
    def approach(pedicle: str) -> Json:
        """A pose of the guide in the arm's base frame that somebody finds by eye."""
        base_from_goal = room.approach(pedicle)
        turn = Rotation.from_matrix(base_from_goal[:3, :3]).as_rotvec(degrees=True)
        return {
            "translation_mm": base_from_goal[:3, 3].tolist(),
            "rotation_vector_deg": turn.tolist(),
            "base_from_goal": base_from_goal.tolist(),
        }

    @routes.get("/truth/errors")
    def errors(pedicle: str) -> Json:
        """The guide's axis against the true ray through the true target."""
        found = room.errors(pedicle)
        return {"angle_error_deg": float(np.rad2deg(found.angle_rad)), "position_error_mm": found.position_mm}

    return routes


def _planned(pedicle: Pedicle) -> Json:
    return {
        "name": pedicle.name,
        "entry_mm": pedicle.entry_in_patient.tolist(),
        "target_mm": pedicle.target_in_patient.tolist(),
    }
