"""Registers and targets random scenes of the simulator's renderer, which shares no geometry with `vision`.

    python benchmarks/scenes.py [--count N] [--first SEED]

Per group of scenes: how many were registered, the errors of the commanded move, how many lay within their predicted
95 % bounds; then every refusal with its reason. Exit status 1 where any accepted result is wrong: beyond 0.5 deg or
1.0 mm.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from samples import Sample, Score, scored

from simulator.carm.drawing import random_scene
from simulator.carm.render import render
from vision.devices import read_carm, read_guide
from vision.refusal import Refusal

GROUPS = ("ii", "steep", "strong", "flat")
WRONG_DEG, WRONG_MM = 0.5, 1.0
_ROOT = Path(__file__).parents[1]
_GUIDE = read_guide((_ROOT / "tests" / "devices" / "guide.toml").read_bytes())  # the reference guide and its tolerances
_CARMS = _ROOT / "simulator" / "devices"


def scene(group: str, seed: int) -> Sample:
    """A rendered scene with its truth, the reference guide's file and the room's C-arm's."""
    image = render(random_scene(seed, group), seed)
    carm = "carm-flat-panel.toml" if group == "flat" else "carm-intensifier.toml"
    return Sample(f"{group}:{seed}", image.pixels, image.truth, _GUIDE, read_carm((_CARMS / carm).read_bytes()))


def line(group: str, scores: Sequence[Score], count: int) -> str:
    """One line of the table."""
    if not scores:
        return f"{group:>7} {0:>4} of {count:<4}"
    errors = np.array([(score.angle_deg, score.position_mm) for score in scores])
    figures = np.concatenate((np.median(errors, axis=0), np.percentile(errors, 95, axis=0), errors.max(axis=0)))
    held = sum(score.is_inside_bound for score in scores)
    return (
        f"{group:>7} {len(scores):>4} of {count:<4} " + " ".join(f"{figure:8.4f}" for figure in figures) + f" {held:>6}"
    )


def main() -> None:
    """Print the table and the refusals; exit 1 where an accepted result is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=12, help="scenes of each group (default 12)")
    parser.add_argument("--first", type=int, default=0, help="seed of the first (default 0)")
    options = parser.parse_args()
    print(f"{'group':>7} {'registered':<12} {'median deg, mm':>17} {'95 % deg, mm':>17} {'worst deg, mm':>17} within")
    refused: list[str] = []
    wrong: list[str] = []
    for group in GROUPS:
        scores: list[Score] = []
        for seed in range(options.first, options.first + options.count):
            result = scored(scene(group, seed), 0)
            if isinstance(result, Refusal):
                refused.append(
                    f"{group}:{seed} {result.code}: {result.message} ({result.measured}, limit {result.limit})"
                )
                continue
            scores.append(result)
            if result.angle_deg > WRONG_DEG or result.position_mm > WRONG_MM:
                wrong.append(f"{group}:{seed} {result.angle_deg:.4f} deg, {result.position_mm:.4f} mm")
        print(line(group, scores, options.count), flush=True)
    print(f"\n{len(refused)} refused" + "".join(f"\n  {text}" for text in refused))
    print(f"{len(wrong)} wrong" + "".join(f"\n  {text}" for text in wrong))
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
