"""The script server: takes whole programs and recognises them without interpreting them."""

import asyncio
import re
from collections.abc import Callable
from dataclasses import dataclass

from simulator.controller.addresses import SCRIPT_PORT
from simulator.controller.wire_log import WireLog

CONTROL_PROGRAM = "rtde_control"

_NAME = re.compile(r"^\s*(?:def|sec)\s+(\w+)\s*\(", re.MULTILINE)
_OFFSET = re.compile(r"int register offset[^\n]*\n(\d+)")
_PATH = re.compile(r"inject move path\n(.*?)^\s*end\b", re.MULTILINE | re.DOTALL)
_NUMBER = r"\s*([-+.\deE]+)"
_PATH_MOVE = re.compile(rf"\b(move[jlp])\((p?)\[([^\]]*)\],\s*a={_NUMBER},\s*v={_NUMBER}")
_PROGRAM_LIMIT_BYTES = 1_000_000


@dataclass(frozen=True, slots=True)
class PathMove:
    """One move injected into the control program: metres, radians, seconds as on the wire."""

    command: str  # movej, movel or movep
    is_pose: bool  # else joint angles
    target: tuple[float, ...]
    acceleration: float
    speed: float


@dataclass(frozen=True, slots=True)
class Upload:
    """What is recognised in an uploaded program."""

    name: str  # "" for statements outside a function
    register_offset: int
    path: tuple[PathMove, ...]


def recognise(text: str) -> Upload:
    """Name, register offset and injected path moves of a program."""
    name, offset, path = _NAME.search(text), _OFFSET.search(text), _PATH.search(text)
    moves = _PATH_MOVE.finditer(path[1]) if path else ()
    return Upload(name[1] if name else "", int(offset[1]) if offset else 0, tuple(_path_move(move) for move in moves))


def _path_move(match: re.Match[str]) -> PathMove:
    target = tuple(float(value) for value in match[3].split(","))
    return PathMove(match[1], bool(match[2]), target, float(match[4]), float(match[5]))


class ScriptServer:
    """Port 30003 of one controller; sends nothing, as no client of ours reads it."""

    def __init__(self, sink: Callable[[Upload], None], log: WireLog) -> None:
        self._sink = sink
        self._log = log
        self._writers: set[asyncio.StreamWriter] = set()

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Take programs from one client until it leaves."""
        self._writers.add(writer)
        self._log.add(SCRIPT_PORT, "connected")
        try:
            while text := await _read_program(reader):
                upload = recognise(text)
                self._log.add(SCRIPT_PORT, "script", upload.name or text.strip())
                self._sink(upload)
        except (OSError, ValueError):  # reset by the client, or a program beyond the limit
            writer.transport.abort()
        finally:
            self._writers.discard(writer)
            writer.close()
            self._log.add(SCRIPT_PORT, "disconnected")

    def close_connections(self) -> None:
        """Cut every client off."""
        for writer in tuple(self._writers):
            writer.transport.abort()


async def _read_program(reader: asyncio.StreamReader) -> str:
    """A function up to its `end` in the first column, or a single statement; "" at the end of the connection.

    Raises
    ------
    ValueError
        If the program is longer than any that a client sends.
    """
    lines: list[str] = []
    size = 0
    while line := await reader.readline():
        size += len(line)
        if size > _PROGRAM_LIMIT_BYTES:
            raise ValueError("program too long")
        lines.append(line.decode("utf-8", "replace"))
        inside = lines[0].startswith(("def ", "sec "))
        if not inside and not lines[0].strip():
            lines.clear()
        elif not inside or lines[-1].rstrip() == "end":
            return "".join(lines)
    return ""
