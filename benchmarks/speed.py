"""Times `register` against three steps of OpenCV on the same images, its memory, and `coaxial register` on many images.

    python benchmarks/speed.py [SAMPLES_FOLDER] [--rounds N] [--many N]

The yardstick is Gaussian 3 x 3, Canny and remap of the image by OpenCV, timed in turn with `register` in this process,
warm. Without a folder, scenes of the simulator's renderer serve (the same every time). Exit status 1 where a limit is
missed. OpenCV works on all cores, so that by the wall it gains what `register` does not; on a machine that does other
work the processor times tell more.
"""

import argparse
import cProfile
import os
import pstats
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import astuple, dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.samples import Sample, samples
from benchmarks.scenes import GROUPS, scene
from vision.refusal import Refusal
from vision.registration import register
from vision.xray import XrayImage, decode

GREATEST_RATIO = 12.0  # median of register's time over that of OpenCV's three steps
GREATEST_MEMORY_MB = 150.0  # of one registration above the imports
LEAST_SPEED_UP = 1.4  # of `coaxial register` by the second core; starting it costs some of it
SIDE_PX = 1024  # of the images that the limits are about; 8 bits
SCENES_OF_A_GROUP = 3
STAGES = (
    "correct",
    "find_lattice",
    "fit",
    "find_candidates",
    "ring_candidates",
    "first_views",
    "find",
    "fit_roughly",
    "measure",
    "cut_pieces",
    "fit_contour",
    "measure_line_ends",
    "locate_bead",
    "rings_left",
)
_DEVICES = Path(__file__).parents[1] / "simulator" / "devices"


@dataclass(frozen=True)
class Times:
    """Seconds of one image: by the wall and by the processor, of `register` and of OpenCV's three steps."""

    register_wall: float
    register_cpu: float
    opencv_wall: float
    opencv_cpu: float


def scenes() -> Iterator[Sample]:
    """Rendered images of every group."""
    for group in GROUPS:
        yield from (scene(group, seed) for seed in range(SCENES_OF_A_GROUP))


def opencv_steps(pixels: NDArray[np.uint8]) -> Callable[[], object]:
    """Gaussian 3 x 3, Canny and remap of an image."""
    u, v = np.meshgrid(np.arange(pixels.shape[1], dtype=np.float32), np.arange(pixels.shape[0], dtype=np.float32))

    def run() -> object:
        return (
            cv2.GaussianBlur(pixels, (3, 3), 0.0),
            cv2.Canny(pixels, 50.0, 150.0),
            cv2.remap(pixels, u, v, cv2.INTER_LINEAR),
        )

    return run


def timed(work: Callable[[], object]) -> tuple[float, float]:
    """Wall and processor seconds of one call."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - wall, time.process_time() - cpu


def times(sample: Sample, image: XrayImage, rounds: int) -> Times:
    """Medians over rounds in which both take turns, after one that warms them up."""
    yardstick = opencv_steps(np.asarray(sample.pixels, dtype=np.uint8))
    table = np.array(
        [(*timed(lambda: register(image, sample.guide, sample.carm)), *timed(yardstick)) for _ in range(rounds + 1)]
    )
    return Times(*np.median(table[1:], axis=0).tolist())


def shares(chosen: list[tuple[Sample, XrayImage]]) -> dict[str, float]:
    """Share of `register`'s time that each stage takes, those inside it counted; by the profiler, which adds some."""
    profile = cProfile.Profile()
    for sample, image in chosen:
        profile.runcall(register, image, sample.guide, sample.carm)
    spent: dict[str, float] = {}
    for (file, _, name), row in pstats.Stats(profile).stats.items():  # type: ignore[attr-defined]  # untyped in typeshed
        if f"{os.sep}vision{os.sep}" in file:
            spent[name] = spent.get(name, 0.0) + row[3]
    return {name: spent.get(name, 0.0) / spent["register"] for name in STAGES}


def memory_mb(sample: Sample, folder: Path) -> float:
    """Peak memory of one registration in a fresh process, above what it holds with everything imported.

    Linux's own account of the process: `getrusage` would count what the parent held when it started the process.
    """
    script = (
        "import sys\n"
        "from pathlib import Path\n"
        "from vision.devices import read_carm, read_guide\n"
        "from vision.registration import register\n"
        "from vision.xray import decode\n"
        "status = lambda: dict(line.split(':', 1) for line in open('/proc/self/status'))\n"
        "held_mb = lambda name: int(status()[name].split()[0]) / 1024.0\n"
        "image, guide, carm = (Path(name).read_bytes() for name in sys.argv[1:])\n"
        "before = held_mb('VmRSS')\n"
        "register(decode(image), read_guide(guide), read_carm(carm))\n"
        "print(held_mb('VmHWM') - before)\n"
    )
    files = written(sample, folder)
    done = subprocess.run([sys.executable, "-c", script, *map(str, files)], capture_output=True, text=True, check=True)
    return float(done.stdout)


