"""Free-space preflight (H24): refuse before anything is begun, not in the middle of it."""

import shutil
from pathlib import Path

from service.errors import ErrorCode, ServiceError


def check_free_space(folder: Path, min_free_bytes: int) -> None:
    """ServiceError DISK_FULL when the disk of `folder` has less than `min_free_bytes` left."""
    free = shutil.disk_usage(folder).free
    if free < min_free_bytes:
        raise ServiceError(
            ErrorCode.DISK_FULL, "too little free space on the data folder's disk", measured=free, limit=min_free_bytes
        )
