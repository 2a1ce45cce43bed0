"""Registers and targets every sample image of a folder and prints what that leaves to be desired.

    python benchmarks/samples.py SAMPLES_FOLDER

The folder holds NNN.png beside NNN.json (the truth), and `../reference` from it holds the device files that the truth
names. Each image is also flipped, which must be refused as mirrored, and turned, which must change nothing. The exit
status is 1 where a requirement is missed.
"""

import argparse
import json
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.devices import CArm, Guide, read_carm, read_guide
from vision.refusal import Refusal, RefusalCode
from vision.registered import DEFAULT_DEPTH_MM, Method, PixelSpace, PredictedError, Registration
from vision.registration import register
from vision.targeting import target
from vision.xray import decode

Array = NDArray[np.float64]

GREATEST_ANGLE_DEG = 0.15
GREATEST_POSITION_MM = 0.40
# a turned image has other pixels under other noise, so its error is the same only within the noise of the fit
SAME_ANGLE_DEG = 0.02
SAME_POSITION_MM = 0.05

FLIPS: dict[str, Callable[[NDArray[Any]], NDArray[Any]]] = {
    "left-right": np.fliplr,
    "up-down": np.flipud,
    "transposed": np.transpose,
    "anti-transposed": lambda pixels: np.rot90(pixels, 2).T,
}


@dataclass(frozen=True)
class Sample:
    """One image with its truth and device files."""

    name: str
    pixels: NDArray[Any]
    truth: dict[str, Any]
    guide: Guide
    carm: CArm


@dataclass(frozen=True)
class Score:
    """Errors of one commanded move, and what was predicted."""

    angle_deg: float
    position_mm: float
    bound: PredictedError
    elapsed_ms: float

    @property
    def is_good(self) -> bool:
        """Whether the errors are within the requirement."""
        return self.angle_deg <= GREATEST_ANGLE_DEG and self.position_mm <= GREATEST_POSITION_MM

    @property
    def is_inside_bound(self) -> bool:
        """Whether the prediction held."""
        within = self.angle_deg <= math.degrees(self.bound.angle_rad)
        return within and self.position_mm <= self.bound.position_mm

    def is_like(self, other: "Score") -> bool:
        """Whether a turned image gave the same error."""
        same_angle = abs(self.angle_deg - other.angle_deg) <= SAME_ANGLE_DEG
        return same_angle and abs(self.position_mm - other.position_mm) <= SAME_POSITION_MM


def samples(folder: Path) -> Iterator[Sample]:
    """Every sample of the folder, by name."""
    reference = folder.resolve().parent / "reference"
    for path in sorted(folder.glob("*.json")):
        truth = json.loads(path.read_text())
        pixels = cv2.imread(str(folder / truth["image"]), cv2.IMREAD_UNCHANGED)
        if pixels is None:
            sys.exit(f"{folder / truth['image']}: no image")
        guide = read_guide((reference / truth["guide"]).read_bytes())
        carm = read_carm((reference / truth["carm"]).read_bytes())
        yield Sample(path.stem, pixels, truth, guide, carm)


def registered(sample: Sample, pixels: NDArray[Any], method: Method) -> Registration | Refusal:
    """The registration of (turned or flipped) pixels, through the decoder as any image."""
    image = decode(cv2.imencode(".png", np.ascontiguousarray(pixels))[1].tobytes())
    return image if isinstance(image, Refusal) else register(image, sample.guide, sample.carm, method)


def scored(sample: Sample, quarter_turns: int, method: Method = Method.CONTOUR) -> Score | Refusal:
    """The error of the commanded move, from the image turned counter-clockwise."""
    registration = registered(sample, np.rot90(sample.pixels, quarter_turns), method)
    if isinstance(registration, Refusal):
        return registration
    pixel = turned_pixel(sample, quarter_turns)
    targeting = target(registration, pixel, PixelSpace.RAW)
    if isinstance(targeting, Refusal):
        return targeting
    angle_deg, position_mm = errors(sample, targeting.guide_from_goal)
    return Score(angle_deg, position_mm, targeting.predicted_error_95, registration.elapsed_ms)


def turned_pixel(sample: Sample, quarter_turns: int) -> tuple[float, float]:
    """The target's raw pixel in the turned image."""
    u, v = sample.truth["target_raw_px"]
    rows, columns = sample.pixels.shape[:2]
    for _ in range(quarter_turns):
        u, v = v, columns - 1 - u
        rows, columns = columns, rows
    return u, v


