"""A few thousand executions of what `make evidence` does by the million: hostile input is taken or refused, typed."""

import pytest

from benchmarks.fuzz.mutation import changes_of_bytes
from benchmarks.fuzz.target import Input, tried
from benchmarks.fuzz.targets import TARGETS

_EXECUTIONS = {
    "dicom": 100,
    "pictures": 200,
    "device_files": 1000,
    "json": 2000,
    "hold_frames": 2000,
    "controller": 1000,
}


@pytest.mark.hazard("H31")
@pytest.mark.filterwarnings("ignore")  # what a library remarks on hostile bytes decides nothing
@pytest.mark.parametrize("name", TARGETS)
def test_hostile_input_is_taken_or_refused_with_a_type(name) -> None:
    result = tried(TARGETS[name].inputs(), range(_EXECUTIONS[name]))
    assert result.found == []
    assert len(result.kinds) > 2, "all of it met the same end: this proves little"


def test_what_a_reader_raises_is_found_by_its_number() -> None:
    def read(data: bytes) -> str:
        if data == b"valid":
            return "taken"
        raise KeyError("surprised")

    result = tried([Input(b"valid", changes_of_bytes(5, [b"valid"]), read)], range(50))
    assert len(result.found) == result.kinds["untyped"] > 40
    assert {raised for _, raised in result.found} == {"KeyError: 'surprised'"}
    number = result.found[0][0]
    assert tried([Input(b"valid", changes_of_bytes(5, [b"valid"]), read)], [number]).found == result.found[:1]
