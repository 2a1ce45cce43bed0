"""The device files of the room, as the product gets them, and the room's own reading of the few values it needs."""

import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simulator.carm.guide import GuideShape

Array = NDArray[np.float64]

FOLDER = Path(__file__).parent
GUIDE_FILE, TCP_FILE, ROOM_FILE = FOLDER / "guide.toml", FOLDER / "tcp.toml", FOLDER / "room.toml"
INTENSIFIER_FILE, FLAT_PANEL_FILE = FOLDER / "carm-intensifier.toml", FOLDER / "carm-flat-panel.toml"
# What the product is told about this room, by kind of file.
DEVICE_FILES = {"guide": GUIDE_FILE, "carm": INTENSIFIER_FILE, "tcp": TCP_FILE, "room": ROOM_FILE}


@dataclass(frozen=True, slots=True, eq=False)
class Mounting:
    """How the guide is held, as calibrated: pose on the flange (4x4, mm) and payload."""

    flange_from_guide: Array
    mass_kg: float
    centre_mm: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class NominalCarm:
    """The C-arm as its file describes it."""

    source_to_image_mm: float
    field_of_view_mm: float
    intensifier: bool


def read_shape(file: Path = GUIDE_FILE) -> GuideShape:
    """The guide as its maker meant it."""
    table = tomllib.loads(file.read_text())
    return GuideShape(
        small_radius_mm=table["small_ring"]["radius"],
        big_radius_mm=table["big_ring"]["radius"],
        separation_mm=table["axis"]["separation"],
        line_start_mm=table["indicator_line"]["start"],
        line_end_mm=table["indicator_line"]["end"],
        wire_diameter_mm=table["wire"]["diameter"],
        bead_mm=tuple(table["bead"]["position"]),
        bead_diameter_mm=table["bead"]["diameter"],
    )


def read_mounting(file: Path = TCP_FILE) -> Mounting:
    """Where the guide is on the flange, as calibrated."""
    table = tomllib.loads(file.read_text())
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec(table["tcp"]["rotation_vector_deg"], degrees=True).as_matrix()
    pose[:3, 3] = table["tcp"]["translation_mm"]
    return Mounting(pose, table["payload"]["mass_kg"], tuple(table["payload"]["centre_mm"]))


def read_nominal_carm(file: Path = INTENSIFIER_FILE) -> NominalCarm:
    """The C-arm as its maker describes it."""
    table = tomllib.loads(file.read_text())
    return NominalCarm(
        source_to_image_mm=table["geometry"]["source_to_image_distance"],
        field_of_view_mm=table["detector"]["field_of_view"],
        intensifier=table["detector"]["kind"] == "image-intensifier",
    )
