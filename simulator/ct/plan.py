"""Which CT is the patient, and the paths planned in it: the part of the truth file that says so."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simulator.pedicle import Pedicle

Array = NDArray[np.float64]

_POINTS = ("entry_mm", "target_mm")


@dataclass(frozen=True, slots=True)
class PlannedCt:
    """Where the CT is (a NIfTI file, or the folder of a DICOM series), and its pedicles by name."""

    path: Path
    pedicles: Mapping[str, Pedicle]


def read_plan(table: Any, folder: Path) -> PlannedCt:
    """The CT of a `[ct]` table, its path relative to the folder of its file.

    Raises
    ------
    ValueError
        In one line, on other keys, on a CT without pedicles, and on points that are not three numbers.
    """
    if not isinstance(table, dict) or sorted(table) != ["path", "pedicles"]:
        raise ValueError("[ct] of the truth has not exactly a path and a table [ct.pedicles.NAME] for every pedicle")
    path, pedicles = table["path"], table["pedicles"]
    if not isinstance(path, str):
        raise ValueError("ct.path of the truth is no text: it names a NIfTI file or a folder")
    if not isinstance(pedicles, dict) or not pedicles:
        raise ValueError("ct.pedicles of the truth plans nothing: a table [ct.pedicles.NAME] for every pedicle")
    return PlannedCt(folder / path, {name: _pedicle(name, points) for name, points in pedicles.items()})


def _pedicle(name: str, table: Any) -> Pedicle:
    if not isinstance(table, dict) or sorted(table) != sorted(_POINTS):
        raise ValueError(f"ct.pedicles.{name} of the truth has not exactly {' and '.join(_POINTS)}")
    entry, target = (_point(f"ct.pedicles.{name}.{key}", table[key]) for key in _POINTS)
    if np.array_equal(entry, target):
        raise ValueError(f"ct.pedicles.{name} of the truth has its entry at its target")
    return Pedicle(name, entry, target)


def _point(name: str, value: Any) -> Array:
    numbers = value if isinstance(value, list) else []
    if len(numbers) != 3 or any(isinstance(one, bool) or not isinstance(one, int | float) for one in numbers):
        raise ValueError(f"{name} of the truth is not three numbers (LPS, mm)")
    if not all(math.isfinite(one) for one in numbers):
        raise ValueError(f"{name} of the truth is not finite")
    return np.array(numbers, dtype=np.float64)
