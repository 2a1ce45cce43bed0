"""The real jobs in the real worker: bad images come back as refusals, and a good start fits the memory limit."""

import asyncio

import pytest

from service.settings import VisionSettings
from service.vision_worker import VisionWorker


@pytest.fixture(scope="module")
def ask():
    """Run jobs one after another in one worker with the limits that a site gets."""

    async def whole(jobs):
        worker = VisionWorker(VisionSettings())
        try:
            return [await worker.run(name, *arguments) for name, *arguments in jobs]
        finally:
            await worker.close()

    return lambda *jobs: asyncio.run(whole(jobs))


def _codes(answers) -> list[str]:
    assert {answer["status"] for answer in answers} == {"refused"}
    return [answer["reason"]["code"] for answer in answers]


def test_bad_images_are_refused_with_a_code(ask, make_xray, device_files):
    devices = (device_files["guide"].encode(), device_files["carm"].encode())
    huge = make_xray(Rows=10_000, Columns=10_000)  # 100 megapixels by its header
    answers = ask(
        ("register", b"no image", *devices),
        ("register", b"", *devices),
        ("register", make_xray()[:-5000], *devices),
        ("register", make_xray(rows=1, columns=1), *devices),
        ("register", huge, *devices),
        ("register", make_xray(rows=256, columns=256), *devices),  # noise: an image without a guide
        ("evaluate", b"no image", *devices, (1.0, 1.0), 80.0, {"image": b"none either"}),
    )
    assert _codes(answers)[4] == "image_too_large"
    assert all(answer["reason"]["message"] for answer in answers)


def test_a_planned_path_gives_carm_angles_and_one_of_no_length_is_refused(ask):
    straight, none = ask(
        ("carm_angles", (0.0, 80.0, 0.0), (0.0, 0.0, 0.0), "prone"),
        ("carm_angles", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), "prone"),
    )
    assert straight["status"] == "planned"
    assert _codes([none]) == ["path_implausible"]
