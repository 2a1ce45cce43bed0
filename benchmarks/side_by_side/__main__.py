"""Other ways beside this project's, on the same images and in the same simulated rooms.

    make side-by-side

prints three tables: pose from the same 12 fiducials; ring finders; whole strategies. Each image and each room is a line
of FOLDER/results.jsonl, so that a run goes on where the last one ended; summary.json and three plots lie beside it. All
times are processor time, but for the strategies' (strategies.py).
"""

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict
from datetime import UTC, datetime
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

from benchmarks.kept import keep_line, kept_lines, results_folder
from benchmarks.side_by_side.pictures import GROUPS, picture
from benchmarks.side_by_side.plots import plot_poses, plot_rings, plot_strategies
from benchmarks.side_by_side.poses import PoseScore, pose_scores
from benchmarks.side_by_side.rings import RingScore, ring_scores
from benchmarks.side_by_side.strategies import Outcome, outcomes
from benchmarks.side_by_side.tables import pose_rows, print_table, ring_rows, strategy_rows
from benchmarks.side_by_side.theatre import GuideErrors
from vision.refusal import Refusal

_LIBRARIES = ("numpy", "scipy", "opencv-contrib-python-headless", "scikit-image")
Line = dict[str, Any]


def main() -> None:
    """Run what is missing, print, and keep."""
    options = _options()
    lines = _run(options, options.folder / "results.jsonl")
    poses = [PoseScore(**score) for line in lines for score in line.get("poses", ())]
    rings = [RingScore(**score) for line in lines for score in line.get("rings", ())]
    rooms = [_outcome(**fields) for line in lines for fields in line.get("outcomes", ())]
    tables = {
        f"Pose from the same 12 fiducials ({len(GROUPS)} groups of {options.count} images)": pose_rows(poses),
        "Ring finders on the same straightened images": ring_rows(rings),
        "Whole strategies in the same rooms": strategy_rows(rooms),
    }
    for title, rows in tables.items():
        print_table(title, rows)
    refused = [f"{line['name']} {line['refused']}" for line in lines if line.get("refused")]
    print(f"seeds from {options.first}; refused by this project's gates, so not in the first table: {len(refused)}")
    print("".join(f"  {text}\n" for text in refused), end="")
    _keep_summary(options, tables)
    plot_poses(poses, options.folder / "poses.png")
    plot_rings(rings, options.folder / "rings.png")
    plot_strategies(rooms, options.folder / "strategies.png")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=6, help="images of each group (default 6)")
    parser.add_argument("--rooms", type=int, default=20, help="rooms for the strategies (default 20)")
    parser.add_argument("--first", type=int, default=0, help="seed of the first image and room (default 0)")
    parser.add_argument(
        "--folder", type=results_folder, required=True, help="where results, summary and plots are kept"
    )
    options = parser.parse_args()
    if options.count < 1 or options.rooms < 1:
        parser.error("--count and --rooms are at least 1")
    return options


def _run(options: argparse.Namespace, path: Path) -> list[Line]:
    """A line of every image and room asked for; what earlier runs kept is not done again."""
    known = {line["name"]: line for line in kept_lines(path)}
    parts = dict(_parts(options))
    todo = [name for name in parts if name not in known]
    for index, name in enumerate(todo, 1):
        known[name] = {"name": name, **parts[name]()}
        keep_line(path, known[name])
        print(f"\r{index} of {len(todo)} ", end="", file=sys.stderr, flush=True)
    return [known[name] for name in parts]


def _parts(options: argparse.Namespace) -> Iterator[tuple[str, Callable[[], Line]]]:
    """What there is to do, by name."""
    for group in GROUPS:
        for seed in range(options.first, options.first + options.count):
            yield f"{group}:{seed}", partial(_picture_line, group, seed)
    for seed in range(options.first, options.first + options.rooms):
        yield f"room:{seed}", partial(_room_line, seed)


def _picture_line(group: str, seed: int) -> Line:
    seen = picture(group, seed)
    result = seen.findings.result
    return {
        "refused": result.code if isinstance(result, Refusal) else None,
        "poses": [asdict(score) for score in pose_scores(seen)],
        "rings": [asdict(score) for score in ring_scores(seen)],
    }


def _room_line(seed: int) -> Line:
    return {"outcomes": [asdict(outcome) for outcome in outcomes(seed)]}


def _outcome(errors: dict[str, float] | None, **fields: Any) -> Outcome:
    return Outcome(errors=None if errors is None else GuideErrors(**errors), **fields)


def _keep_summary(options: argparse.Namespace, tables: dict[str, Any]) -> None:
    kept = {
        "at": datetime.now(UTC).isoformat(timespec="seconds"),
        "count": options.count,
        "rooms": options.rooms,
        "first": options.first,
        "libraries": {name: version(name) for name in _LIBRARIES},
        "tables": tables,
    }
    (options.folder / "summary.json").write_text(json.dumps(kept, indent=1) + "\n")


if __name__ == "__main__":
    main()
