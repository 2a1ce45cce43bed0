"""The status word of asynchronous operations."""

_RUNNING = 1 << 15
_COUNT_SHIFT, _OPERATION_SHIFT = 16, 24
_SEVEN_BITS = 128


class AsyncStatus:
    """Bits 0-14 progress, 15 running, 16-22 number of changes, 24-30 number of the operation."""

    def __init__(self) -> None:
        self._changes = 0
        self._operation = 0
        self.word = 0
        self.finish()

    def start(self) -> None:
        """A new operation."""
        self.progress(0)

    def progress(self, value: int) -> None:
        """A step of the running operation; the first one, 0, counts as a new operation."""
        if value == 0:
            self._operation = (self._operation + 1) % _SEVEN_BITS
        self._change(_RUNNING | value)

    def finish(self) -> None:
        """The operation ended, or its thread was ended."""
        self._change(0)

    def _change(self, low_word: int) -> None:
        self._changes = (self._changes + 1) % _SEVEN_BITS
        self.word = low_word | self._changes << _COUNT_SHIFT | self._operation << _OPERATION_SHIFT
