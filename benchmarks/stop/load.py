"""What keeps the machine busy: a burner for each core, and the real image worker without a pause.

python -m benchmarks.stop.load burn|images
"""

import asyncio
import os
import subprocess
import sys
from types import TracebackType
from typing import Self

import cv2
import numpy as np

from service.settings import VisionSettings
from service.vision_worker import VisionWorker
from simulator.carm.drawing import random_scene
from simulator.carm.quick_render import render_quickly
from simulator.devices import GUIDE_FILE, INTENSIFIER_FILE


class Load:
    """Processes that run for as long as the context."""

    def __enter__(self) -> Self:
        jobs = ["burn"] * (os.cpu_count() or 1) + ["images"]
        command = [sys.executable, "-m", "benchmarks.stop.load"]
        self._processes = [subprocess.Popen([*command, job]) for job in jobs]
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        for process in self._processes:
            process.terminate()
        for process in self._processes:
            process.wait()


def burn() -> None:
    """One core, for ever."""
    while True:
        sum(range(100_000))


async def register_images() -> None:
    """One image after the other, decoded and registered by the service's own worker."""
    image = render_quickly(random_scene(1), 1)
    encoded = cv2.imencode(".png", np.asarray(image.pixels, dtype=np.uint16))[1].tobytes()
    worker = VisionWorker(VisionSettings())
    while True:
        await worker.run("register", encoded, GUIDE_FILE.read_bytes(), INTENSIFIER_FILE.read_bytes())


if __name__ == "__main__":
    if sys.argv[1] == "burn":
        burn()
    asyncio.run(register_images())
