"""Other ways beside this project's, on the same images and in the same simulated rooms.

    make side-by-side

prints three tables: pose from the same 12 fiducials; ring finders; whole strategies. With --folder it also writes
results.json and three plots there. All times are processor time, but for the strategies' (strategies.py).
"""

import argparse
import json
from collections.abc import Iterator
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from benchmarks.side_by_side.pictures import GROUPS, pictures
from benchmarks.side_by_side.plots import plot_poses, plot_rings, plot_strategies
from benchmarks.side_by_side.poses import PoseScore, pose_scores
from benchmarks.side_by_side.rings import RingScore, ring_scores
from benchmarks.side_by_side.strategies import Outcome, outcomes
from benchmarks.side_by_side.tables import pose_rows, print_table, ring_rows, strategy_rows
from vision.refusal import Refusal

_LIBRARIES = ("numpy", "scipy", "opencv-contrib-python-headless", "scikit-image")


def main() -> None:
    """Run, print, and keep."""
    options = _options()
    poses: list[PoseScore] = []
    rings: list[RingScore] = []
    refused: list[str] = []
    for picture in pictures(options.count, options.first):
        poses += pose_scores(picture)
        rings += ring_scores(picture)
        if isinstance(picture.findings.result, Refusal):
            refused.append(f"{picture.sample.name} {picture.findings.result.code}")
    rooms = [outcome for seed in _seeds(options.first, options.rooms) for outcome in outcomes(seed)]
    tables = {
        f"Pose from the same 12 fiducials ({len(GROUPS)} groups of {options.count} images)": pose_rows(poses),
        "Ring finders on the same straightened images": ring_rows(rings),
        "Whole strategies in the same rooms": strategy_rows(rooms),
    }
    for title, rows in tables.items():
        print_table(title, rows)
    print(f"seeds from {options.first}; refused by this project's gates, so not in the first table: {len(refused)}")
    print("".join(f"  {text}\n" for text in refused), end="")
    if options.folder is not None:
        _keep(options, tables, poses, rings, rooms)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=6, help="images of each group (default 6)")
    parser.add_argument("--rooms", type=int, default=20, help="rooms for the strategies (default 20)")
    parser.add_argument("--first", type=int, default=0, help="seed of the first image and room (default 0)")
    parser.add_argument("--folder", type=Path, help="where results.json and the plots go")
    options = parser.parse_args()
    if options.count < 1 or options.rooms < 1:
        parser.error("--count and --rooms are at least 1")
    return options


def _seeds(first: int, count: int) -> Iterator[int]:
    yield from range(first, first + count)


def _keep(
    options: argparse.Namespace,
    tables: dict[str, Any],
    poses: list[PoseScore],
    rings: list[RingScore],
    rooms: list[Outcome],
) -> None:
    folder: Path = options.folder
    folder.mkdir(parents=True, exist_ok=True)
    kept = {
        "at": datetime.now(UTC).isoformat(timespec="seconds"),
        "count": options.count,
        "rooms": options.rooms,
        "first": options.first,
        "libraries": {name: version(name) for name in _LIBRARIES},
        "tables": tables,
        "poses": [asdict(score) for score in poses],
        "rings": [asdict(score) for score in rings],
        "strategies": [asdict(outcome) for outcome in rooms],
    }
    (folder / "results.json").write_text(json.dumps(kept, indent=1) + "\n")
    plot_poses(poses, folder / "poses.png")
    plot_rings(rings, folder / "rings.png")
    plot_strategies(rooms, folder / "strategies.png")


if __name__ == "__main__":
    main()
