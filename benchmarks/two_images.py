"""What the two-image checks see, and how often they see what is not there (H03, H34).

    python benchmarks/two_images.py [--cases N] [--pairs N] [--first SEED]

First the chi-square of the rings' motion against the arm's: N cases of simulated registrations with C-arm, guide, arm
and TCP drawn from their standard deviations, nothing else moved, then each of the sizes that must be seen. Then N
rendered pairs, registered as an image is: the same chi-square of real fits, and the shift of an anatomy that lay still,
that went 1 mm across the beam in a random direction, or 3 mm along it. Rates with 95 % Clopper-Pearson bounds. Exit
status 1 where a rate is worse than asked for beyond its bounds: 99 % seen and 0.5 % false alarms of motions, 95 % seen
of shifts.
"""

import argparse
import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.stats import beta, kstest

from benchmarks.simulated_pairs import STILL, Moved, Room, motion
from simulator.carm.drawing import random_scene
from simulator.carm.render import render
from simulator.carm.scene import Scene
from vision.corrected_image import CorrectedImage
from vision.devices import read_carm, read_guide
from vision.motion_agreement import CHI_SQUARE_LIMIT, MotionErrors, RelativeMotion, detectable_motion
from vision.refusal import Refusal
from vision.registered import Registration
from vision.registration import examine
from vision.two_images import Before, TwoImages, compare_images
from vision.xray import XrayImage, decode
from workflow.limits import Limits

Array = NDArray[np.float64]

ERRORS = MotionErrors(math.radians(0.02), 0.1, math.radians(0.05), 0.1)
NO_ARM = MotionErrors(0.0, 0.0, 0.0, 0.0)  # a rendered pair has none
DEPTH_MM = 80.0
_ROOT = Path(__file__).parents[1]
_CARM = read_carm((_ROOT / "simulator" / "devices" / "carm-intensifier.toml").read_bytes())
_GUIDE = read_guide((_ROOT / "tests" / "devices" / "guide.toml").read_bytes())  # the reference guide and its tolerances
_LIMITS = Limits()


@dataclass(frozen=True)
class Rate:
    """How many of how many, and what was asked for."""

    name: str
    count: int
    of: int
    least: float = 0.0
    most: float = 1.0

    @property
    def bounds(self) -> tuple[float, float]:
        """95 %, Clopper-Pearson."""
        low = beta.ppf(0.025, self.count, self.of - self.count + 1) if self.count else 0.0
        high = beta.ppf(0.975, self.count + 1, self.of - self.count) if self.count < self.of else 1.0
        return float(low), float(high)

    @property
    def is_worse(self) -> bool:
        """Worse than asked for, and not by chance."""
        low, high = self.bounds
        return high < self.least or low > self.most

    def __str__(self) -> str:
        """One line."""
        low, high = (100.0 * bound for bound in self.bounds)
        share = 100.0 * self.count / self.of
        asked = f"at least {100 * self.least:g} %" if self.least else f"at most {100 * self.most:g} %"
        bounds = f"({low:5.2f} to {high:6.2f})"
        return f"{self.name:<44} {self.count:>5} of {self.of:<5} {share:6.2f} %  {bounds}  asked: {asked}"


