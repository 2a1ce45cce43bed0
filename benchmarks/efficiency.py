"""How near the registration comes to what the pixels allow, and where the rest goes.

    python benchmarks/efficiency.py [--count N] [--first SEED] [--strata NAME ...]

Per stratum: the root mean square of the targeting error, and how many times greater it is than two Cramer-Rao bounds:
one that knows the background (`pixel_bound.py`), and one for which the background is noise as well
(`background_bound.py`), since an estimator must learn it from the same pixels. Then the share of the squared error that
another draw of the quanta repeats, which is what background and model make, and how much of it background as unknown as
that explains: the rest is the estimator's own. The guide is made as its file says and the file's tolerances are taken
for nothing, as in the bounds. The strata without patient, housing, distortion or noise show what each costs.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.background_bound import background_bound
from benchmarks.coverage import as_filed
from benchmarks.kept import at_least_one
from benchmarks.pixel_bound import Bound, Changes, error_vectors, pixel_bound
from benchmarks.samples import Sample, registered
from simulator.carm.distortion import NO_DISTORTION
from simulator.carm.drawing import random_scene
from simulator.carm.guide import ALL_PARTS, Part
from simulator.carm.quick_render import render_quickly
from simulator.carm.scene import Scene
from vision.devices import Guide, read_guide
from vision.refusal import Refusal
from vision.registered import Method, PixelSpace
from vision.targeting import target

Array = NDArray[np.float64]

NOMINAL_DOSE = 15_000.0  # photons a pixel where the image is white
_GUIDE_FILE = Path(__file__).parents[1] / "tests" / "devices" / "guide.toml"


@dataclass(frozen=True)
class Stratum:
    """A kind of scene, and what is changed in it."""

    name: str
    group: str
    photons: float = NOMINAL_DOSE
    change: Callable[[Scene], Scene] = lambda scene: scene

    def scene(self, seed: int) -> Scene:
        """One scene of it."""
        scene = self.change(random_scene(seed, self.group))
        return replace(scene, exposure=replace(scene.exposure, photons=self.photons))


def _without_patient(scene: Scene) -> Scene:
    return replace(scene, body=None)


def _without_housing(scene: Scene) -> Scene:
    """The guide's wires and bead in the air: no edge of a tube runs beside them."""
    bare = [replace(one, shape=replace(one.shape, parts=ALL_PARTS - {Part.HOUSING})) for one in scene.guides]
    return replace(scene, guides=tuple(bare))


STRATA = (
    Stratum("intensifier", "ii"),
    Stratum("steep", "steep"),
    Stratum("flat panel", "flat"),
    Stratum("third of dose", "ii", NOMINAL_DOSE / 3.0),
    Stratum("three doses", "ii", NOMINAL_DOSE * 3.0),
    Stratum("no patient", "ii", change=_without_patient),
    Stratum("flat, empty", "flat", change=_without_patient),
    Stratum("no housing", "flat", change=lambda scene: _without_housing(_without_patient(scene))),
    Stratum("no distortion", "ii", change=lambda scene: replace(scene, distortion=NO_DISTORTION)),
    Stratum("hardly noise", "ii", NOMINAL_DOSE * 1e3),
)


def known_guide() -> Guide:
    """The guide of the file, its tolerances as small as a file may state them."""
    guide = read_guide(_GUIDE_FILE.read_bytes())
    sd = replace(guide.tolerance, radius_sd_mm=0.005, separation_sd_mm=0.005, bead_sd_mm=0.01)
    return replace(guide, tolerance=sd)


def errors_of(scene: Scene, guide: Guide, seed: int) -> Array | Refusal:
    """Error vectors (6,) with one draw of the noise."""
    image = render_quickly(scene, seed)
    sample = Sample(scene.name, image.pixels, image.truth, guide, as_filed(scene))
    registration = registered(sample, image.pixels, Method.CONTOUR)
    if isinstance(registration, Refusal):
        return registration
    u, v = image.truth["target_raw_px"]
    aim = target(registration, (u, v), PixelSpace.RAW)
    return aim if isinstance(aim, Refusal) else error_vectors(scene, guide, aim.guide_from_goal)


@dataclass(frozen=True)
class Outcome:
    """One scene: the errors (6,) of two draws of the quanta, and the bounds without and with unknown background."""

    one: Array
    other: Array
    known: Bound
    unknown: Bound


def outcome(scene: Scene, guide: Guide, seed: int) -> Outcome | Refusal:
    """Both draws of a scene, and its bounds."""
    errors = []
    for draw in (0, 1):
        found = errors_of(scene, guide, 2 * seed + draw)
        if isinstance(found, Refusal):
            return found
        errors.append(found)
    changes = Changes.of(scene)
    return Outcome(*errors, pixel_bound(scene, guide, changes), background_bound(scene, guide, changes))


HEAD = f"{'error':>8} {'quanta':>8} {'ratio':>6} {'unknown':>8} {'ratio':>6} {'bias %':>6} {'own %':>6}"


def line(name: str, outcomes: Sequence[Outcome], refused: int) -> str:
    """One line of the table."""
    if not outcomes:
        return f"{name:>14} {0:>4} {refused:>7}"
    angles = _cells(outcomes, slice(0, 3), 180.0 / np.pi, lambda bound: bound.angle_deg)
    positions = _cells(outcomes, slice(3, 6), 1.0, lambda bound: bound.position_mm)
    return f"{name:>14} {len(outcomes):>4} {refused:>7} {angles} {positions}"


def _cells(outcomes: Sequence[Outcome], part: slice, unit: float, of: Callable[[Bound], float]) -> str:
    """Error, bounds and ratios of angle or position; per cent that another draw repeats, and that no bound explains."""
    first, second = (np.array([getattr(one, draw)[part] for one in outcomes]) * unit for draw in ("one", "other"))
    mean_square = float(((first**2).sum(axis=1) + (second**2).sum(axis=1)).mean()) / 2.0
    bias = max(0.0, float((first * second).sum(axis=1).mean()) / mean_square)
    known, unknown = (
        float(np.sqrt(np.mean([of(getattr(one, name)) ** 2 for one in outcomes]))) for name in ("known", "unknown")
    )
    root, own = float(np.sqrt(mean_square)), max(0.0, 1.0 - unknown**2 / mean_square)
    shares = f"{100.0 * bias:6.0f} {100.0 * own:6.0f}"
    return f"{root:8.4f} {known:8.4f} {root / known:6.2f} {unknown:8.4f} {root / unknown:6.2f} {shares}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--count", type=at_least_one, default=12, help="scenes of each stratum, each with two draws of noise"
    )
    parser.add_argument("--first", type=int, default=5000, help="seed of the first (default 5000)")
    parser.add_argument("--strata", nargs="+", choices=[one.name for one in STRATA], help="by default all")
    options = parser.parse_args()
    guide = known_guide()
    print(f"{'':>27} {'deg:':<55} mm:\n{'stratum':>14} {'n':>4} {'refused':>7} {HEAD} {HEAD}")
    for stratum in STRATA:
        if options.strata and stratum.name not in options.strata:
            continue
        seeds = range(options.first, options.first + options.count)
        found = [outcome(stratum.scene(seed), guide, seed) for seed in seeds]
        good = [one for one in found if isinstance(one, Outcome)]
        print(line(stratum.name, good, len(found) - len(good)), flush=True)
    sys.exit(0)


if __name__ == "__main__":
    main()
