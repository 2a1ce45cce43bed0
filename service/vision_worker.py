"""Image work in a process of its own, with a deadline and a memory limit; never on the event loop.

Answers are JSON-able and as `contract.md` has them: `{"status": "refused", "reason": {...}}` where the image or the
geometry says no. ServiceError (VISION_DEADLINE, VISION_CRASHED, VISION_OUT_OF_MEMORY) is only for work that failed.
"""

from typing import Any

from service.settings import VisionSettings

Json = dict[str, Any]


class VisionWorker:
    """One spawned process; jobs wait for one another. Started at the first job, again after a crash or deadline."""

    def __init__(self, settings: VisionSettings) -> None:
        self._settings = settings

    async def start(self) -> None:
        """Start the process ahead of the first job, so that the first image does not pay for the imports."""
        raise NotImplementedError

    async def close(self) -> None:
        """End the process."""
        raise NotImplementedError

    async def register(self, image: bytes, guide: bytes, carm: bytes) -> Json:
        """`coaxial register` on bytes; the image's path is left out."""
        raise NotImplementedError

    async def target(self, registration: Json, pixel: tuple[float, float], space: str, depth_mm: float) -> Json:
        """`coaxial target` from a registration's JSON."""
        raise NotImplementedError

    async def evaluate(
        self, image: bytes, guide: bytes, carm: bytes, pixel: tuple[float, float], space: str, depth_mm: float
    ) -> Json:
        """`coaxial evaluate` on bytes; the contour registration is inside, for a correction."""
        raise NotImplementedError

    async def describe(self, image: bytes) -> Json:
        """What decoding says of an image: rows, columns, bits, pixel hash; or refused."""
        raise NotImplementedError
