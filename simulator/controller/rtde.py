"""The RTDE server: negotiates recipes, sends one data packet a cycle, takes input packets."""

import asyncio
import socket
import struct
from collections import deque
from collections.abc import Mapping
from math import nan
from typing import TYPE_CHECKING

from simulator.controller.addresses import RTDE_PORT
from simulator.controller.fields import INPUT_TYPES, OUTPUT_TYPES
from simulator.controller.framing import PacketType, Recipe, Value, frame, names_in, read_frame
from simulator.controller.states import Fault

if TYPE_CHECKING:
    from simulator.controller.core import ControllerCore

# A client that reads nothing is dropped, as real controllers do after some ten seconds: at 137 kB/s this much waits
# in the socket (the kernel doubles what it is asked for) and in the writer.
_SOCKET_BUFFER_BYTES = 250_000
_BACKLOG_LIMIT_BYTES = 800_000
_DRIPPING_LIMIT_BYTES = 10_000
_LATE_S = 0.5
_FALLEN_BEHIND = 0.2  # of a packet, with each


class RtdeConnection:
    """One client: its recipes and whether it is being sent to."""

    def __init__(self, server: "RtdeServer", writer: asyncio.StreamWriter) -> None:
        self._server = server
        self._writer = writer
        self._output: Recipe | None = None
        self._every = 1
        self._inputs: dict[int, Recipe] = {}
        self._started = False
        self._held_back = b""
        self._first_of_pair = False
        self._dripping = b""
        self._under_way: deque[bytes] = deque()
        self._late_by = 0.0

    @property
    def claimed(self) -> set[str]:
        """Names of the inputs that this client writes."""
        return {name for recipe in self._inputs.values() for name in recipe.names}

    def answer(self, kind: int, payload: bytes) -> None:
        """Handle one request.

        Raises
        ------
        ValueError
            If the packet type is unknown.
        """
        match PacketType(kind):
            case PacketType.DATA:
                self._server.take_input(self._inputs[payload[0]].unpack(payload))
            case PacketType.PROTOCOL:
                self._reply(PacketType.PROTOCOL, b"\x01")
            case PacketType.VERSION:
                self._reply(PacketType.VERSION, struct.pack(">4I", *self._server.version))
            case PacketType.OUTPUTS:
                self._reply(PacketType.OUTPUTS, self._set_outputs(payload))
            case PacketType.INPUTS:
                self._reply(PacketType.INPUTS, self._set_inputs(payload))
            case PacketType.START | PacketType.PAUSE:
                self._started = kind == PacketType.START and self._output is not None
                self._reply(PacketType(kind), b"\x01")
            case PacketType.MESSAGE:
                pass

    def send(self, values: Mapping[str, Value], cycle: int) -> None:
        """Send this cycle's packet if it is due, and whatever a fault has held back."""
        if self._started and self._output is not None and cycle % self._every == 0:
            packet = frame(PacketType.DATA, self._output.pack([values[name] for name in self._output.names]))
            self._delay(self._swapped(packet) if Fault.PACKETS_OUT_OF_ORDER in self._server.faults else packet)
        self._drip()
        if self._writer.transport.get_write_buffer_size() > _BACKLOG_LIMIT_BYTES:
            self.close()

    def close(self) -> None:
        """Cut the connection."""
        self._writer.transport.abort()

    def reset(self) -> None:
        """Cut the connection with a TCP reset."""
        no_lingering = struct.pack("ii", 1, 0)
        self._writer.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, no_lingering)
        self.close()

    def _reply(self, kind: PacketType, payload: bytes) -> None:
        self._write(frame(kind, payload))

    def _write(self, packet: bytes) -> None:
        if Fault.BYTES_DRIP in self._server.faults:
            self._dripping += packet if len(self._dripping) < _DRIPPING_LIMIT_BYTES else b""
        else:
            self._writer.write(self._dripping + packet)
            self._dripping = b""

    def _delay(self, packet: bytes) -> None:
        """Send what is due by now: this packet, or older ones where a fault makes all of them late."""
        most = _LATE_S * self._server.frequency_hz / self._every
        if Fault.PACKETS_LATE in self._server.faults:
            self._late_by = most
        elif Fault.PACKETS_FALL_BEHIND in self._server.faults:
            self._late_by = min(self._late_by + _FALLEN_BEHIND, most)
        else:
            self._late_by = 0.0
        self._under_way.append(packet)
        while len(self._under_way) > self._late_by:
            self._write(self._under_way.popleft())

    def _drip(self) -> None:
        if Fault.BYTES_DRIP in self._server.faults:
            self._writer.write(self._dripping[:1])
            self._dripping = self._dripping[1:]

    def _swapped(self, packet: bytes) -> bytes:
        """Of each pair the later packet first, the earlier one a cycle after it."""
        self._first_of_pair = not self._first_of_pair
        if not self._first_of_pair:
            return packet
        late, self._held_back = self._held_back, packet
        return late

    def _set_outputs(self, payload: bytes) -> bytes:
        (wanted_hz,) = struct.unpack_from(">d", payload)
        names = names_in(payload[8:])
        types = [OUTPUT_TYPES.get(name, "NOT_FOUND") for name in names]
        if "NOT_FOUND" in types:
            return b"\x00" + ",".join(types).encode()
        self._output = Recipe(1, names, types)
        self._every = max(1, round(self._server.frequency_hz / wanted_hz)) if wanted_hz > 0.0 else 1
        return b"\x01" + ",".join(types).encode()

    def _set_inputs(self, payload: bytes) -> bytes:
        names = names_in(payload)
        taken = self._server.inputs_of_others(self)
        types = ["IN_USE" if name in taken else INPUT_TYPES.get(name, "NOT_FOUND") for name in names]
        if "NOT_FOUND" in types or "IN_USE" in types:
            return b"\x00" + ",".join(types).encode()
        number = len(self._inputs) + 1
        self._inputs[number] = Recipe(number, names, types)
        return bytes([number]) + ",".join(types).encode()


