"""Rendered images with their truth, registered once: what every method and finder starts from."""

import time
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.samples import Sample
from simulator.carm.drawing import random_scene
from simulator.carm.render import render
from simulator.carm.scene import Scene
from vision.devices import CArm, read_carm, read_guide
from vision.findings import Findings
from vision.registration import examine
from vision.xray import XrayImage, decode

Array = NDArray[np.float64]

GROUPS = ("ii", "steep", "strong", "flat")
_ROOT = Path(__file__).parents[2]
_DEVICES = _ROOT / "simulator" / "devices"
GUIDE = read_guide((_ROOT / "tests" / "devices" / "guide.toml").read_bytes())  # the reference guide and its tolerances
ROOM_GUIDE = read_guide((_DEVICES / "guide.toml").read_bytes())
INTENSIFIER = read_carm((_DEVICES / "carm-intensifier.toml").read_bytes())
_FLAT_PANEL = read_carm((_DEVICES / "carm-flat-panel.toml").read_bytes())


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """One image: how it was made, how it arrived, and what this project found in it."""

    group: str
    seed: int
    scene: Scene
    sample: Sample
    image: XrayImage
    findings: Findings
    cpu_ms: float  # of the whole registration, from the image


def received(pixels: NDArray[np.uint8] | NDArray[np.uint16]) -> XrayImage:
    """Pixels as the decoder hands them on."""
    image = decode(cv2.imencode(".png", pixels)[1].tobytes())
    if not isinstance(image, XrayImage):
        raise ValueError(f"a rendered image was refused: {image.message}")
    return image


def picture(group: str, seed: int) -> Picture:
    """The image of a group's seed, examined."""
    scene = random_scene(seed, group)
    rendered = render(scene, seed)
    carm: CArm = _FLAT_PANEL if group == "flat" else INTENSIFIER
    sample = Sample(f"{group}:{seed}", rendered.pixels, rendered.truth, GUIDE, carm)
    image = received(rendered.pixels)
    started_s = time.process_time()
    findings = examine(image, GUIDE, carm)
    return Picture(group, seed, scene, sample, image, findings, (time.process_time() - started_s) * 1000.0)
