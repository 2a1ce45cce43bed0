"""Registers and targets random scenes of the simulator's renderer, which shares no geometry with `vision`.

    python benchmarks/scenes.py [--count N] [--first SEED] [--groups NAME ...] [--tolerances SHARE] [--keep FILE]
        [--against FILE]

Per group of scenes: how many were registered, the errors of the commanded move, how many lay within their predicted
95 % bounds; then every refusal with its reason. With --keep every result is a line of FILE, and a run goes on where the
last one ended. With --against results of the same scenes by other code are compared: per group by how much the errors
of scenes that both registered grew, as a factor of their geometric mean with its 95 % interval, and of their root mean
square. --tolerances has the guide's file state only so much of its tolerances of radius and separation, as that of a
guide whose rings were measured does; the guides drawn stay the same. Exit status 1 where any accepted result is wrong:
beyond 0.5 deg or 1.0 mm.
"""

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from scipy import stats

from benchmarks.kept import at_least_one, keep_line, kept_lines
from benchmarks.samples import Sample, scored
from simulator.carm.drawing import random_scene
from simulator.carm.render import render
from vision.devices import Guide, read_carm, read_guide
from vision.refusal import Refusal

GROUPS = ("ii", "steep", "strong", "flat")
REGISTERED = "registered"
WRONG_DEG, WRONG_MM = 0.5, 1.0
_ROOT = Path(__file__).parents[1]
_GUIDE = read_guide((_ROOT / "tests" / "devices" / "guide.toml").read_bytes())  # the reference guide and its tolerances
_CARMS = _ROOT / "simulator" / "devices"


@dataclass(frozen=True)
class Result:
    """What became of one scene: the errors of a registered one, the reason of a refused one."""

    group: str
    seed: int
    code: str
    angle_deg: float = math.nan
    position_mm: float = math.nan
    is_inside_bound: bool = False
    reason: str = ""
    tolerances: float = 1.0  # share of them that the guide's file states

    @property
    def is_wrong(self) -> bool:
        """Whether it was accepted though it errs too far."""
        return self.angle_deg > WRONG_DEG or self.position_mm > WRONG_MM


def guide_file(tolerances: float) -> Guide:
    """The reference guide with this share of its file's tolerances of radius and separation."""
    sd = _GUIDE.tolerance
    radius_mm, separation_mm = (tolerances * of_file for of_file in (sd.radius_sd_mm, sd.separation_sd_mm))
    return replace(_GUIDE, tolerance=replace(sd, radius_sd_mm=radius_mm, separation_sd_mm=separation_mm))


def scene(group: str, seed: int, guide: Guide = _GUIDE) -> Sample:
    """A rendered scene with its truth, the guide's file and the room's C-arm's."""
    image = render(random_scene(seed, group), seed)
    carm = "carm-flat-panel.toml" if group == "flat" else "carm-intensifier.toml"
    return Sample(f"{group}:{seed}", image.pixels, image.truth, guide, read_carm((_CARMS / carm).read_bytes()))


def result(group: str, seed: int, tolerances: float) -> Result:
    """Render, register and target one scene."""
    score = scored(scene(group, seed, guide_file(tolerances)), 0)
    if isinstance(score, Refusal):
        reason = f"{score.message} ({score.measured}, limit {score.limit})"
        return Result(group, seed, score.code, reason=reason, tolerances=tolerances)
    errors = score.angle_deg, score.position_mm
    return Result(group, seed, REGISTERED, *errors, bool(score.is_inside_bound), tolerances=tolerances)


def kept(path: Path) -> list[Result]:
    """Results of earlier runs."""
    return [Result(**fields) for fields in kept_lines(path)]


def line(group: str, results: Sequence[Result]) -> str:
    """One line of the table."""
    good = [one for one in results if one.code == REGISTERED]
    if not good:
        return f"{group:>7} {0:>4} of {len(results):<4}"
    errors = _errors(good)
    figures = np.concatenate((np.median(errors, axis=0), np.percentile(errors, 95, axis=0), errors.max(axis=0)))
    held = sum(one.is_inside_bound for one in good)
    cells = " ".join(f"{figure:8.4f}" for figure in figures)
    return f"{group:>7} {len(good):>4} of {len(results):<4} {cells} {held:>6}"


