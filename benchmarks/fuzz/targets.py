"""What is fuzzed, by name."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from benchmarks.fuzz import documents, images, wire
from benchmarks.fuzz.target import Input


@dataclass(frozen=True)
class Target:
    """Inputs, which take a second to make, and how many executions the whole proof and one trial of it have."""

    what: str
    inputs: Callable[[], Sequence[Input]]
    planned: int
    of_a_trial: int


TARGETS = {
    "dicom": Target("DICOM images of every transfer syntax", images.dicom_images, 500_000, 2_500),
    "pictures": Target("PNG and TIFF images", images.pictures, 500_000, 10_000),
    "device_files": Target("device files (TOML)", documents.device_files, 1_000_000, 20_000),
    "json": Target("JSON of commands, plans and lines to the guard", documents.json_documents, 1_000_000, 50_000),
    "hold_frames": Target("WebSocket frames of the held button", wire.hold_frames, 1_000_000, 50_000),
    "controller": Target("RTDE and dashboard replies, readings", wire.controller_replies, 1_000_000, 20_000),
}
