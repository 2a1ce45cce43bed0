"""How the soak of `make evidence` judges what a service held after each procedure."""

from benchmarks.evidence.soak import MOST_KB, growing, leaking, told

_WARMING = [(56, 400.0 + number) for number in range(20)]
_SAW = [0.3, -0.2, 0.1]  # MB, of an allocator that takes and gives back


def _held(grown_kb: float, opened: int = 0) -> list[tuple[int, float]]:
    """Descriptors and MB after each of a hundred procedures, the first fifth of them warming up."""
    settled = range(80)
    return _WARMING + [(56 + opened * at, 420.0 + grown_kb * at / 1e3 + _SAW[at % 3]) for at in settled]


def test_what_was_made_once_is_no_leak():
    assert (leaking(_held(0.0)), growing(_held(0.0))) == ("", "")


def test_a_descriptor_a_procedure_is_told():
    assert leaking(_held(0.0, opened=1)) == "135 descriptors, 56 once all was settled"


def test_memory_that_may_grow_by_more_than_is_allowed_is_told():
    assert growing(_held(0.5 * MOST_KB)) == ""
    assert growing(_held(1.5 * MOST_KB)).startswith("memory may grow by ")


def test_of_a_few_procedures_no_slope_is_told():
    assert growing(_held(100.0)[:9]) == ""
    assert "too few" in told(_held(100.0)[:9])
