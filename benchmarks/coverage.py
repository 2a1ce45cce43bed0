"""Whether the predicted 95 % bounds are true: the real error of commanded moves, drawn as the device files say.

    python benchmarks/coverage.py --folder FOLDER [--count N] [--first SEED] [--processes P]

Every scene's guide is made within the tolerances of its file (rings, separation, bead, the bore, along which the needle
goes) and its C-arm stands within the standard deviations of its file; background, tilt, distortion, dose and target are
drawn as ever. N counts the scenes over all groups, in turn. Every result is a line of FOLDER/coverage.jsonl; a run goes
on where the last one ended. Shares are printed by group and by dose with 95 % bounds by Clopper and Pearson.
"""

import argparse
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from scipy.stats import binomtest

from benchmarks.kept import at_least_one, keep_line, kept_lines, results_folder
from benchmarks.samples import Sample, errors, registered
from simulator.carm.drawing import PIXEL_MM, random_scene
from simulator.carm.quick_render import render_quickly
from simulator.carm.scene import Scene
from vision.devices import CArm, Guide, read_carm, read_guide
from vision.refusal import Refusal
from vision.registered import Method, PixelSpace
from vision.targeting import target

Array = NDArray[np.float64]

GROUPS = ("ii", "steep", "strong", "flat")
LOW_DOSE = 13_400.0  # photons a pixel: the middle of the range, on its logarithmic scale
_ROOT = Path(__file__).parents[1]
_GUIDE = read_guide((_ROOT / "tests" / "devices" / "guide.toml").read_bytes())
_CARMS = {
    flat: read_carm((_ROOT / "simulator" / "devices" / f"carm-{name}.toml").read_bytes())
    for flat, name in ((True, "flat-panel"), (False, "intensifier"))
}
_APART = 1_000_003  # so that what is made differs from what the scene draws with the same seed


@dataclass(frozen=True)
class Result:
    """One scene: what the needle missed by and what was predicted, or why it was refused."""

    group: str
    seed: int
    photons: float
    tilt_deg: float
    code: str = "registered"
    angle_deg: float = math.nan
    position_mm: float = math.nan
    bound_deg: float = math.nan
    bound_mm: float = math.nan


def as_filed(scene: Scene) -> CArm:
    """The C-arm of a scene by its file."""
    return _CARMS[not scene.intensifier]


def as_made(scene: Scene, guide: Guide, carm: CArm, rng: np.random.Generator) -> Scene:
    """The scene with guide and C-arm drawn by the standard deviations of their files."""
    sd, placed = guide.tolerance, scene.guides[0]
    assert guide.bead is not None
    shape = replace(
        placed.shape,
        small_radius_mm=guide.small_ring_radius_mm + float(rng.normal(0.0, sd.radius_sd_mm)),
        big_radius_mm=guide.big_ring_radius_mm + float(rng.normal(0.0, sd.radius_sd_mm)),
        separation_mm=guide.separation_mm + float(rng.normal(0.0, sd.separation_sd_mm)),
        bead_mm=tuple((np.array(guide.bead.position_mm) + rng.normal(0.0, sd.bead_sd_mm, 3)).tolist()),
    )
    u, v = 511.5 + rng.normal(0.0, carm.principal_point_sd_px, 2)
    distance_mm = float(rng.normal(carm.source_to_image_mm, carm.source_to_image_sd_mm))
    camera = replace(
        scene.camera,
        source_to_image_mm=distance_mm,
        pixel_mm=PIXEL_MM,
        principal_u_px=float(u),
        principal_v_px=float(v),
    )
    pose = placed.source_from_guide.copy()
    pose[2, 3] += distance_mm - scene.camera.source_to_image_mm
    return replace(scene, camera=camera, guides=(replace(placed, shape=shape, source_from_guide=pose),))


def bore_tilt(guide: Guide, rng: np.random.Generator) -> Array:
    """`guide_from_bore` (4, 4): the sleeve's axis, off at the big ring against the small one."""
    x_mm, y_mm = rng.normal(0.0, guide.tolerance.bore_concentricity_sd_mm, 2)
    tilted = np.eye(4)
    tilted[:3, :3] = Rotation.from_rotvec(np.array([y_mm, -x_mm, 0.0]) / guide.separation_mm).as_matrix()
    return tilted


