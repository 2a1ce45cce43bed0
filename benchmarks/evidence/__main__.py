"""Runs the evidence, or goes on with it, publishes what was done, and writes its page.

    python -m benchmarks.evidence --folder FOLDER [--items NAME ...] [--share 0.01] [--processes 2] [--page FILE]

Every trial is kept in FOLDER, and what was done is added to the published results, however the run ends. A run goes on
where the last one of the same code ended: what is published or kept is not run again. --share runs only so much of each
item, 0 none of it. Exit status 1 where a trial is bad or could not be run.
"""

import argparse
import math
import sys
from functools import partial

from benchmarks.evidence.code import ROOT
from benchmarks.evidence.item import Item
from benchmarks.evidence.items import ITEMS
from benchmarks.evidence.page import page
from benchmarks.evidence.runs import begin, finish, left, planned, publish, row, workers
from benchmarks.kept import at_least_one, results_file, results_folder

PUBLISHED = ROOT / "docs" / "evidence.json"


def main() -> None:
    """Run what is missing, print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=results_folder, required=True, help="where the results are kept")
    parser.add_argument("--items", nargs="+", choices=[item.name for item in ITEMS], help="to be run; by default all")
    parser.add_argument("--share", type=float, default=1.0, help="of each item's trials (default 1: all)")
    parser.add_argument("--processes", type=at_least_one, default=2, help="at a time (default 2)")
    parser.add_argument(
        "--published", type=results_file, default=PUBLISHED, help="results so far (default docs/evidence.json)"
    )
    parser.add_argument("--page", type=results_file, help="where the page is written, beside being printed")
    options = parser.parse_args()
    whole = True
    if options.share:
        with workers(options.processes, partial(publish, ITEMS, options.folder, options.published)) as pool:
            asked = [item for item in ITEMS if options.items is None or item.name in options.items]
            begun = [
                (item.name, [begin(item, options.folder, part, pool) for part in _left(item, options)])
                for item in asked
            ]
            for name, parts in begun:
                whole &= finish(name, parts)
    states = publish(ITEMS, options.folder, options.published)
    rows = [row(item, options.folder, states[item.name]) for item in ITEMS]
    text = page(rows)
    print(f"\n{text}")
    if options.page is not None:
        options.page.write_text(text)
    sys.exit(0 if whole and not any(one.today.bad for one in rows) else 1)


def _left(item: Item, options: argparse.Namespace) -> list[list[int]]:
    count = math.ceil(planned(item, options.folder) * options.share)
    return left(item, options.folder, options.published, range(count))


if __name__ == "__main__":
    main()
