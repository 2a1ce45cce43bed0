"""The watchdog that a program may arm on the input registers."""


class Watchdog:
    """Trips when no input packet came for longer than its period; armed while the frequency is above zero."""

    def __init__(self) -> None:
        self.frequency_hz = 0.0
        self._fed_at_s = 0.0

    def feed(self, now_s: float) -> None:
        """An input packet came."""
        self._fed_at_s = now_s

    def disarm(self) -> None:
        """The program that armed it has ended."""
        self.frequency_hz = 0.0

    def tripped(self, now_s: float) -> bool:
        """Whether the last packet is too long ago."""
        return self.frequency_hz > 0.0 and now_s - self._fed_at_s > 1.0 / self.frequency_hz