def across(rng: np.random.Generator) -> Array:
    """A unit vector across the beam."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def anyhow(rng: np.random.Generator) -> Array:
    """A unit vector."""
    drawn = rng.normal(size=3)
    return np.asarray(drawn / np.linalg.norm(drawn))


def still(_: np.random.Generator) -> Array:
    """Nothing moved."""
    return STILL


DISPLACED: dict[str, Callable[[np.random.Generator], Array]] = {
    "turned by 0.3 deg about any axis": lambda rng: motion(0.3 * anyhow(rng), np.zeros(3)),
    "shifted by 1.0 mm across the beam": lambda rng: motion(np.zeros(3), 1.0 * across(rng)),
    "shifted by 1.5 mm along the beam": lambda _: motion(np.zeros(3), np.array([0.0, 0.0, 1.5])),
}


def simulated_motions(cases: int, first: int) -> list[Rate]:
    """False alarms and sizes seen, by simulated registrations."""
    rates = []
    for name, displaced in {"nothing moved": still, **DISPLACED}.items():
        refused = 0
        for seed in range(first, first + cases):
            rng = np.random.default_rng([seed, 3])
            room = Room.draw(_GUIDE, _CARM, rng)
            compared = Moved.draw(room, rng).compared(rng, ERRORS, displaced(rng))
            refused += compared.chi_square > CHI_SQUARE_LIMIT
        asked = {"most": 0.005} if displaced is still else {"least": 0.99}
        rates.append(Rate(f"simulated, {name}", refused, cases, **asked))
        print(rates[-1], flush=True)
    return rates


def sizes(cases: int, first: int) -> None:
    """What 99 % of cases see: as told before the move, from one image, and as found with both."""
    told, found = [], []
    for seed in range(first, first + cases):
        rng = np.random.default_rng([seed, 3])
        moved = Moved.draw(Room.draw(_GUIDE, _CARM, rng), rng)
        told.append(_figures(detectable_motion(moved.room.seen(moved.before, rng), moved.planned, ERRORS)))
        found.append(_figures(moved.compared(rng, ERRORS).detectable))
    for name, figures in (("told before the move", told), ("found with both images", found)):
        middle, most = np.median(figures, axis=0), np.percentile(figures, 95, axis=0)
        across_mm = f"{middle[1]:.2f} ({most[1]:.2f}) mm across"
        along_mm = f"{middle[2]:.2f} ({most[2]:.2f}) mm along the beam"
        print(f"detectable, {name}, median (95 %): {middle[0]:.2f} ({most[0]:.2f}) deg, {across_mm}, {along_mm}")


def _figures(motion: RelativeMotion) -> tuple[float, float, float]:
    return math.degrees(motion.rotation_rad), motion.across_mm, motion.along_mm


def registered(scene: Scene, seed: int) -> tuple[XrayImage, CorrectedImage, Registration] | Refusal:
    """A rendered image, corrected and registered."""
    image = decode(cv2.imencode(".png", render(scene, seed).pixels)[1].tobytes())
    if isinstance(image, Refusal):
        return image
    findings = examine(image, _GUIDE, _CARM)
    if isinstance(findings.result, Refusal):
        return findings.result
    if findings.corrected is None:
        raise ValueError("a registration without the corrected image that it was made in")
    return image, findings.corrected, findings.result


def pair(scene: Scene, seed: int, patient_mm: Array) -> TwoImages | Refusal:
    """Two images around a motion of the guide, the patient displaced between them."""
    rng = np.random.default_rng([seed, 4])
    planned = motion(rng.normal(0.0, 3.0, 3), rng.normal(0.0, 8.0, 3))
    guide = scene.guides[0]
    aimed = replace(guide, source_from_guide=guide.source_from_guide @ planned)
    patient = scene.source_from_patient.copy()
    patient[:3, 3] += patient_mm
    before = registered(scene, 2 * seed)
    if isinstance(before, Refusal):
        return before
    after = registered(replace(scene, guides=(aimed,), source_from_patient=patient), 2 * seed + 1)
    if isinstance(after, Refusal):
        return after
    raw_px = tuple(map(float, rng.uniform(420.0, 600.0, 2)))
    (first, _, planned_from), (_, second, verified) = before, after
    return compare_images(Before(first, planned_from, planned, NO_ARM), second, verified, raw_px, DEPTH_MM)


def rendered(pairs: int, first: int) -> list[Rate]:
    """The same of rendered pairs, and the anatomy."""
    moves: dict[str, Callable[[np.random.Generator], Array]] = {
        "anatomy lay still": lambda _: np.zeros(3),
        "anatomy 1.0 mm across": across,
        "anatomy 3.0 mm along": lambda _: np.array([0.0, 0.0, 3.0]),
    }
    rates, squares = [], []
    for name, move in moves.items():
        found, unusable = [], 0
        for seed in range(first, first + pairs):
            scene = random_scene(seed, "ii")
            two = pair(scene, seed, move(np.random.default_rng([seed, 5])))
            if isinstance(two, Refusal) or not two.anatomy.is_measured:
                unusable += 1
                continue
            found.append(two.anatomy)
            squares.append(two.motion.chi_square)
        seen = sum(
            one.across_mm > _LIMITS.anatomy_across_mm or one.along_mm > _LIMITS.anatomy_along_mm for one in found
        )
        asked = {"most": 0.01} if name.endswith("still") else {"least": 0.95} if "across" in name else {}
        rates.append(Rate(f"rendered, {name}", seen, len(found), **asked))
        shifts = np.array([(one.across_mm, one.along_mm) for one in found])
        print(rates[-1], _spread(shifts), f"{unusable} not usable", sep="\n    ", flush=True)
    rates.append(Rate("rendered, motion refused though none", _refused(squares), len(squares), most=0.005))
    test = kstest(squares, "chi2", args=(6,))
    print(rates[-1], f"chi-square of {len(squares)} fits: mean {np.mean(squares):.2f} (6), KS p {test.pvalue:.3f}")
    return rates


def _refused(squares: Sequence[float]) -> int:
    return sum(square > CHI_SQUARE_LIMIT for square in squares)


def _spread(shifts: Array) -> str:
    low, middle, high = np.percentile(shifts, [2.5, 50.0, 97.5], axis=0)
    along = f"along {middle[1]:.2f} ({low[1]:.2f} to {high[1]:.2f})"
    return f"across {middle[0]:.3f} mm ({low[0]:.3f} to {high[0]:.3f}), {along}"


def main() -> None:
    """Print all; exit 1 where a rate is worse than asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=1000, help="simulated cases of each size (default 1000)")
    parser.add_argument("--pairs", type=int, default=20, help="rendered pairs of each kind (default 20)")
    parser.add_argument("--first", type=int, default=0, help="first seed (default 0)")
    options = parser.parse_args()
    rates = simulated_motions(options.cases, options.first)
    sizes(min(options.cases, 200), options.first)
    rates += rendered(options.pairs, options.first)
    sys.exit(1 if any(rate.is_worse for rate in rates) else 0)


if __name__ == "__main__":
    main()
