"""The controller itself: arm, safety, program and registers, advanced one cycle at a time."""

import time
from collections.abc import Mapping
from random import Random

from simulator.controller.arm import Arm
from simulator.controller.framing import Value
from simulator.controller.program import ControlProgram, OtherProgram, Program
from simulator.controller.questions import ProgramError
from simulator.controller.registers import Registers
from simulator.controller.safety import Safety
from simulator.controller.script import CONTROL_PROGRAM, Upload
from simulator.controller.settings import ControllerSettings
from simulator.controller.state import ArmSample
from simulator.controller.states import Fault, RobotMode, RuntimeState, SafetyMode, WatchdogOutcome
from simulator.controller.watchdog import Watchdog
from simulator.controller.wire_log import WireLog

_PAUSED_STATES = (RuntimeState.PAUSING, RuntimeState.PAUSED)
_STOPPED_STATES = (RuntimeState.STOPPING, RuntimeState.STOPPED)
_PROGRAM_ENDING_STOPS = (
    SafetyMode.ROBOT_EMERGENCY_STOP,
    SafetyMode.SYSTEM_EMERGENCY_STOP,
    SafetyMode.VIOLATION,
    SafetyMode.FAULT,
)
_FORCE_STEP_N = 60.0
_RESTING_FORCE_N = (2.0, -3.0, 5.0)  # what an uncalibrated payload leaves in the estimate
_FORCE_NOISE_N = 2.0