class RtdeServer:
    """Port 30004 of one controller."""

    def __init__(self, core: "ControllerCore") -> None:
        self.version = core.settings.version
        self.frequency_hz = 1.0 / core.settings.cycle_s
        self._core = core
        self._connections: set[RtdeConnection] = set()
        self._last: Mapping[str, Value] = {}

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Answer one client until it leaves or breaks the protocol."""
        writer.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SOCKET_BUFFER_BYTES)
        connection = RtdeConnection(self, writer)
        self._connections.add(connection)
        self._core.log.add(RTDE_PORT, "connected")
        try:
            while True:
                kind, payload = await read_frame(reader)
                if Fault.HANDSHAKE_MUTE not in self._core.faults:
                    connection.answer(kind, payload)
        except (OSError, asyncio.IncompleteReadError, ValueError, KeyError, IndexError, struct.error):
            connection.close()
        finally:
            self._connections.discard(connection)
            self._core.log.add(RTDE_PORT, "disconnected")

    @property
    def faults(self) -> frozenset[Fault]:
        """What is planted now."""
        return self._core.faults

    def take_input(self, values: Mapping[str, Value]) -> None:
        """Hand an input packet on, and keep it for the tests."""
        self._core.log.add_input(values)
        self._core.write_inputs(values)

    def inputs_of_others(self, connection: RtdeConnection) -> set[str]:
        """Inputs that this client may not have."""
        if not self._core.settings.input_registers_exclusive:
            return set()
        return {name for other in self._connections if other is not connection for name in other.claimed}

    def send(self, values: Mapping[str, Value]) -> None:
        """Send one cycle to every client, as honestly as the faults allow."""
        faults = self._core.faults
        shown = _distorted(values, self._last or values, faults)
        self._last = shown
        if Fault.PACKETS_STOP in faults:
            return
        for connection in tuple(self._connections):
            connection.send(shown, self._core.cycles)

    def close_connections(self) -> None:
        """Cut every client off."""
        for connection in tuple(self._connections):
            connection.close()

    def reset_connections(self) -> None:
        """Cut every client off with a TCP reset."""
        for connection in tuple(self._connections):
            connection.reset()


def _distorted(now: Mapping[str, Value], last: Mapping[str, Value], faults: frozenset[Fault]) -> Mapping[str, Value]:
    if Fault.VALUES_FREEZE in faults:
        now = {**last, "timestamp": now["timestamp"]}
    if Fault.VALUES_NAN in faults:
        broken = dict.fromkeys(("actual_q", "actual_qd", "actual_TCP_pose", "actual_TCP_speed"), (nan,) * 6)
        now = {**now, **broken}
    if Fault.TIMESTAMP_STOPS in faults:
        now = {**now, "timestamp": last["timestamp"]}
    return now
