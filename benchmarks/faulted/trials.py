"""Scenes with one thing wrong each, registered and targeted: each fault is an item, a trial's number is its seed."""

import math
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import cv2

from benchmarks.evidence.code import ROOT
from benchmarks.evidence.item import Item, Trial
from benchmarks.samples import Sample, scored
from simulator.carm.faulted import Fault, faulted_scene
from simulator.carm.quick_render import render_quickly
from vision.devices import read_carm, read_guide
from vision.refusal import Refusal

WRONG_DEG, WRONG_MM = 0.5, 1.0
REGISTERED = "registered"
PLANNED = 100_000  # scenes, over all faults
_GUIDE_FILE = "tests/devices/guide.toml"  # the reference guide's, with whose tolerances the scenes are drawn
_CARM_FILES = "simulator/devices/carm-{}.toml"
_GUIDE = read_guide((ROOT / _GUIDE_FILE).read_bytes())
_INTENSIFIER, _FLAT_PANEL = (
    read_carm((ROOT / _CARM_FILES.format(kind)).read_bytes()) for kind in ("intensifier", "flat-panel")
)


def trials(fault: Fault, _inputs: Path, seeds: Sequence[int]) -> Iterator[Trial]:
    """One scene of each seed."""
    cv2.setNumThreads(1)
    for seed in seeds:
        yield {"number": seed} | _trial(fault, seed)


def _trial(fault: Fault, seed: int) -> Trial:
    """Render, register and target one scene; of a registered one errors and bounds, of a refused one the reason."""
    drawn = faulted_scene(fault, seed)
    image = render_quickly(drawn.scene, seed)
    pixels = image.pixels if drawn.flip is None else drawn.flip(image.pixels)
    carm = _INTENSIFIER if drawn.intensifier_file else _FLAT_PANEL
    score = scored(Sample(f"{fault}:{seed}", pixels, image.truth, _GUIDE, carm), 0)
    if isinstance(score, Refusal):
        said = f"{score.message} ({score.measured}, limit {score.limit})"
        return {"kind": score.code, "bad": False, "group": drawn.scene.group, "said": said}
    wrong = drawn.flip is not None or score.angle_deg > WRONG_DEG or score.position_mm > WRONG_MM
    return {
        "kind": REGISTERED,
        "bad": bool(wrong),
        "group": drawn.scene.group,
        "measured": {"deg": round(score.angle_deg, 4), "mm": round(score.position_mm, 4)},
        "bound": {"deg": round(math.degrees(score.bound.angle_rad), 4), "mm": round(score.bound.position_mm, 4)},
    }


def _seeds(_inputs: Path) -> int:
    return math.ceil(PLANNED / len(Fault))


ITEMS = {
    fault: Item(
        fault,
        fault.replace("_", " "),
        f"right within {WRONG_DEG} deg and {WRONG_MM} mm, or refused",
        _seeds,
        partial(trials, fault),
        at_once=20,
        modules=(__name__,),
        files=(_GUIDE_FILE, _CARM_FILES.format("*")),
    )
    for fault in Fault
}
