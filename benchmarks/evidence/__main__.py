"""Runs the evidence, or goes on with it, and writes its page.

    python -m benchmarks.evidence --folder FOLDER [--items NAME ...] [--share 0.01] [--processes 2] [--page FILE]

Every trial is kept in FOLDER, and a run goes on where the last one of the same code ended. --share runs only so much of
each item, 0 none of it: then the page is made of what is kept. Exit status 1 where a trial is bad or could not be run.
"""

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path

from benchmarks.evidence.items import ITEMS
from benchmarks.evidence.page import page
from benchmarks.evidence.runs import begin, finish, row, workers


def main() -> None:
    """Run what is missing, print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, required=True, help="where the results are kept")
    parser.add_argument("--items", nargs="+", choices=[item.name for item in ITEMS], help="to be run; by default all")
    parser.add_argument("--share", type=float, default=1.0, help="of each item's trials (default 1: all)")
    parser.add_argument("--processes", type=int, default=2, help="at a time (default 2)")
    parser.add_argument("--page", type=Path, help="where the page is written, beside being printed")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    whole = True
    if options.share:
        with workers(options.processes) as pool:
            asked = [item for item in ITEMS if options.items is None or item.name in options.items]
            begun = [(item, begin(item, options.folder, options.share, pool)) for item in asked]
            for item, parts in begun:
                whole &= finish(item, parts)
    rows = [row(item, options.folder) for item in ITEMS]
    figures = {one.item.name: [asdict(state) for state in (one.today, *one.earlier)] for one in rows}
    (options.folder / "summary.json").write_text(json.dumps(figures, indent=1))
    text = page(rows)
    print(f"\n{text}")
    if options.page is not None:
        options.page.write_text(text)
    sys.exit(0 if whole and not any(one.today.bad for one in rows) else 1)


if __name__ == "__main__":
    main()
