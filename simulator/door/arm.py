"""Hands at the arm: the pendant, and a shove."""

from typing import Any

import numpy as np
from fastapi import APIRouter

from simulator.controller import ControllerControl, ControllerState, PowerAction
from simulator.door.bodies import Jog, Push
from simulator.frames import PARKED_RAD

Json = dict[str, Any]


def router(controller: ControllerControl) -> APIRouter:
    """Routes of the arm; what the arm refuses is a 409."""
    routes = APIRouter(prefix="/arm")

    @routes.get("")
    def arm() -> Json:
        return _told(controller.state())

    @routes.post("/jog")
    def jog(body: Jog) -> Json:
        """Start a motion from the pendant; it goes on after the answer."""
        if (body.joints_deg is None) == (body.step_mm is None):
            raise ValueError("a jog needs either joints_deg or step_mm")
        if body.joints_deg is not None:
            controller.jog(np.deg2rad(body.joints_deg))
        else:
            controller.jog_linear(np.array(body.step_mm, dtype=np.float64))
        return _told(controller.state())

    @routes.post("/push")
    def push(body: Push) -> Json:
        controller.push(np.array(body.step_mm, dtype=np.float64))
        return _told(controller.state())

    @routes.post("/park")
    def park() -> Json:
        """Set the arm back to its parked pose at once, to begin anew."""
        controller.teleport(np.array(PARKED_RAD))
        return _told(controller.state())

    @routes.post("/power/{action}")
    def power(action: PowerAction) -> Json:
        controller.power(action)
        return _told(controller.state())

    @routes.post("/release")
    def release() -> Json:
        """Clear the arm's faults and bring it to running and normal."""
        controller.release()
        return _told(controller.state())

    return routes


def _told(state: ControllerState) -> Json:
    return {
        "joints_deg": np.rad2deg(state.joints_rad).tolist(),
        "moving": state.moving,
        "robot_mode": state.robot_mode.name.lower(),
        "safety_mode": state.safety_mode.name.lower(),
        "faults": sorted(state.faults),
    }
