"""Registers scenes with one thing wrong each and counts what was accepted and wrong: beyond 0.5 deg or 1.0 mm.

    python benchmarks/faulted.py --folder FOLDER [--count N] [--first SEED] [--processes P] [--faults NAME ...]

Scenes are drawn by fault and seed; N counts them over all faults, in turn, `nothing` included. Every result is a line
of FOLDER/results-CODE.jsonl, CODE the fingerprint of what was run; a run of the same code goes on where the last one
ended. The figures, with 95 % bounds by Clopper and Pearson, are printed and written to FOLDER/summary.json. The guide's
file is the reference guide's, whose tolerances the scenes are drawn with. Exit status 1 where any accepted result is
wrong.
"""

import argparse
import json
import math
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import cv2
from evidence.code import fingerprint
from kept import keep_line, kept_lines
from samples import Sample, Score, scored
from scipy.stats import binomtest

from simulator.carm.faulted import Fault, faulted_scene
from simulator.carm.quick_render import render_quickly
from vision.devices import read_carm, read_guide
from vision.refusal import Refusal

WRONG_DEG, WRONG_MM = 0.5, 1.0
REGISTERED = "registered"
_ROOT = Path(__file__).parents[1]
_GUIDE = read_guide((_ROOT / "tests" / "devices" / "guide.toml").read_bytes())  # the reference guide and its tolerances
_CARMS = _ROOT / "simulator" / "devices"
_INTENSIFIER = read_carm((_CARMS / "carm-intensifier.toml").read_bytes())
_FLAT_PANEL = read_carm((_CARMS / "carm-flat-panel.toml").read_bytes())
_RUN = ("benchmarks.faulted", "benchmarks.samples", "simulator.carm.faulted", "simulator.carm.quick_render")
_FILES = ("tests/devices/guide.toml", "simulator/devices/*.toml")
_TELL_EVERY_S = 5.0
_PLANNED = 100_000  # scenes, for the time they would take


@dataclass(frozen=True)
class Result:
    """What became of one scene; errors and bounds of a registered one, the reason of a refused one."""

    fault: Fault
    seed: int
    group: str
    code: str
    wrong: bool = False
    angle_deg: float | None = None
    position_mm: float | None = None
    bound_deg: float | None = None
    bound_mm: float | None = None
    reason: str | None = None
    cpu_s: float | None = None


def result(fault: Fault, seed: int) -> Result:
    """Render, register and target one scene."""
    started_s = time.process_time()
    drawn = faulted_scene(fault, seed)
    image = render_quickly(drawn.scene, seed)
    pixels = image.pixels if drawn.flip is None else drawn.flip(image.pixels)
    carm = _INTENSIFIER if drawn.intensifier_file else _FLAT_PANEL
    score = scored(Sample(f"{fault}:{seed}", pixels, image.truth, _GUIDE, carm), 0)
    cpu_s = round(time.process_time() - started_s, 3)
    if isinstance(score, Refusal):
        reason = f"{score.message} ({score.measured}, limit {score.limit})"
        return Result(fault, seed, drawn.scene.group, score.code, reason=reason, cpu_s=cpu_s)
    wrong = drawn.flip is not None or score.angle_deg > WRONG_DEG or score.position_mm > WRONG_MM
    return Result(fault, seed, drawn.scene.group, REGISTERED, wrong, *_figures(score), cpu_s=cpu_s)


def _figures(score: Score) -> tuple[float, float, float, float]:
    bound = score.bound
    return score.angle_deg, score.position_mm, math.degrees(bound.angle_rad), bound.position_mm


def scenes(count: int, first: int, faults: Sequence[Fault]) -> Iterator[tuple[Fault, int]]:
    """Faults in turn, each with seeds from the first."""
    for index in range(count):
        yield faults[index % len(faults)], first + index // len(faults)


def kept(path: Path) -> list[Result]:
    """Results of earlier runs."""
    return [Result(**fields | {"fault": Fault(fields["fault"])}) for fields in kept_lines(path)]


def run(todo: Sequence[tuple[Fault, int]], path: Path, processes: int) -> list[Result]:
    """Results of scenes, each written as it comes."""
    if not todo:
        return []
    started_s, told_s, results = time.monotonic(), 0.0, []
    with ProcessPoolExecutor(processes, initializer=cv2.setNumThreads, initargs=(1,)) as pool:
        for done in pool.map(result, *zip(*todo, strict=True), chunksize=8):
            results.append(done)
            keep_line(path, asdict(done))
            if time.monotonic() - told_s > _TELL_EVERY_S:
                told_s = time.monotonic()
                left_min = (told_s - started_s) / len(results) * (len(todo) - len(results)) / 60.0
                print(f"{len(results)} of {len(todo)}, {left_min:.0f} min left", file=sys.stderr, flush=True)
    return results


