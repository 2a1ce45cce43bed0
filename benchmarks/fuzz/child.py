"""A process that may crash or hang: `python -m benchmarks.fuzz.child TARGET FIRST COUNT FILE`.

FILE holds the number under way, eight bytes; standard output what came of all. An execution of more than a second of
this process's own time ends it by a signal, in the middle of a library's C code too.
"""

import json
import mmap
import os
import resource
import signal
import struct
import sys
import warnings
from pathlib import Path

from benchmarks.fuzz.target import tried
from benchmarks.fuzz.targets import TARGETS
from service.settings import VisionSettings

LONGEST_S = 1.0


def main(name: str, first: int, count: int, file: Path) -> None:
    """Execute the numbers and say what came of them."""
    inputs = TARGETS[name].inputs()
    memory_bytes = VisionSettings().memory_bytes
    resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    answer = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.dup2(1, 2)  # decoders complain by the million
    warnings.simplefilter("ignore")
    with file.open("r+b") as opened, mmap.mmap(opened.fileno(), 8) as shared:

        def begins(number: int) -> None:
            shared[:] = struct.pack("<q", number)
            signal.setitimer(signal.ITIMER_PROF, LONGEST_S)

        result = tried(inputs, range(first, first + count), begins)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    os.write(answer, json.dumps({"kinds": result.kinds, "found": result.found}).encode())


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), Path(sys.argv[4]))
