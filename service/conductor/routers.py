"""Every router of the conductor and of the arm's bridge."""

from fastapi import APIRouter

from service.conductor import (
    angles,
    approval,
    assigning,
    closing,
    control,
    correction,
    daily_check,
    events,
    exposure,
    identity,
    insertion,
    notes,
    overlays,
    plans,
    statements,
    status,
    targets,
)
from service.motion import hold, stop

CONDUCTOR_ROUTERS: tuple[APIRouter, ...] = (
    status.router,
    daily_check.router,
    events.router,
    angles.router,
    overlays.router,
    stop.router,
    control.router,
    exposure.router,
    identity.router,
    assigning.router,
    targets.router,
    plans.router,
    approval.router,
    hold.router,
    correction.router,
    insertion.router,
    statements.router,
    notes.router,
    closing.router,
)
