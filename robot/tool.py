"""The TCP calibration file: where the guide is on the flange, what it weighs and how big it is."""

import hashlib
from collections.abc import Mapping, Set
from dataclasses import dataclass
from datetime import date

import numpy as np
from scipy.spatial.transform import Rotation

from robot.envelope import Envelope, read_envelope
from robot.frames import Array, Transform
from robot.table import Table, expiry, number, parse_table, refuse_unknown, subtable, text, vector


@dataclass(frozen=True, slots=True, eq=False)
class Tool:
    """A calibrated tool.

    Attributes
    ----------
    flange_from_guide : (4, 4), mm
        The TCP that the controller must have active.
    payload_centre_mm : (3,)
        Centre of mass in the flange frame.
    tcp_tolerance_mm, tcp_tolerance_rad, payload_tolerance_kg, payload_tolerance_mm : float
        How far the controller's values may be from these (H10).
    envelope : Envelope
        The room that guide and holder take up (H12).
    calibration_sd_mm, calibration_sd_rad : float
        Standard deviation of `flange_from_guide` along and about each axis: how well it was measured (H03).
    sha256 : str
        Of the file's bytes.
    """

    name: str
    version: str
    expires: date | None
    sha256: str
    flange_from_guide: Transform
    payload_kg: float
    payload_centre_mm: Array
    tcp_tolerance_mm: float
    tcp_tolerance_rad: float
    payload_tolerance_kg: float
    payload_tolerance_mm: float
    envelope: Envelope
    calibration_sd_mm: float
    calibration_sd_rad: float


_TOP = {"name", "version", "expires", "tcp", "payload", "tolerance", "calibration", "envelope"}

# Plausible ranges (H09): a metre taken for a millimetre, or a radian for a degree, falls outside one of them.
_TCP_MM = (20.0, 600.0)  # of the offset's length: the guide stands off the flange, within an arm's tool
_TURN_DEG = (0.0, 360.0)  # of the rotation vector's length
_MASS_KG = (0.05, 5.0)  # a UR5 carries 5 kg
_CENTRE_MM = (0.0, 300.0)
_TOLERANCES = {
    "tcp_mm": (0.05, (0.001, 1.0)),
    "tcp_deg": (0.02, (0.001, 1.0)),
    "mass_kg": (0.05, (0.001, 1.0)),
    "centre_mm": (5.0, (0.1, 50.0)),
}


# How well a TCP is known that was calibrated with care (docs/method.md, two images).
_CALIBRATION = {
    "translation_sd_mm": (0.1, (0.001, 5.0)),
    "rotation_sd_deg": (0.05, (0.0001, 5.0)),
}
_CALIBRATION_RECORD = {"images", "residual_mm", "residual_deg", "cost_ratio"}  # what `calibrate-tcp` says of itself


def read_tool(data: bytes) -> Tool:
    """Read a TCP calibration file (TOML).

    Raises
    ------
    ValueError
        With one line, on missing or implausible values (H09).
    """
    file = parse_table(data, "TCP calibration")
    refuse_unknown(file, "the TCP calibration's", _TOP)
    tcp, payload = subtable(file, "tcp"), subtable(file, "payload")
    tolerance = _optional(file, "tolerance", _TOLERANCES)
    calibration = _optional(file, "calibration", _CALIBRATION, _CALIBRATION_RECORD)
    return Tool(
        name=text(file, "name"),
        version=text(file, "version"),
        expires=expiry(file),
        sha256=hashlib.sha256(data).hexdigest(),
        flange_from_guide=_transform(tcp),
        payload_kg=number(payload, "mass_kg", _MASS_KG),
        payload_centre_mm=vector(payload, "centre_mm", _CENTRE_MM),
        tcp_tolerance_mm=tolerance["tcp_mm"],
        tcp_tolerance_rad=float(np.deg2rad(tolerance["tcp_deg"])),
        payload_tolerance_kg=tolerance["mass_kg"],
        payload_tolerance_mm=tolerance["centre_mm"],
        envelope=read_envelope(subtable(file, "envelope")),
        calibration_sd_mm=calibration["translation_sd_mm"],
        calibration_sd_rad=float(np.deg2rad(calibration["rotation_sd_deg"])),
    )


def _optional(
    file: Table, key: str, known: Mapping[str, tuple[float, tuple[float, float]]], unread: Set[str] = frozenset()
) -> dict[str, float]:
    """A table that may be left out, each of its numbers with a default and a range."""
    given = subtable(file, key) if key in file else {}
    refuse_unknown(given, f"[{key}]", set(known) | unread)
    return {name: number(given, name, allowed, default) for name, (default, allowed) in known.items()}


def _transform(tcp: Table) -> Transform:
    flange_from_guide = np.eye(4)
    turn_deg = vector(tcp, "rotation_vector_deg", _TURN_DEG)
    flange_from_guide[:3, :3] = Rotation.from_rotvec(turn_deg, degrees=True).as_matrix()
    flange_from_guide[:3, 3] = vector(tcp, "translation_mm", _TCP_MM)
    return flange_from_guide
