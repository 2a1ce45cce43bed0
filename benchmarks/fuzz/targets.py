"""What is fuzzed, by name."""

import pkgutil
from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.fuzz.target import Input


@dataclass(frozen=True)
class Target:
    """Who makes the inputs, and how many executions the whole proof and one trial of it have.

    The module is imported when it is asked: a target's results are of its own code and not of the others'.
    """

    what: str
    module: str
    function: str
    planned: int
    of_a_trial: int

    def inputs(self) -> Sequence[Input]:
        """Valid inputs, which take a second to make."""
        made: Sequence[Input] = pkgutil.resolve_name(f"{self.module}:{self.function}")()
        return made


_IMAGES, _DOCUMENTS, _WIRE = (f"benchmarks.fuzz.{name}" for name in ("images", "documents", "wire"))
TARGETS = {
    "dicom": Target("DICOM images of every transfer syntax", _IMAGES, "dicom_images", 500_000, 2_500),
    "pictures": Target("PNG and TIFF images", _IMAGES, "pictures", 500_000, 10_000),
    "device_files": Target("device files (TOML)", _DOCUMENTS, "device_files", 1_000_000, 20_000),
    "json": Target("JSON of commands, plans and lines to the guard", _DOCUMENTS, "json_documents", 1_000_000, 50_000),
    "hold_frames": Target("WebSocket frames of the held button", _WIRE, "hold_frames", 1_000_000, 50_000),
    "controller": Target("RTDE and dashboard replies, readings", _WIRE, "controller_replies", 1_000_000, 20_000),
}
