"""The room's HTTP door: what hands and eyes do in a real room, and what a test may make go wrong there."""

from fastapi import FastAPI, Request
from fastapi.responses import JSONResponse

from simulator.door import arm, carm, faults, looking
from simulator.pedal import NoImageError, Pedal
from simulator.room import Room


def create_door(room: Room, pedal: Pedal) -> FastAPI:
    """The application; whatever the room cannot do is a 4xx with one line of `detail`."""
    door = FastAPI(title="Simulated operating room", docs_url=None, redoc_url=None)
    door.add_exception_handler(ValueError, _not_now)
    door.add_exception_handler(NoImageError, _not_now)
    door.add_exception_handler(KeyError, _unknown)
    door.include_router(looking.router(room, pedal))
    door.include_router(carm.router(room, pedal))
    door.include_router(arm.router(room.controller))
    door.include_router(faults.router(room))
    return door


def _not_now(_request: Request, error: Exception) -> JSONResponse:
    return JSONResponse({"detail": str(error)}, status_code=409)


def _unknown(_request: Request, error: Exception) -> JSONResponse:
    return JSONResponse({"detail": f"the room knows no {error.args[0]}"}, status_code=404)