def errors(sample: Sample, guide_from_goal: Array) -> tuple[float, float]:
    """Angle (deg) between the moved guide's axis and the true target ray, distance (mm) of the true target from it."""
    truth = sample.truth
    source_from_guide = np.array(truth["source_from_guide_mm"])
    source_from_goal = source_from_guide @ guide_from_goal
    on_detector_mm = np.subtract(truth["target_ideal_px"], truth["principal_point_ideal_px"]) * truth["pixel_size_mm"]
    ray = np.array([*on_detector_mm, truth["source_to_image_distance_mm"]])
    ray /= np.linalg.norm(ray)
    distance_mm = np.linalg.norm(source_from_guide[:3, 3]) - sample.guide.separation_mm - DEFAULT_DEPTH_MM
    axis, on_axis = source_from_goal[:3, 2], source_from_goal[:3, 3]
    angle_rad = math.atan2(float(np.linalg.norm(np.cross(axis, ray))), float(axis @ ray))
    return math.degrees(angle_rad), float(np.linalg.norm(np.cross(ray * distance_mm - on_axis, axis)))


def row(sample: Sample) -> tuple[str, list[str]]:
    """One line of the table, and the requirements that this sample misses."""
    straight, linear = scored(sample, 0), scored(sample, 0, Method.PAPER)
    flips = {name: registered(sample, flip(sample.pixels), Method.CONTOUR) for name, flip in FLIPS.items()}
    turns = {90 * quarters: scored(sample, quarters) for quarters in (1, 2, 3)}
    missed = list(_missed(straight, flips, turns))
    refused = sum(_is_mirrored(flip) for flip in flips.values())
    worst = max((turn.angle_deg if isinstance(turn, Score) else math.inf for turn in turns.values()), default=0.0)
    line = (
        f"{sample.name:>6} {sample.truth.get('group', ''):>7} {_text(straight):<46} {_text(linear, bounds=False):<18} "
        f"{refused} of {len(flips)}   {worst:8.4f}"
    )
    return line, [f"{sample.name}: {text}" for text in missed]


def _missed(
    straight: Score | Refusal, flips: dict[str, Registration | Refusal], turns: dict[int, Score | Refusal]
) -> Iterator[str]:
    if not isinstance(straight, Score):
        yield f"not registered: {straight.code}: {straight.message} ({straight.measured}, limit {straight.limit})"
        return
    if not straight.is_good:
        yield f"{straight.angle_deg:.4f} deg, {straight.position_mm:.4f} mm is too much"
    for name, flip in flips.items():
        if not _is_mirrored(flip):
            yield f"{name} is not refused as mirrored: {flip.code if isinstance(flip, Refusal) else 'registered'}"
    for turn_deg, turn in turns.items():
        if isinstance(turn, Refusal):
            yield f"turned by {turn_deg} deg is refused: {turn.code}: {turn.message}"
        elif not turn.is_good or not turn.is_like(straight):
            yield f"turned by {turn_deg} deg has another error: {turn.angle_deg:.4f} deg, {turn.position_mm:.4f} mm"


def _is_mirrored(flip: Registration | Refusal) -> bool:
    return isinstance(flip, Refusal) and flip.code is RefusalCode.MIRRORED


def _text(score: Score | Refusal, bounds: bool = True) -> str:
    if isinstance(score, Refusal):
        return str(score.code)
    figures = f"{score.angle_deg:8.4f} {score.position_mm:8.4f}"
    if not bounds:
        return figures
    bound_deg, held = math.degrees(score.bound.angle_rad), " " if score.is_inside_bound else "!"
    return f"{figures} {bound_deg:8.4f} {score.bound.position_mm:8.4f}{held}{score.elapsed_ms:8.0f}"


def main() -> None:
    """Print the table; exit 1 where a requirement is missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder of NNN.png and NNN.json")
    folder = parser.parse_args().folder
    print(f"{'':>14} {'contour: error, predicted 95 %, time':<46} {'paper: error':<18} flips    turns")
    print(f"{'sample':>6} {'group':>7} {'deg':>8} {'mm':>8} {'deg':>8} {'mm':>8} {'ms':>8} {'':<1}{'deg':>8} {'mm':>8}")
    missed: list[str] = []
    count = 0
    for count, sample in enumerate(samples(folder), start=1):  # noqa: B007  the count is reported below
        line, misses = row(sample)
        print(line, flush=True)
        missed += misses
    if not count:
        sys.exit(f"{folder}: no samples")
    print(f"\n{count} samples, {len(missed)} requirements missed" + "".join(f"\n  {text}" for text in missed))
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