class ControllerCore:
    """All state of one controller; used from one thread only."""

    def __init__(self, settings: ControllerSettings) -> None:
        self.settings = settings
        self.arm = Arm(settings)
        self.safety = Safety(settings.emergency_robot_mode, settings.unlock_delay_s)
        self.registers = Registers()
        self.watchdog = Watchdog()
        self.log = WireLog()
        self.payload = settings.payload
        self.faults: frozenset[Fault] = frozenset()
        self.runtime_state = RuntimeState.STOPPED
        self.speed_scaling = 1.0
        self.cycles = 0
        self._noise = Random(settings.truth.seed)
        self._program: Program | None = None
        self._next_upload: Upload | None = None

    @property
    def time_s(self) -> float:
        """The controller's clock: counts cycles."""
        return self.cycles * self.settings.cycle_s

    @property
    def program_name(self) -> str:
        """Of the loaded program, "" without one."""
        return self._program.name if self._program is not None else ""

    @property
    def tcp_force_n(self) -> tuple[float, ...]:
        """Force and torque reported at the TCP, as noisy as an estimate from motor currents."""
        x, y, z = (self._noise.gauss(force, _FORCE_NOISE_N) for force in _RESTING_FORCE_N)
        return (x, y, z - _FORCE_STEP_N if Fault.FORCE_STEP in self.faults else z, 0.0, 0.0, 0.0)

    def write_inputs(self, values: Mapping[str, Value]) -> None:
        """Take an input packet; any one feeds the watchdog."""
        self.watchdog.feed(self.time_s)
        for name, value in values.items():
            if name == "speed_slider_fraction":
                self.speed_scaling = float(value)  # type: ignore[arg-type]  # the recipe makes it scalar
            self.registers.write_input(name, value)

    def load(self, upload: Upload) -> None:
        """Replace the running program, once the arm has come to rest; nothing where the arm may not move."""
        if self.safety.may_move and not self.faults & {Fault.IGNORES_UPLOADS, Fault.LOCAL_CONTROL}:
            self.stop_program()
            self._next_upload = upload

    def stop_program(self) -> None:
        """End the program and its motion; neither can be resumed."""
        self.watchdog.disarm()
        self._program = None
        self._next_upload = None
        self.arm.hold()
        self.runtime_state = RuntimeState.STOPPING

    def pause(self) -> bool:
        """Hold the program and brake its motion; False unless one is playing."""
        if self.runtime_state is not RuntimeState.PLAYING:
            return False
        self.arm.hold()
        self.runtime_state = RuntimeState.PAUSING
        return True

    def play(self) -> bool:
        """Go on with a held program, its motion included; False where there is none or the arm may not move."""
        if self.runtime_state not in _PAUSED_STATES or not self.safety.may_move:
            return False
        self.arm.release()
        self.watchdog.feed(self.time_s)
        self.runtime_state = RuntimeState.PLAYING
        return True

    def stop_protectively(self) -> None:
        """Latch a protective stop."""
        self.safety.stop_protectively(self.time_s)

    def power_off(self) -> None:
        """Brakes on, program over."""
        self.safety.power_off()
        self.stop_program()

    def lose_power(self) -> None:
        """The brakes fall in at once; what ran and what was counted is gone."""
        self.power_off()
        self.arm.drop_motion()
        self.cycles = 0

    def cycle(self) -> None:
        """One controller cycle: safety, program, joints."""
        if Fault.SWITCHED_OFF in self.faults:
            self.lose_power()
        self.cycles += 1
        self.safety.update(self.faults, self.time_s)
        if not self.safety.may_move:
            self._hold_for_safety()
        if Fault.LOCAL_CONTROL in self.faults and self._program is not None:
            self.stop_program()
        if self.watchdog.tripped(self.time_s) and self.runtime_state is RuntimeState.PLAYING:
            self._watchdog_bites()
        self._advance_program()
        if not self.arm.advance(self.settings.cycle_s, self.speed_scaling):
            self.stop_protectively()
        self._settle()
        self._record()

    def _hold_for_safety(self) -> None:
        ends = self.safety.mode in _PROGRAM_ENDING_STOPS or self.safety.robot_mode is not RobotMode.RUNNING
        if ends or not self.settings.protective_stop_pauses:
            if self.runtime_state not in _STOPPED_STATES:
                self.stop_program()
        else:
            self.pause()
        if self.runtime_state is RuntimeState.STOPPED and self.arm.moving:
            self.arm.hold()  # a jog

    def _watchdog_bites(self) -> None:
        self.log.add(0, "watchdog")
        if self.settings.watchdog_outcome is WatchdogOutcome.PROTECTIVE_STOP:
            self.watchdog.disarm()
            self.stop_protectively()
        else:
            self.stop_program()

    def _advance_program(self) -> None:
        if self._next_upload is not None and self.arm.at_rest:
            self._start(self._next_upload)
        if self._program is None or self.runtime_state is not RuntimeState.PLAYING:
            return
        try:
            goes_on = self._program.cycle()
        except ProgramError as error:
            self.log.add(0, "program_error", str(error))
            goes_on = False
        if not goes_on:
            self.stop_program()

    def _start(self, upload: Upload) -> None:
        self.arm.drop_motion()
        self._next_upload = None
        kind = ControlProgram if upload.name == CONTROL_PROGRAM else OtherProgram
        self._program = kind(self, upload)
        self.runtime_state = RuntimeState.PLAYING

    def _settle(self) -> None:
        """Report stopped or paused once the arm is at rest; a motion without a program is over then."""
        if not self.arm.at_rest:
            return
        if self.runtime_state is RuntimeState.PAUSING:
            self.runtime_state = RuntimeState.PAUSED
        elif self.runtime_state in _STOPPED_STATES:
            self.arm.drop_motion()
            if self._next_upload is None:
                self.runtime_state = RuntimeState.STOPPED

    def _record(self) -> None:
        x, y, z = self.arm.base_from_tcp[:3, 3].tolist()
        vx, vy, vz = self.arm.tcp_velocity[:3].tolist()
        speed = (vx * vx + vy * vy + vz * vz) ** 0.5
        joints = tuple(self.arm.joints_rad.tolist())
        self.log.add_sample(ArmSample(time.monotonic(), self.time_s, joints, (x, y, z), speed))