def written(sample: Sample, folder: Path) -> tuple[Path, Path, Path]:
    """The sample as files: image, guide, C-arm."""
    path = folder / f"{sample.name.replace(':', '-')}.png"
    cv2.imwrite(str(path), sample.pixels)
    carm = "carm-flat-panel.toml" if sample.carm.plate is None else "carm-intensifier.toml"
    return path, _DEVICES / "guide.toml", _DEVICES / carm


def many(chosen: list[Sample], count: int, cores: int, folder: Path) -> float:
    """Wall seconds of `coaxial register` on this many images, those of one C-arm over and over."""
    chosen = [sample for sample in chosen if sample.carm.plate is not None]
    images = [str(written(chosen[index % len(chosen)], folder)[0]) for index in range(count)]
    _, guide, carm = written(chosen[0], folder)
    script = (
        "import os, sys\n"
        f"os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:{cores}])\n"
        "from service.cli.main import main\n"
        "if __name__ == '__main__':\n"
        "    main()\n"
    )
    (folder / "register.py").write_text(script)
    command = [sys.executable, str(folder / "register.py"), "register", *images]
    started = time.perf_counter()
    done = subprocess.run(
        [*command, "--guide", str(guide), "--carm", str(carm)], capture_output=True, text=True, check=False
    )
    if len(done.stdout.splitlines()) != count:
        sys.exit(f"coaxial register answered {len(done.stdout.splitlines())} of {count} images: {done.stderr}")
    return time.perf_counter() - started


def judged(name: str, value: float, limit: float, *, at_most: bool) -> bool:
    """Print one figure beside its limit; whether it holds."""
    held = value <= limit if at_most else value >= limit
    by = "" if held else f"  MISSED by {abs(value - limit):.2f}"
    print(f"{name:<58} {value:8.2f}  {'at most' if at_most else 'at least'} {limit:g}{by}")
    return held


def judged_times(found: list[Times], names: list[str]) -> list[bool]:
    """Print the times of every image, and by both clocks the ratio of their medians; whether these hold."""
    print(f"{'':>10} {'register ms':>22} {'OpenCV ms':>18} {'ratio':>16}")
    print(f"{'image':>10} {'wall':>11} {'processor':>10} {'wall':>8} {'processor':>9} {'wall':>6} {'processor':>9}")
    median = Times(*np.median([astuple(row) for row in found], axis=0).tolist())
    for name, row in zip([*names, "median"], [*found, median], strict=True):
        print(
            f"{name:>10} {row.register_wall * 1e3:11.1f} {row.register_cpu * 1e3:10.1f} "
            f"{row.opencv_wall * 1e3:8.2f} {row.opencv_cpu * 1e3:9.2f} "
            f"{row.register_wall / row.opencv_wall:6.1f} {row.register_cpu / row.opencv_cpu:9.1f}"
        )
    print()
    by_clock = {"wall": median.register_wall / median.opencv_wall, "processor": median.register_cpu / median.opencv_cpu}
    return [
        judged(f"register over Gaussian 3 x 3 + Canny + remap, {clock}", ratio, GREATEST_RATIO, at_most=True)
        for clock, ratio in by_clock.items()
    ]


def main() -> None:
    """Print the figures; exit 1 where a limit is missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "folder", type=Path, nargs="?", help="folder of NNN.png and NNN.json (default: rendered scenes)"
    )
    parser.add_argument("--rounds", type=int, default=5, help="timings of each image (default 5)")
    parser.add_argument("--many", type=int, default=50, help="images for `coaxial register` (default 50)")
    options = parser.parse_args()
    chosen: list[tuple[Sample, XrayImage]] = []
    for sample in samples(options.folder) if options.folder else scenes():
        image = decode(cv2.imencode(".png", sample.pixels)[1].tobytes())
        if not isinstance(image, Refusal) and sample.pixels.dtype == np.uint8 and sample.pixels.shape == (SIDE_PX,) * 2:
            chosen.append((sample, image))
    if not chosen:
        sys.exit(f"no image of 8 bits and {SIDE_PX} x {SIDE_PX} pixels")
    held = judged_times([times(sample, image, options.rounds) for sample, image in chosen], [s.name for s, _ in chosen])
    print("shares: " + ", ".join(f"{name} {share:.0%}" for name, share in shares(chosen).items()))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        memory = max(memory_mb(sample, folder) for sample, _ in chosen[:2])
        one, two = (many([sample for sample, _ in chosen], options.many, cores, folder) for cores in (1, 2))
    print(f"coaxial register on {options.many} images: {one:.1f} s on one core, {two:.1f} s on two")
    held += [
        judged("peak memory of a registration above import (MB)", memory, GREATEST_MEMORY_MB, at_most=True),
        judged("speed-up of coaxial register by the second core", one / two, LEAST_SPEED_UP, at_most=False),
    ]
    sys.exit(0 if all(held) else 1)


if __name__ == "__main__":
    main()