def _errors(results: Sequence[Result]) -> np.ndarray:
    """Angles, deg, and distances, mm (n, 2)."""
    return np.array([(one.angle_deg, one.position_mm) for one in results])


def comparison(results: Sequence[Result], before: Sequence[Result]) -> Iterator[str]:
    """How errors differ from those before on the same scenes, by group and all together."""
    others = {(one.group, one.seed): one for one in before}
    both = [(one, others[one.group, one.seed]) for one in results if (one.group, one.seed) in others]
    both = [pair for pair in both if all(one.code == REGISTERED for one in pair)]
    heads = " ".join(f"{unit + ': mean factor, 95 %':>26} {'rms':>6}" for unit in ("deg", "mm"))
    yield f"{'against':>7} {'scenes':>6} {heads}"
    for name in (*GROUPS, "all"):
        pairs = [pair for pair in both if name in (pair[0].group, "all")]
        if len(pairs) > 1:
            now, then = (_errors(side) for side in zip(*pairs, strict=True))
            cells = " ".join(_factors(now[:, axis], then[:, axis]) for axis in (0, 1))
            yield f"{name:>7} {len(pairs):>6} {cells}"


def _factors(now: np.ndarray, then: np.ndarray) -> str:
    """By how much errors (n,) grew: the geometric mean with Student's interval, and the root mean square."""
    logs = np.log(now / then)
    half = float(stats.t.ppf(0.975, len(logs) - 1)) * float(logs.std(ddof=1)) / math.sqrt(len(logs))
    low, mean, high = np.exp(logs.mean() + np.array([-half, 0.0, half]))
    rms = math.sqrt(float((now**2).sum() / (then**2).sum()))
    return f"{mean:12.3f} ({low:.3f}-{high:.3f}) {rms:6.3f}"


def main() -> None:
    """Print the table and the refusals; exit 1 where an accepted result is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=at_least_one, default=12, help="scenes of each group (default 12)")
    parser.add_argument("--first", type=int, default=0, help="seed of the first (default 0)")
    parser.add_argument("--groups", nargs="+", choices=GROUPS, default=GROUPS, help="by default all")
    parser.add_argument("--tolerances", type=float, default=1.0, help="share of the file's that it states (default 1)")
    parser.add_argument("--keep", type=Path, help="file of results, which a run goes on from")
    parser.add_argument("--against", type=Path, help="file of results by other code, to compare with")
    options = parser.parse_args()
    try:
        guide_file(options.tolerances)
    except ValueError as error:
        parser.error(f"--tolerances {options.tolerances:g}: {error}")
    known = {(one.group, one.seed, one.tolerances): one for one in (kept(options.keep) if options.keep else ())}
    print(f"{'group':>7} {'registered':<12} {'median deg, mm':>17} {'95 % deg, mm':>17} {'worst deg, mm':>17} within")
    results: list[Result] = []
    for group in options.groups:
        for seed in range(options.first, options.first + options.count):
            found = known.get((group, seed, options.tolerances))
            one = found or result(group, seed, options.tolerances)
            if options.keep and found is None:
                keep_line(options.keep, asdict(one))
            results.append(one)
        print(line(group, results[-options.count :]), flush=True)
    if options.against:
        print("\n" + "\n".join(comparison(results, kept(options.against))))
    refused = [f"{one.group}:{one.seed} {one.code}: {one.reason}" for one in results if one.code != REGISTERED]
    wrong = [
        f"{one.group}:{one.seed} {one.angle_deg:.4f} deg, {one.position_mm:.4f} mm" for one in results if one.is_wrong
    ]
    print(f"\n{len(refused)} refused" + "".join(f"\n  {text}" for text in refused))
    print(f"{len(wrong)} wrong" + "".join(f"\n  {text}" for text in wrong))
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
