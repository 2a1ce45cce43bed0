"""What a test makes go wrong: the room's own faults and, passed through, the arm's."""

from typing import Any

from fastapi import APIRouter

from simulator.controller import Fault
from simulator.faults import RoomFault
from simulator.room import Room

Json = dict[str, Any]

_ROOM_FAULTS = frozenset(RoomFault)
_ARM_FAULTS = frozenset(Fault)


def router(room: Room) -> APIRouter:
    """Routes to plant faults and to take them away; 404 for a name that is none."""
    routes = APIRouter(prefix="/faults")

    @routes.get("")
    def faults() -> Json:
        """All that can be planted, and what is."""
        return {"known": sorted([*_ROOM_FAULTS, *_ARM_FAULTS]), "planted": _planted(room)}

    @routes.post("/{name}")
    def inject(name: str) -> Json:
        if name in _ROOM_FAULTS:
            room.inject(RoomFault(name))
        else:
            room.controller.inject(_arm_fault(name))
        return {"planted": _planted(room)}

    @routes.delete("/{name}")
    def clear(name: str) -> Json:
        if name in _ROOM_FAULTS:
            room.clear(RoomFault(name))
        else:
            room.controller.clear(_arm_fault(name))
        return {"planted": _planted(room)}

    @routes.delete("")
    def clear_all() -> Json:
        """Everything right again; the arm's stops stay latched until they are released."""
        room.clear()
        room.controller.clear()
        return {"planted": _planted(room)}

    return routes


def _arm_fault(name: str) -> Fault:
    if name not in _ARM_FAULTS:
        raise KeyError(f"fault {name}")
    return Fault(name)


def _planted(room: Room) -> list[str]:
    return sorted([*room.faults, *room.controller.state().faults])
