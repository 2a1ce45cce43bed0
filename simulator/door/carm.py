"""The radiographer's hands: worklist, position, pedal."""

import time
from dataclasses import replace
from typing import Any

import numpy as np
from fastapi import APIRouter

from simulator.carm.dicom import Worklist
from simulator.carm.geometry import Angles
from simulator.door.bodies import CarmPosition, Override, Study
from simulator.pedal import Pedal
from simulator.room import Room

Json = dict[str, Any]


def router(room: Room, pedal: Pedal) -> APIRouter:
    """Routes of the C-arm."""
    routes = APIRouter()

    @routes.post("/study")
    def study(body: Study) -> Json:
        """The worklist's entry: whose images these are from now on."""
        pedal.worklist = Worklist.of(body.patient_id, body.patient_name, body.study_uid)
        return {"series_uid": pedal.worklist.series_uid}

    @routes.post("/carm/position")
    def position(body: CarmPosition) -> Json:
        angles = Angles(float(np.deg2rad(body.primary_deg)), float(np.deg2rad(body.secondary_deg)))
        room.position(angles, body.pedicle)
        return {"from_vertical_deg": np.rad2deg(angles.from_vertical_rad).tolist()}

    @routes.post("/expose")
    def expose(body: Override | None = None) -> Json:
        """Take an image and send it, under the worklist's entry or, for this one image, under what the body says."""
        body = body or Override()
        if body.at_expiration:
            time.sleep(room.until_expiration_s())
        override = body.model_dump(exclude_none=True, exclude={"at_expiration"})
        taken, sent = pedal.press(replace(pedal.worklist, **override))
        return {
            "sop_uid": str(taken.dataset.SOPInstanceUID),
            "number": int(taken.dataset.InstanceNumber),
            "accepted": sent.accepted,
            "status": sent.status,
            "detail": sent.detail,
        }

    return routes
