"""How near the registration comes to what the pixels allow, and where the rest goes.

    python benchmarks/efficiency.py [--count N] [--first SEED]

Per stratum: root mean squares of the targeting error and of its Cramer-Rao bound (`pixel_bound.py`), their ratio, and
the share of the error that another draw of the noise repeats: bias, by background and model. The guide is made as its
file says and the file's tolerances are taken for nothing, as in the bound. The strata without patient, distortion or
noise show what each costs; the bound knows the background, which an estimator must learn from the same pixels.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from coverage import as_filed
from numpy.typing import NDArray
from pixel_bound import Bound, error_vectors, pixel_bound
from samples import Sample, registered

from simulator.carm.distortion import NO_DISTORTION
from simulator.carm.drawing import random_scene
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


STRATA = (
    Stratum("intensifier", "ii"),
    Stratum("steep", "steep"),
    Stratum("flat panel", "flat"),
    Stratum("third of dose", "ii", NOMINAL_DOSE / 3.0),
    Stratum("three doses", "ii", NOMINAL_DOSE * 3.0),
    Stratum("no patient", "ii", change=lambda scene: replace(scene, body=None)),
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


def line(name: str, pairs: Sequence[tuple[Array, Array]], bounds: Sequence[Bound], refused: int) -> str:
    """One line of the table."""
    if not pairs:
        return f"{name:>14} {0:>4} {refused:>7}"
    one, other = (np.array(half) for half in zip(*pairs, strict=True))
    cells = []
    for part, unit, bound in (
        (slice(0, 3), 180.0 / np.pi, [bound.angle_deg for bound in bounds]),
        (slice(3, 6), 1.0, [bound.position_mm for bound in bounds]),
    ):
        first, second = one[:, part] * unit, other[:, part] * unit
        mean_square = float(((first**2).sum(axis=1) + (second**2).sum(axis=1)).mean()) / 2.0
        share = max(0.0, float((first * second).sum(axis=1).mean()) / mean_square)
        root, least = float(np.sqrt(mean_square)), float(np.sqrt(np.mean(np.square(bound))))
        cells.append(f"{root:8.4f} {least:8.4f} {root / least:6.2f} {100.0 * share:6.0f}")
    return f"{name:>14} {len(pairs):>4} {refused:>7} " + " ".join(cells)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=12, help="scenes of each stratum, each with two draws of noise")
    parser.add_argument("--first", type=int, default=5000, help="seed of the first (default 5000)")
    options = parser.parse_args()
    guide = known_guide()
    print(f"{'':>27} {'deg: error, bound, ratio, bias %':>31} {'mm: error, bound, ratio, bias %':>31}")
    print(f"{'stratum':>14} {'n':>4} {'refused':>7}")
    for stratum in STRATA:
        pairs, bounds, refused = [], [], 0
        for seed in range(options.first, options.first + options.count):
            scene = stratum.scene(seed)
            one, other = (errors_of(scene, guide, 2 * seed + draw) for draw in (0, 1))
            if isinstance(one, Refusal) or isinstance(other, Refusal):
                refused += 1
                continue
            pairs.append((one, other))
            bounds.append(pixel_bound(scene, guide))
        print(line(stratum.name, pairs, bounds, refused), flush=True)
    sys.exit(0)


if __name__ == "__main__":
    main()
