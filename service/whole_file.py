"""Files that are there whole or not at all: neither a fault nor a crash nor a power cut leaves half of one."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import get_native_id


@contextmanager
def whole_file(file: Path, *, is_new: bool = False) -> Iterator[Path]:
    """A path beside the file's to write to; what is there at the end takes the file's place, on the disk too; OSError.

    Where anything is raised within, the file stays as it was and the part goes away. A file that `is_new` takes no
    other's place: FileExistsError.
    """
    part = file.with_name(f".{file.name}.{get_native_id()}")
    try:
        yield part
        _sync(part)  # else the new name may survive a power cut and its content not
        if is_new:
            os.link(part, file)
        else:
            part.replace(file)
        _sync(file.parent)
    finally:
        with suppress(OSError):  # as where its folder is none
            part.unlink(missing_ok=True)


def _sync(path: Path) -> None:
    opened = os.open(path, os.O_RDONLY)
    try:
        os.fsync(opened)
    finally:
        os.close(opened)
