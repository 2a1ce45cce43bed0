"""The TCP calibration file: where the guide is on the flange, and what it weighs."""

from dataclasses import dataclass
from datetime import date

from robot.frames import Array, Transform


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


def read_tool(data: bytes) -> Tool:
    """Read a TCP calibration file (TOML).

    Raises
    ------
    ValueError
        With one line, on missing or implausible values (H09).
    """
    raise NotImplementedError
