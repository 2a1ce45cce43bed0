"""The three servers of a controller around its cycle, on one event loop."""

import asyncio
from collections.abc import Callable
from functools import partial
from typing import Protocol

from simulator.controller.addresses import DASHBOARD_PORT, RTDE_PORT, SCRIPT_PORT
from simulator.controller.core import ControllerCore
from simulator.controller.dashboard import DashboardServer
from simulator.controller.fields import output_values
from simulator.controller.pacing import Pacing
from simulator.controller.rtde import RtdeServer
from simulator.controller.script import ScriptServer
from simulator.controller.states import Fault

_FAULTS_OF_PORT = {
    RTDE_PORT: {Fault.RTDE_CLOSED, Fault.SWITCHED_OFF},
    SCRIPT_PORT: {Fault.SCRIPT_PORT_CLOSED, Fault.SWITCHED_OFF},
    DASHBOARD_PORT: {Fault.DASHBOARD_CLOSED, Fault.SWITCHED_OFF},
}
_LEAVE_WITHIN_S = 1.0


class PortServer(Protocol):
    """What the three servers have in common."""

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Answer one client until it leaves."""

    def close_connections(self) -> None:
        """Cut every client off."""


class ControllerServers:
    """Opens and closes the ports as the faults say, and advances the controller at its pace."""

    def __init__(self, core: ControllerCore) -> None:
        self.pacing = Pacing(core.settings.cycle_s)
        self._core = core
        self._rtde = RtdeServer(core)
        self._servers: dict[int, PortServer] = {
            RTDE_PORT: self._rtde,
            SCRIPT_PORT: ScriptServer(core.load, core.log),
            DASHBOARD_PORT: DashboardServer(core),
        }
        self._listening: dict[int, asyncio.Server] = {}
        self._clients: set[asyncio.Task[None]] = set()

    async def run(self, opened: Callable[[], None], stopping: asyncio.Event) -> None:
        """Serve until told to stop.

        Raises
        ------
        OSError
            If the address or a port of it is taken.
        """
        try:
            await self.open_ports()
            opened()
            while not stopping.is_set():
                await asyncio.sleep(max(0.0, self.pacing.wait_s()))  # late or not, the servers get a turn
                self._cycle()
        finally:
            for port in tuple(self._listening):
                self._shut(port)
            if self._clients:  # cut off, they end by themselves
                await asyncio.wait(self._clients, timeout=_LEAVE_WITHIN_S)

    async def open_ports(self) -> None:
        """Listen where no fault forbids it, and cut off the clients of the other ports."""
        for port, faults in _FAULTS_OF_PORT.items():
            if faults & self._core.faults:
                self._shut(port)
            elif port not in self._listening:
                admit = partial(self._admit, port)
                self._listening[port] = await asyncio.start_server(admit, self._core.settings.address, port)
        if Fault.RTDE_RESET in self._core.faults:
            self._rtde.reset_connections()
        await asyncio.sleep(0)  # an aborted connection is closed in the loop's next turn: whoever waits sees it closed

    def _admit(self, port: int, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        client = asyncio.ensure_future(self._serve(port, reader, writer))
        self._clients.add(client)
        client.add_done_callback(self._clients.discard)

    async def _serve(self, port: int, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Serve a client, unless its port was shut after it was accepted and before this task came to begin."""
        if _FAULTS_OF_PORT[port] & self._core.faults:
            writer.transport.abort()
            return
        await self._servers[port].serve(reader, writer)

    def _cycle(self) -> None:
        self.pacing.note()
        self._core.cycle()
        self._rtde.send(output_values(self._core))

    def _shut(self, port: int) -> None:
        listening = self._listening.pop(port, None)
        if listening is not None:
            listening.close()
        self._servers[port].close_connections()
