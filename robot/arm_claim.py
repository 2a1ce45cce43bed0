"""One register of the controller, held as long as its connection lives: a second orchestrator finds it in use (H19)."""

import socket
import time

from robot.errors import ArmClaimedError, ArmUnreachableError, ControllerRefusedError
from robot.rtde_frames import INPUTS, RTDE_PORT, ask, negotiate

# The upper half is meant for RTDE clients (PolyScope 3.9 and later), the lower for field buses; the library that drives
# the arm uses the first of the lower half.
_REGISTER = b"input_int_register_47"
_ANSWER_S = 1.0  # for all answers together: they come within a cycle or two
_IN_USE = b"IN_USE"
_READ_BYTES, _MOST_READS = 4096, 64  # of text messages since the last look; who sends more is no controller


class ArmClaim:
    """The claim of one arm; the end of the process, however it comes, gives it up."""

    def __init__(self, address: str) -> None:
        self._address = address
        self._socket: socket.socket | None = None

    def take(self) -> None:
        """Hold the arm, or go on holding it.

        Raises
        ------
        ArmClaimedError
            If somebody else holds it.
        ArmUnreachableError
            If the controller does not answer.
        ControllerRefusedError
            If its answer is another than the protocol has.
        """
        if self._is_held():
            return
        try:
            self._socket = socket.create_connection((self._address, RTDE_PORT), _ANSWER_S)
            self._negotiate(self._socket, time.monotonic() + _ANSWER_S)
            self._socket.setblocking(False)
        except OSError as error:
            self.give_up()
            raise ArmUnreachableError(f"the controller at {self._address} does not answer") from error
        except (ArmClaimedError, ControllerRefusedError):
            self.give_up()
            raise

    def give_up(self) -> None:
        """Close the connection, and with it the claim."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _is_held(self) -> bool:
        """The controller says nothing more on this connection but that it closes."""
        if self._socket is None:
            return False
        try:
            for _ in range(_MOST_READS):
                if not self._socket.recv(_READ_BYTES):
                    break
        except BlockingIOError:
            return True
        except OSError:
            pass
        self.give_up()
        return False

    def _negotiate(self, connection: socket.socket, end_s: float) -> None:
        if not negotiate(connection, end_s):
            raise ControllerRefusedError("the controller does not speak version 2 of RTDE")
        _, *words = ask(connection, INPUTS, _REGISTER, end_s)
        if bytes(words) == _IN_USE:
            raise ArmClaimedError(f"the arm at {self._address} is run by somebody else")
        if bytes(words) != b"INT32":
            raise ControllerRefusedError(f"the controller does not give {_REGISTER.decode()} away")
