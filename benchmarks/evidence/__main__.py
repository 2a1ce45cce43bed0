"""Runs the evidence, or goes on with it, and writes its page.

    python -m benchmarks.evidence --folder FOLDER [--items NAME ...] [--share 0.01] [--page FILE]

Every trial is a line of FOLDER/NAME.jsonl; a run goes on where the last one ended. --share runs only so much of each
item. Exit status 1 where a trial is bad.
"""

import argparse
import json
import logging
import math
import sys
import time
from dataclasses import asdict
from pathlib import Path

import structlog

from benchmarks.evidence.item import Item, Summary, summary
from benchmarks.evidence.items import ITEMS
from benchmarks.evidence.page import page
from benchmarks.kept import keep_line, kept_lines


def run(item: Item, folder: Path, share: float) -> Summary:
    """What is missing of an item's trials, and what all of them amount to."""
    path = folder / f"{item.name}.jsonl"
    results = kept_lines(path)
    planned = item.count(folder)
    known = {trial["number"] for trial in results}
    todo = [number for number in range(math.ceil(planned * share)) if number not in known]
    started_s = time.monotonic()
    for first in range(0, len(todo), item.at_once):
        for trial in item.trials(folder, todo[first : first + item.at_once]):
            keep_line(path, trial)
            results.append(trial)
            if trial["bad"]:
                print(f"\nbad: {json.dumps(trial)}", file=sys.stderr)
        done = min(first + item.at_once, len(todo))
        left_min = (time.monotonic() - started_s) / done * (len(todo) - done) / 60.0
        print(f"\r{item.name}: {done} of {len(todo)}, {left_min:.0f} min left ", end="", file=sys.stderr, flush=True)
    return summary(results, planned * item.executions)


def main() -> None:
    """Run what is missing, print the page; exit 1 where a trial is bad."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, required=True, help="where the results are kept")
    parser.add_argument("--items", nargs="+", choices=[item.name for item in ITEMS], help="by default all")
    parser.add_argument("--share", type=float, default=1.0, help="of each item's trials (default 1: all)")
    parser.add_argument("--page", type=Path, help="where the page is written, beside being printed")
    options = parser.parse_args()
    structlog.configure(wrapper_class=structlog.make_filtering_bound_logger(logging.CRITICAL))
    logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)  # a refused hold is one to it
    options.folder.mkdir(parents=True, exist_ok=True)
    chosen = [item for item in ITEMS if options.items is None or item.name in options.items]
    rows = [(item, run(item, options.folder, options.share)) for item in chosen]
    figures = {item.name: asdict(found) for item, found in rows}
    (options.folder / "summary.json").write_text(json.dumps(figures, indent=1))
    text = page(rows)
    print(f"\n{text}")
    if options.page is not None:
        options.page.write_text(text)
    sys.exit(1 if any(found.bad for _, found in rows) else 0)


if __name__ == "__main__":
    main()
