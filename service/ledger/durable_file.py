"""A small file that is replaced whole, so that neither a crash nor a power cut leaves half of it."""

import os
from pathlib import Path


def replace_text(file: Path, text: str) -> None:
    """Written beside it, on the disk, then given its name, and that on the disk, too; OSError."""
    file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    part = file.with_suffix(f".{os.getpid()}")
    with part.open("w") as opened:
        opened.write(text)
        opened.flush()
        os.fsync(opened.fileno())  # else the new name may survive a power cut and its content not
    part.replace(file)
    folder = os.open(file.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