def result(group: str, seed: int) -> Result:
    """Render, register and target one scene."""
    rng, drawn = np.random.default_rng(seed + _APART), random_scene(seed, group)
    carm = as_filed(drawn)
    scene = as_made(drawn, _GUIDE, carm, rng)
    image = render_quickly(scene, seed)
    axis = scene.guides[0].source_from_guide[:3, 2]
    known = Result(group, seed, scene.exposure.photons, math.degrees(math.acos(min(1.0, float(axis[2])))))
    sample = Sample(f"{group}:{seed}", image.pixels, image.truth, _GUIDE, carm)
    registration = registered(sample, image.pixels, Method.CONTOUR)
    if isinstance(registration, Refusal):
        return replace(known, code=str(registration.code))
    aim = target(registration, tuple(image.truth["target_raw_px"]), PixelSpace.RAW)
    if isinstance(aim, Refusal):
        return replace(known, code=str(aim.code))
    angle_deg, position_mm = errors(sample, aim.guide_from_goal @ bore_tilt(_GUIDE, rng))
    bound = aim.predicted_error_95
    return replace(
        known,
        angle_deg=angle_deg,
        position_mm=position_mm,
        bound_deg=math.degrees(bound.angle_rad),
        bound_mm=bound.position_mm,
    )


def kept(path: Path) -> list[Result]:
    """Results of earlier runs."""
    return [Result(**fields) for fields in kept_lines(path)]


def run(todo: Sequence[tuple[str, int]], path: Path, processes: int) -> list[Result]:
    """Results of scenes, each written as it comes."""
    results = []
    with ProcessPoolExecutor(processes, initializer=cv2.setNumThreads, initargs=(1,)) as pool:
        for done in pool.map(result, *zip(*todo, strict=True), chunksize=4):
            results.append(done)
            keep_line(path, asdict(done))
    return results


def table(results: Sequence[Result]) -> Iterator[str]:
    """Lines to print."""
    yield f"{'stratum':>16} {'registered':>12} {'median deg, mm':>17} {'95 % deg, mm':>17} {'worst deg, mm':>17} within"
    strata: dict[str, Callable[[Result], bool]] = {
        **{group: lambda one, group=group: one.group == group for group in GROUPS},
        "tilt below 12": lambda one: one.tilt_deg < 12.0,
        "tilt 12 to 25": lambda one: 12.0 <= one.tilt_deg < 25.0,
        "low dose": lambda one: one.photons < LOW_DOSE,
        "high dose": lambda one: one.photons >= LOW_DOSE,
        "all": lambda _: True,
    }
    for name, belongs in strata.items():
        chosen = [one for one in results if belongs(one)]
        good = [one for one in chosen if one.code == "registered"]
        if good:
            yield f"{name:>16} {len(good):>5} of {len(chosen):<4} {_figures(good)}"


def _figures(good: Sequence[Result]) -> str:
    found = np.array([(one.angle_deg, one.position_mm) for one in good])
    bounds = np.array([(one.bound_deg, one.bound_mm) for one in good])
    rows = (np.median(found, axis=0), np.percentile(found, 95, axis=0), found.max(axis=0))
    shares = [_share(int(inside), len(good)) for inside in (found <= bounds).sum(axis=0)]
    return " ".join(f"{figure:8.4f}" for figure in np.concatenate(rows)) + f"  {shares[0]}, {shares[1]}"


def _share(count: int, of: int) -> str:
    interval = binomtest(count, of).proportion_ci(0.95, method="exact")
    return f"{100.0 * count / of:.1f} % ({100.0 * interval.low:.1f}-{100.0 * interval.high:.1f})"


def main() -> None:
    """Run what is missing and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=results_folder, required=True, help="where the results are kept")
    parser.add_argument("--count", type=int, default=1000, help="scenes over all groups (default 1000)")
    parser.add_argument("--first", type=int, default=0, help="seed of each group's first (default 0)")
    parser.add_argument("--processes", type=at_least_one, default=1)
    options = parser.parse_args()
    path = options.folder / "coverage.jsonl"
    results = kept(path)
    known = {(one.group, one.seed) for one in results}
    scenes = [(GROUPS[index % len(GROUPS)], options.first + index // len(GROUPS)) for index in range(options.count)]
    todo = [scene for scene in scenes if scene not in known]
    if todo:
        results += run(todo, path, options.processes)
    print("\n".join(table(results)))
    print(
        "refused: " + (", ".join(f"{one.group}:{one.seed} {one.code}" for one in results if one.code != "registered"))
    )
    sys.exit(0)


if __name__ == "__main__":
    main()
