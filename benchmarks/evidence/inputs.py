"""What the trials of a whole case begin with, made once: prepared folders, a recorded one, the calls that it takes.

A prepared folder has schema, key and surgeon, and the results of a case yet to be recorded. With small images each
system call of the case can be made to fail in turn; whole ones fill the journal, so that it is written into the
database amid the case.
"""

import pickle
import shutil
from collections.abc import Callable
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from tempfile import NamedTemporaryFile, TemporaryDirectory

import numpy as np
from argon2 import PasswordHasher
from pydicom import dcmread

from benchmarks.computed_results import compute
from benchmarks.evidence.failing_calls import CALLS, writing_calls
from benchmarks.evidence.system_calls import Call, recorded, untroubled
from benchmarks.evidence.whole_case import RECORDED, RESULTS, SMALL, WHOLE, settings_of
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.database.current import current_database

_SMALL_PX = 96  # sides of a small image


def prepare_all(inputs: Path) -> None:
    """Whatever is missing of them."""
    _make(inputs / SMALL, lambda folder: prepare(folder, small=True))
    _make(inputs / WHOLE, lambda folder: prepare(folder, small=False))
    _make(inputs / RECORDED, lambda folder: _record(inputs / SMALL, folder))
    if not (inputs / CALLS).exists():
        with NamedTemporaryFile("w", dir=inputs, delete=False) as calls:
            calls.write("\n".join(writing_calls(_recorded_calls(inputs / SMALL))))
        Path(calls.name).replace(inputs / CALLS)


def prepare(folder: Path, *, small: bool) -> None:
    """A prepared folder, which is there and empty."""
    settings = settings_of(folder)
    with current_database(settings) as database:
        UserStore(database, PasswordHasher(1, 8, 1)).add("anna", Role.SURGEON, "correct horse", "2468")
    results = compute(settings)
    if small:
        results = replace(results, images=tuple(_cropped(image) for image in results.images))
    (folder / RESULTS).write_bytes(pickle.dumps(results))


def _make(folder: Path, fill: Callable[[Path], None]) -> None:
    """A folder that is whole or not there; of two runs that make it at once the first to be done has made it."""
    if folder.exists():
        return
    with TemporaryDirectory(dir=folder.parent) as place:
        begun = Path(place) / "data"
        begun.mkdir()
        fill(begun)
        try:
            begun.rename(folder)
        except OSError:
            if not folder.exists():
                raise


def _cropped(image: bytes) -> bytes:
    dataset = dcmread(BytesIO(image))
    dataset.PixelData = np.ascontiguousarray(dataset.pixel_array[:_SMALL_PX, :_SMALL_PX]).tobytes()
    dataset.Rows = dataset.Columns = _SMALL_PX
    file = BytesIO()
    dataset.save_as(file)
    return file.getvalue()


def _record(prepared: Path, folder: Path) -> None:
    shutil.copytree(prepared, folder, dirs_exist_ok=True)
    untroubled(folder)


def _recorded_calls(prepared: Path) -> list[Call]:
    with TemporaryDirectory() as place:
        victim = Path(place) / "data"
        shutil.copytree(prepared, victim)
        return recorded(victim)
