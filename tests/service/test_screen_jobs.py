"""What a screen shows of an image: every bit of its pixels, and the lines over them in its own raw pixels."""

import asyncio
import io
from types import SimpleNamespace

import numpy as np
from fastapi import Response
from PIL import Image

from service import vision_jobs
from service.auth.permissions import Permission
from service.conductor.command_permissions import command_permissions
from service.conductor.routers import CONDUCTOR_ROUTERS
from service.images import pixels
from service.settings import VisionSettings
from service.vision_worker import VisionWorker
from workflow.triggers import REQUESTS, Trigger

# Asked for otherwise than by a route of its own name: a held button, and reading.
_NO_ROUTE = {Trigger.MOVE_STARTED, Trigger.READ, Trigger.EXPORT, Trigger.STOP}


def _png(pixels: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()


def test_sixteen_bits_arrive_to_the_last():
    pixels = np.random.default_rng(1).integers(0, 65536, (300, 280), dtype=np.uint16)
    pixels[0, :2] = (65535, 1)
    answer = vision_jobs.pixels(_png(pixels))
    assert (answer["rows"], answer["columns"], answer["bits"]) == (300, 280, 16)
    np.testing.assert_array_equal(np.frombuffer(answer["pixels"], "<u2").reshape(300, 280), pixels)


def test_eight_bits_stay_eight():
    pixels = np.random.default_rng(2).integers(0, 256, (256, 256), dtype=np.uint8)
    answer = vision_jobs.pixels(_png(pixels))
    assert answer["bits"] == 8
    np.testing.assert_array_equal(np.frombuffer(answer["pixels"], "<u2").reshape(256, 256), pixels)


def test_what_is_no_image_is_refused():
    assert vision_jobs.pixels(b"no image")["status"] == "refused"
    assert vision_jobs.overlay(b"no image", {}, [])["status"] == "refused"


def test_however_many_pictures_are_asked_for_a_registration_waits_for_few(monkeypatch):
    under_way, most = 0, 0

    async def decode(*_asked: object) -> dict:
        nonlocal under_way, most
        under_way, most = under_way + 1, max(most, under_way + 1)
        await asyncio.sleep(0.0)
        under_way -= 1
        return {"status": "ok", "rows": 1, "columns": 1, "bits": 8, "pixels": b"\0\0"}

    async def ask_for_many() -> list[Response]:
        vision = VisionWorker(VisionSettings())
        monkeypatch.setattr(vision, "run", decode)
        parts = SimpleNamespace(vision=vision)
        return await asyncio.gather(*(pixels.read_pixels("image", parts) for _ in range(50)))

    monkeypatch.setattr(pixels, "_original", lambda _parts, _image_id: b"")
    assert len(asyncio.run(ask_for_many())) == 50
    assert 1 <= most <= 2


def test_every_request_tells_which_permission_it_asks_for():
    told = command_permissions(CONDUCTOR_ROUTERS)
    assert set(REQUESTS) - _NO_ROUTE <= told.keys()
    assert told[Trigger.MOVE_APPROVED] is Permission.APPROVE
    assert told[Trigger.EXPOSURE_REQUESTED] is Permission.EXPOSE
