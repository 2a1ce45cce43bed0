"""The room's process: opens everything, says where, serves the door until it is told to end."""

import signal
import socket
import sys
from types import FrameType

import uvicorn
from fastapi import FastAPI

from simulator.carm.sending import Destination
from simulator.door import create_door
from simulator.opening import open_room
from simulator.truth import Truth

_DOOR_HOST = "127.0.0.1"
_SHUTDOWN_GRACE_S = 3


def run(arm_address: str, port: int, destination: Destination, truth: Truth) -> None:
    """Serve until SIGINT or SIGTERM; OSError if an address or port is taken, ValueError if it is no loopback one."""
    if not arm_address.startswith("127."):
        raise ValueError(f"{arm_address} is no loopback address: a simulated arm must not be mistaken for a real one")
    for ending in (signal.SIGINT, signal.SIGTERM):
        signal.signal(ending, _end)  # the server puts it back when it has ended, and raises the signal again
    try:
        with (
            socket.create_server((_DOOR_HOST, port)) as listening,
            open_room(arm_address, destination, truth) as opened,
        ):
            _tell(f"Arm at {arm_address}")
            _tell(f"Images go to {destination.ae_title} {destination.host}:{destination.port}")
            _tell(f"Room listens on http://{_DOOR_HOST}:{listening.getsockname()[1]}")
            _serve(create_door(opened.room, opened.pedal), listening)
    except KeyboardInterrupt:
        _tell("Room ended")


def _serve(door: FastAPI, listening: socket.socket) -> None:
    config = uvicorn.Config(door, log_level="warning", access_log=False, timeout_graceful_shutdown=_SHUTDOWN_GRACE_S)
    uvicorn.Server(config).run(sockets=[listening])


def _end(_number: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def _tell(line: str) -> None:
    sys.stderr.write(line + "\n")
    sys.stderr.flush()
