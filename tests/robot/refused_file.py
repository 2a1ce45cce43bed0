"""What a device file is told when it cannot be used."""

from collections.abc import Callable

import pytest


def refused_in_one_line(read: Callable[[bytes], object], text: str, named: str) -> None:
    """Nobody reads it, and one line names what is wrong with it."""
    with pytest.raises(ValueError, match=named) as caught:
        read(text.encode())
    assert "\n" not in str(caught.value)
