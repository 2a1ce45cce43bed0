"""An OpenIGTLink server: whoever connects is told where everything is, and cannot tell anything back.

pyigtl packs the messages; its own server takes one client at a time, and the process's signal handlers with it.
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import numpy as np
import structlog
from fastapi import FastAPI

from service.conductor.conductor import Conductor
from service.errors import ErrorCode, ServiceError
from service.images.store import original_bytes
from service.parts import Parts
from service.slicer import messages
from service.slicer.scene import Scene, read_scene

_log = structlog.get_logger(__name__)
_POSE_STEP_S = 0.1
_SCENE_STEP_S = 0.5
_MOST_WATCHERS = 8
# A watcher that takes nothing for this long is let go: it must not fill this process's memory.
_STALLED_S = 5.0


@asynccontextmanager
async def linking(app: FastAPI, parts: Parts) -> AsyncIterator[None]:
    """Serve until the end of the block; nothing to do where the settings name no port."""
    settings = parts.settings.slicer
    if settings.port is None:
        yield
        return
    watching = _Watching(app.state.conductor)
    try:
        server = await asyncio.start_server(watching.serve, settings.host, settings.port)
    except OSError as error:
        message = f"cannot listen for 3D Slicer on {settings.host}:{settings.port} ({error.strerror})"
        raise ServiceError(ErrorCode.SETTINGS_REFUSED, message) from error
    try:
        yield
    finally:
        server.close()
        await watching.end()


class _Watching:
    """Every watcher that is connected."""

    def __init__(self, conductor: Conductor) -> None:
        self._conductor = conductor
        self._writers: dict[asyncio.StreamWriter, asyncio.Task[None]] = {}

    async def serve(self, _: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """One connection, from its beginning to its end; what a watcher says is not read."""
        task = asyncio.current_task()
        if task is None or len(self._writers) >= _MOST_WATCHERS:
            writer.close()
            return
        self._writers[writer] = task
        try:
            await _Watcher(self._conductor, writer).tell()
        except* (ConnectionError, TimeoutError):
            _log.info("slicer_gone")
        except* ServiceError as errors:
            _log.warning("slicer_left", reasons=[str(error) for error in errors.exceptions])
        finally:
            del self._writers[writer]
            writer.close()

    async def end(self) -> None:
        """Hang up, and wait until each has noticed; a connection's task that is cancelled makes asyncio complain."""
        tasks = list(self._writers.values())
        for writer in self._writers:
            writer.close()
        await asyncio.gather(*tasks)


class _Watcher:
    """What one watcher has been told already."""

    def __init__(self, conductor: Conductor, writer: asyncio.StreamWriter) -> None:
        self._conductor = conductor
        self._parts: Parts = conductor.parts
        self._writer = writer
        self._told: Scene | None = None

    async def tell(self) -> None:
        """Poses all the time, whatever image work there is, and the rest as it changes; until the connection ends."""
        async with asyncio.TaskGroup() as telling:
            telling.create_task(self._tell_poses())
            telling.create_task(self._tell_scenes())

    async def _tell_poses(self) -> None:
        while True:
            await self._tell_pose()
            await asyncio.sleep(_POSE_STEP_S)

    async def _tell_scenes(self) -> None:
        while True:
            await self._tell_scene()
            await asyncio.sleep(_SCENE_STEP_S)

    async def _tell_pose(self) -> None:
        reading = self._conductor.bridge.watch.reading()
        if reading is not None and reading.arm is not None:
            await self._write(messages.transform(messages.GUIDE, reading.arm.base_from_tcp))

    async def _tell_scene(self) -> None:
        scene, told = await asyncio.to_thread(read_scene, self._parts), self._told
        self._told = scene
        if told is None or scene.state != told.state:
            await self._write(messages.status(scene.state))
        for name, now in ((messages.GOAL, scene.goal), (messages.TARGET, scene.target)):
            if now is not None:
                await self._write(messages.transform(name, now))
        if scene.image_id is not None and (told is None or scene.image_id != told.image_id):
            await self._tell_image(scene.image_id)

    async def _tell_image(self, image_id: str) -> None:
        content = await asyncio.to_thread(self._original, image_id)
        decoded = await self._parts.vision.run("pixels", content)
        if decoded["status"] == "refused":
            return
        pixels = np.frombuffer(decoded["pixels"], "<u2").reshape(decoded["rows"], decoded["columns"])
        await self._write(messages.image(pixels))

    def _original(self, image_id: str) -> bytes:
        with self._parts.database.read() as connection:
            return original_bytes(connection, image_id)

    async def _write(self, message: bytes) -> None:
        if self._writer.is_closing():
            raise ConnectionError("the watcher or the service hangs up")
        self._writer.write(message)
        async with asyncio.timeout(_STALLED_S):
            await self._writer.drain()
