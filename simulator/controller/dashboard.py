"""The dashboard server: one command a line, one line back, refusals in words."""

import asyncio
from typing import TYPE_CHECKING

from simulator.controller.addresses import DASHBOARD_PORT
from simulator.controller.states import Fault, RobotMode, RuntimeState, SafetyMode

if TYPE_CHECKING:
    from simulator.controller.core import ControllerCore

BANNER = "Connected: Universal Robots Dashboard Server"

_ROBOT_MODES = {RobotMode.POWER_OFF: "POWER_OFF", RobotMode.IDLE: "IDLE", RobotMode.RUNNING: "RUNNING"}
_SAFETY_MODES = {
    SafetyMode.NORMAL: "NORMAL",
    SafetyMode.REDUCED: "REDUCED",
    SafetyMode.PROTECTIVE_STOP: "PROTECTIVE_STOP",
    SafetyMode.SAFEGUARD_STOP: "SAFEGUARD_STOP",
    SafetyMode.SYSTEM_EMERGENCY_STOP: "SYSTEM_EMERGENCY_STOP",
    SafetyMode.ROBOT_EMERGENCY_STOP: "ROBOT_EMERGENCY_STOP",
    SafetyMode.VIOLATION: "VIOLATION",
    SafetyMode.FAULT: "FAULT",
}
_REFUSAL = "Failed to execute: {}"
_LOCAL = "Command is not allowed due to safety reasons"
_REMOTE_ONLY = ("stop", "play", "pause", "unlock", "power", "brake", "restart", "load")


class DashboardServer:
    """Port 29999 of one controller."""

    def __init__(self, core: "ControllerCore") -> None:
        self._core = core
        self._writers: set[asyncio.StreamWriter] = set()

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Answer one client until it leaves or quits."""
        self._writers.add(writer)
        self._core.log.add(DASHBOARD_PORT, "connected")
        try:
            writer.write(f"{BANNER}\n".encode())
            while line := await reader.readline():
                command = line.decode("ascii", "replace").strip()
                self._core.log.add(DASHBOARD_PORT, "dashboard", command)
                writer.write(f"{self._answer(command)}\n".encode())
                if command == "quit":
                    break
        except (OSError, ValueError):  # reset by the client, or a line without an end
            writer.transport.abort()
        finally:
            self._writers.discard(writer)
            writer.close()
            self._core.log.add(DASHBOARD_PORT, "disconnected")

    def close_connections(self) -> None:
        """Cut every client off."""
        for writer in tuple(self._writers):
            writer.transport.abort()

    def _answer(self, command: str) -> str:
        core = self._core
        if Fault.LOCAL_CONTROL in core.faults and command.startswith(_REMOTE_ONLY):
            return _LOCAL
        match command.split(maxsplit=1):
            case ["stop"]:
                core.stop_program()
                return "Stopped"
            case ["play"]:
                return "Starting program" if core.play() else _REFUSAL.format(command)
            case ["pause"]:
                return "Pausing program" if core.pause() else _REFUSAL.format(command)
            case ["running"]:
                return f"Program running: {str(core.runtime_state is not RuntimeState.STOPPED).lower()}"
            case ["robotmode"]:
                return f"Robotmode: {_ROBOT_MODES[core.safety.robot_mode]}"
            case ["safetymode"]:
                return f"Safetymode: {_SAFETY_MODES[core.safety.mode]}"
            case ["programState"]:
                return self._program_state()
            case ["unlock", _]:
                return self._unlock()
            case ["power", switch]:
                return self._power(switch)
            case ["brake", "release"]:
                core.safety.release_brakes(core.time_s)
                return "Brake releasing"
            case ["restart", "safety"]:
                core.safety.restart()
                return "Restarting safety"
            case _:
                return self._describe(command)

    def _program_state(self) -> str:
        paused = self._core.runtime_state in (RuntimeState.PAUSING, RuntimeState.PAUSED)
        playing = self._core.runtime_state in (RuntimeState.PLAYING, RuntimeState.RESUMING)
        word = "PAUSED" if paused else "PLAYING" if playing else "STOPPED"
        return f"{word} {self._core.program_name or 'null'}"

    def _unlock(self) -> str:
        if self._core.safety.unlock(self._core.time_s):
            return "Protective stop releasing"
        return "Cannot unlock protective stop until 5s after occurrence. Always inspect cause of protective stop"

    def _power(self, switch: str) -> str:
        if switch == "on":
            self._core.safety.power_on(self._core.time_s)
            return "Powering on"
        self._core.power_off()
        return "Powering off"

    def _describe(self, command: str) -> str:
        version = self._core.settings.version
        word, _, rest = command.partition(" ")
        answers = {
            "PolyscopeVersion": "URSoftware {}.{}.{}.{} (Oct 10 2023)".format(*version),
            "get robot model": "UR5",
            "get serial number": "20175500001",
            "get loaded program": "No program loaded",
            "is in remote control": str(Fault.LOCAL_CONTROL not in self._core.faults).lower(),
            "isProgramSaved": "true",
            "close popup": "closing popup",
            "close safety popup": "closing safety popup",
            "quit": "Disconnected",
            "shutdown": "Shutting down",
        }
        by_word = {"load": f"Loading program: {rest}", "popup": "showing popup", "addToLog": "Added log message"}
        if command == "safetystatus" and version >= (5, 4):
            return f"Safetystatus: {_SAFETY_MODES[self._core.safety.mode]}"
        return answers.get(command) or by_word.get(word) or f'could not understand: "{command}"'
