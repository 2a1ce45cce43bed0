"""Which trial raised, of an item that takes its numbers in another order than they are given."""

from collections.abc import Iterator
from contextlib import contextmanager


class TrialError(Exception):
    """What the trial of a number raised is its cause."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


@contextmanager
def trial_of(number: int) -> Iterator[None]:
    """Say of which number an error is."""
    try:
        yield
    except Exception as error:
        raise TrialError(number) from error
