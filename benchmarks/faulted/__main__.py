"""Registers scenes with one thing wrong each and counts what was accepted and wrong: beyond 0.5 deg or 1.0 mm.

    python -m benchmarks.faulted --folder FOLDER [--count N] [--first SEED] [--processes P] [--faults NAME ...]
        [--published FILE] [--page FILE]

Scenes are drawn by fault and seed; N counts them over all faults, `nothing` included, twenty seeds of each in turn.
Every scene is a line of FOLDER/FAULT.jsonl, and what was done is added to the published results (by default
FOLDER/published.json), however the run ends. A run goes on where the last one of the same code ended: what is published
or kept is not run again. Exit status 1 where any accepted result is wrong, or a scene could not be run.
"""

import argparse
import math
import sys
from functools import partial
from itertools import zip_longest

from benchmarks.evidence.runs import begin, finish, left, publish, workers
from benchmarks.faulted.page import page
from benchmarks.faulted.trials import ITEMS
from benchmarks.kept import at_least_one, results_file, results_folder
from simulator.carm.faulted import Fault


def main() -> None:
    """Run what is missing, publish, print the page."""
    options = _options()
    published = options.published or options.folder / "published.json"
    seeds = range(options.first, options.first + math.ceil(options.count / len(options.faults)))
    asked, items, whole = [ITEMS[fault] for fault in options.faults], list(ITEMS.values()), True
    if seeds:
        with workers(options.processes, partial(publish, items, options.folder, published)) as pool:
            todo = [[(item, part) for part in left(item, options.folder, published, seeds)] for item in asked]
            in_turn = [one for turn in zip_longest(*todo) for one in turn if one is not None]
            whole = finish("faulted", [begin(item, options.folder, part, pool) for item, part in in_turn])
    states = publish(items, options.folder, published)
    text = page(states)
    print(f"\n{text}")
    if options.page is not None:
        options.page.write_text(text)
    sys.exit(0 if whole and not any(listed[-1].bad for listed in states.values()) else 1)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=results_folder, required=True, help="where the results are kept")
    parser.add_argument("--count", type=int, default=1000, help="scenes over all faults (default 1000)")
    parser.add_argument("--first", type=int, default=0, help="seed of each fault's first scene (default 0)")
    parser.add_argument("--processes", type=at_least_one, default=1)
    parser.add_argument("--faults", nargs="+", type=Fault, default=list(Fault), help="by default all")
    parser.add_argument("--published", type=results_file, help="results so far (default FOLDER/published.json)")
    parser.add_argument("--page", type=results_file, help="where the page is written, beside being printed")
    return parser.parse_args()


if __name__ == "__main__":
    main()
