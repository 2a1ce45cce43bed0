"""A simulated controller in this process: servers and cycle in one thread with an event loop of its own."""

import asyncio
import threading
import time
from collections.abc import Callable, Coroutine
from concurrent.futures import Future
from types import TracebackType
from typing import Any, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from simulator.controller.core import ControllerCore
from simulator.controller.pendant import Pendant
from simulator.controller.servers import ControllerServers
from simulator.controller.settings import ControllerSettings, Payload
from simulator.controller.state import ArmSample, ControllerState, WireRecord
from simulator.controller.states import Fault, PowerAction

Array = NDArray[np.float64]
Result = TypeVar("Result")

_ANSWER_TIMEOUT_S = 10.0


class Controller:
    """Runs from construction until `close`.

    Raises
    ------
    OSError
        If the address or a port of it is taken.
    """

    def __init__(self, settings: ControllerSettings) -> None:
        self.settings = settings
        self._core = ControllerCore(settings)
        self._pendant = Pendant(self._core)
        self._servers = ControllerServers(self._core)
        self._loop = asyncio.new_event_loop()
        self._stopping = asyncio.Event()
        self._opened: Future[None] = Future()
        self._thread = threading.Thread(target=self._serve, name="controller", daemon=True)
        self._thread.start()
        self._opened.result(_ANSWER_TIMEOUT_S)

    def __enter__(self) -> Self:
        """The controller itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

    @property
    def address(self) -> str:
        """The loopback address of the three servers."""
        return self.settings.address

    def state(self) -> ControllerState:
        """The present moment."""
        return self._call(self._present)

    def inject(self, fault: Fault) -> None:
        """Plant a fault; it stays until cleared."""
        self._plant(lambda now: now | {fault})

    def clear(self, fault: Fault | None = None) -> None:
        """Take one fault away, or all; stops stay latched until they are released as on a real arm."""
        self._plant(lambda now: now - (now if fault is None else {fault}))

    def release(self) -> None:
        """Clear all faults and bring the arm to running and normal, as a person at the pendant would, at once."""
        self._plant(lambda _: frozenset(), self._core.safety.reset)  # with no cycle in between

    def power(self, action: PowerAction) -> None:
        """Switch the arm's power from the pendant."""
        self._call(lambda: self._pendant.power(action))

    def jog(self, joints_delta_rad: Array, speed_rad_s: float = 0.2) -> None:
        """Move the joints (6,) by this much from the pendant, without a program; returns at once.

        Raises
        ------
        ValueError
            If a program is loaded, or the arm moves or may not move.
        """
        self._call(lambda: self._pendant.jog(joints_delta_rad, speed_rad_s))

    def jog_linear(self, step_in_base_mm: Array, speed_mm_s: float = 20.0) -> None:
        """Move the TCP along a straight line from the pendant, without a program; returns at once.

        Raises
        ------
        ValueError
            If a program is loaded, or the arm moves or may not move.
        """
        self._call(lambda: self._pendant.jog_linear(step_in_base_mm, speed_mm_s))

    def push(self, step_in_base_mm: Array) -> None:
        """Disturb the arm: the TCP yields by this much in base coordinates, and the encoders see it.

        Raises
        ------
        ValueError
            If the arm moves, where the push would be lost in the motion.
        """
        self._call(lambda: self._pendant.push(step_in_base_mm))

    def teleport(self, joints_rad: Array) -> None:
        """Put the arm elsewhere between two cycles, to set a scene up."""
        self._call(lambda: self._core.arm.teleport(joints_rad))

    def set_tcp(self, flange_from_tcp: Array) -> None:
        """Change the controller's TCP setting (4x4, mm), as somebody at the pendant could."""
        self._call(lambda: self._pendant.set_tcp(np.array(flange_from_tcp, dtype=np.float64)))

    def set_payload(self, payload: Payload) -> None:
        """Change the controller's payload setting."""
        self._call(lambda: self._pendant.set_payload(payload))

    def set_speed_scaling(self, fraction: float) -> None:
        """Move the pendant's speed slider, 0 to 1."""
        self._call(lambda: self._pendant.set_speed_scaling(fraction))

    def wire(self, after: int = -1) -> tuple[WireRecord, ...]:
        """What reached the controller, oldest first, numbers above `after`."""
        return self._call(lambda: self._core.log.records(after))

    def samples(self, since_s: float = 0.0) -> tuple[ArmSample, ...]:
        """The arm's recorded cycles from a monotonic time on."""
        return self._call(lambda: self._core.log.samples(since_s))

    def close(self) -> None:
        """End the servers; a second call does nothing."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._stopping.set)
            self._thread.join(_ANSWER_TIMEOUT_S)

    def _serve(self) -> None:
        """Everything on the loop happens in this thread, so the controller's state needs no lock."""
        try:
            with asyncio.Runner(loop_factory=lambda: self._loop) as runner:
                runner.run(self._servers.run(lambda: self._opened.set_result(None), self._stopping))
        except OSError as error:
            self._opened.set_exception(error)

    def _call(self, function: Callable[[], Result]) -> Result:
        async def call() -> Result:
            return function()

        return self._await(call())

    def _await(self, coroutine: Coroutine[Any, Any, Result]) -> Result:
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(_ANSWER_TIMEOUT_S)

    def _plant(
        self, change: Callable[[frozenset[Fault]], frozenset[Fault]], also: Callable[[], None] = lambda: None
    ) -> None:
        async def plant() -> None:
            self._core.faults = change(self._core.faults)
            also()
            await self._servers.open_ports()

        self._await(plant())

    def _present(self) -> ControllerState:
        core, pacing = self._core, self._servers.pacing
        return ControllerState(
            at_s=time.monotonic(),
            controller_time_s=core.time_s,
            joints_rad=core.arm.joints_rad,
            joint_speeds_rad_s=core.arm.speeds_rad_s,
            base_from_flange_nominal=core.arm.base_from_flange,
            flange_from_tcp=core.arm.flange_from_tcp,
            true_joints_rad=core.arm.true_joints_rad,
            base_from_flange_true=core.arm.base_from_flange_true,
            tcp_speed_mm_s=float(np.linalg.norm(core.arm.tcp_velocity[:3])),
            payload=core.payload,
            robot_mode=core.safety.robot_mode,
            safety_mode=core.safety.mode,
            runtime_state=core.runtime_state,
            program=core.program_name,
            moving=not core.arm.at_rest,
            watchdog_hz=core.watchdog.frequency_hz,
            speed_scaling=core.speed_scaling,
            faults=core.faults,
            cycles=core.cycles,
            latest_cycle_late_s=pacing.worst_delay_s,
            stalled_s=pacing.stalled_s,
        )
