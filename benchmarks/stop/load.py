"""What keeps the machine busy: a burner for each core or other commands, and the real image worker without a pause.

python -m benchmarks.stop.load burn|images
"""

import asyncio
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import TracebackType
from typing import Self

import cv2
import numpy as np

from service.settings import VisionSettings
from service.vision_worker import VisionWorker
from simulator.carm.drawing import random_scene
from simulator.carm.quick_render import render_quickly
from simulator.devices import GUIDE_FILE, INTENSIFIER_FILE

_FULL_AGAIN_S = 0.1  # the image worker, which runs behind everything else, has its turn by then


class Load:
    """Processes that run for as long as the context, but for what is prepared between two trials."""

    def __init__(self, wanted: bool = True, busy: Sequence[Sequence[str]] = ()) -> None:
        """`busy`: commands that keep the cores busy in place of the burners."""
        own = [sys.executable, "-m", "benchmarks.stop.load"]
        burners = busy or [[*own, "burn"]] * (os.cpu_count() or 1)
        self._commands = [*burners, [*own, "images"]] if wanted else []
        self._processes: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> Self:
        self._processes = [subprocess.Popen(command, start_new_session=True) for command in self._commands]
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        for process in self._processes:
            os.killpg(process.pid, signal.SIGKILL)  # the image worker is a process of its own
            process.wait()

    @contextmanager
    def paused(self) -> Iterator[None]:
        """No load while a service starts or a case is led somewhere: none of that is measured."""
        self._signal(signal.SIGSTOP)
        yield
        self._signal(signal.SIGCONT)
        time.sleep(_FULL_AGAIN_S)

    def _signal(self, number: signal.Signals) -> None:
        for process in self._processes:
            if process.poll() is not None:
                raise RuntimeError("a process of the load has ended: what is measured from here on is not under load")
            os.killpg(process.pid, number)


def burn() -> None:
    """One core, for ever."""
    while True:
        sum(range(100_000))


async def register_images() -> None:
    """One image after the other, decoded and registered by the service's own worker, however slowly."""
    image = render_quickly(random_scene(1), 1)
    encoded = cv2.imencode(".png", np.asarray(image.pixels, dtype=np.uint16))[1].tobytes()
    worker = VisionWorker(VisionSettings(deadline_s=3600.0, start_deadline_s=3600.0))
    while True:
        await worker.run("register", encoded, GUIDE_FILE.read_bytes(), INTENSIFIER_FILE.read_bytes())


if __name__ == "__main__":
    if sys.argv[1] == "burn":
        burn()
    asyncio.run(register_images())