def summary(results: Sequence[Result]) -> dict[str, dict[str, Any]]:
    """Counts and bounds by fault, and of all faults together."""
    groups: dict[str, list[Result]] = {fault: [one for one in results if one.fault is fault] for fault in Fault}
    groups["all but nothing"] = [one for one in results if one.fault is not Fault.NOTHING]
    return {name: _counts(group) for name, group in groups.items() if group}


def _counts(group: Sequence[Result]) -> dict[str, Any]:
    registered = [one for one in group if one.code == REGISTERED]
    wrong = sum(one.wrong for one in group)
    return {
        "scenes": len(group),
        "first_seed": min(one.seed for one in group),
        "last_seed": max(one.seed for one in group),
        "wrong": wrong,
        "wrong_share_95": _bounds(wrong, len(group)),
        "registered": len(registered),
        "registered_share_95": _bounds(len(registered), len(group)),
        "worst_deg": max((one.angle_deg or 0.0 for one in registered), default=None),
        "worst_mm": max((one.position_mm or 0.0 for one in registered), default=None),
        "refusals": dict(Counter(one.code for one in group if one.code != REGISTERED).most_common()),
    }


def _bounds(count: int, scenes_: int) -> tuple[float, float]:
    """Share with 95 % confidence, Clopper and Pearson."""
    interval = binomtest(count, scenes_).proportion_ci(0.95, method="exact")
    return float(interval.low), float(interval.high)


def table(figures: dict[str, dict[str, Any]]) -> Iterator[str]:
    """Lines to print."""
    widths = (18, 7, 6, 16, 11, 19, 16)
    heads = ("fault", "scenes", "wrong", "95 %", "registered", "95 %", "worst deg, mm")
    yield "".join(head.rjust(width) for head, width in zip(heads, widths, strict=True)) + "  refused"
    for name, row in figures.items():
        cells = (
            name,
            row["scenes"],
            row["wrong"],
            _per_cent(row["wrong_share_95"]),
            row["registered"],
            _per_cent(row["registered_share_95"]),
            "-" if row["worst_deg"] is None else f"{row['worst_deg']:.3f} {row['worst_mm']:.3f}",
        )
        refused = ", ".join(f"{code} {times}" for code, times in row["refusals"].items())
        yield "".join(str(cell).rjust(width) for cell, width in zip(cells, widths, strict=True)) + f"  {refused}"


def _per_cent(bounds: tuple[float, float]) -> str:
    return "-".join(f"{100.0 * end:.3f}" for end in bounds)


def verdict(results: Sequence[Result], figures: dict[str, dict[str, Any]]) -> Iterator[str]:
    """What was asked for, in words; then every wrong acceptance."""
    wrong = [one for one in results if one.wrong]
    most = 100.0 * _bounds(len(wrong), len(results))[1]
    yield f"wrong: {len(wrong)} of {len(results)}, a share of at most {most:.4f} %"
    if nominal := figures.get(Fault.NOTHING):
        of = f"{nominal['registered']} of {nominal['scenes']}"
        yield f"registered where nothing is wrong: {of}, {_per_cent(nominal['registered_share_95'])} %"
    cpu_s = sum(one.cpu_s or 0.0 for one in results) / len(results)
    yield f"{cpu_s:.2f} s a scene; {_PLANNED} would take {_PLANNED * cpu_s / 3600.0:.1f} h of processor time"
    for one in wrong:
        yield f"wrong: {one.fault}:{one.seed} ({one.group}) {one.angle_deg:.3f} deg, {one.position_mm:.3f} mm"


def main() -> None:
    """Run what is missing, print the table; exit 1 where an accepted result is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, required=True, help="where the results are kept")
    parser.add_argument("--count", type=int, default=1000, help="scenes over all faults (default 1000)")
    parser.add_argument("--first", type=int, default=0, help="seed of each fault's first scene (default 0)")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--faults", nargs="+", type=Fault, default=list(Fault), help="by default all")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    path = options.folder / f"results-{fingerprint(_RUN, _FILES)}.jsonl"
    results = kept(path)
    known = {(one.fault, one.seed) for one in results}
    todo = [scene for scene in scenes(options.count, options.first, options.faults) if scene not in known]
    results += run(todo, path, options.processes)
    figures = summary(results)
    (options.folder / "summary.json").write_text(json.dumps(figures, indent=1))
    print("\n".join((*table(figures), "", *verdict(results, figures))))
    sys.exit(1 if any(one.wrong for one in results) else 0)


if __name__ == "__main__":
    main()
