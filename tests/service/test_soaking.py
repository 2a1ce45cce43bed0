"""How the soak of `make evidence` judges what a service held after each procedure."""

from benchmarks.evidence.soak import MOST_KB, Used, growing, leaking, told

_WARMING = [Used(56, {"service": 370.0 + number, "guard": 30.0}) for number in range(20)]
_SAW = [0.3, -0.2, 0.1]  # MB, of an allocator that takes and gives back


def _held(grown_kb: float, opened: int = 0) -> list[Used]:
    """What is held after each of a hundred procedures, the first fifth of them warming up: the guard grows."""
    return _WARMING + [
        Used(56 + opened * at, {"service": 390.0 + _SAW[at % 3], "guard": 30.0 + grown_kb * at / 1e3})
        for at in range(80)
    ]


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


def test_the_growth_is_told_of_each_part_the_largest_first():
    assert told(_held(25.0)).endswith("by part guard +25.0, service -0.1")
