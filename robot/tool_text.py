"""A new TCP calibration file, as `robot.tool` reads it."""

from collections.abc import Iterable
from datetime import date

import numpy as np
from scipy.spatial.transform import Rotation

from robot.frames import Array
from robot.hand_eye import HandEye
from robot.tool import Tool


def tool_text(tool: Tool, found: HandEye, version: str, expires: date) -> str:
    """The file (TOML) of a tool whose place on the flange was calibrated anew; all else is as it was."""
    turn_deg = Rotation.from_matrix(found.flange_from_guide[:3, :3]).as_rotvec(degrees=True)
    envelope = tool.envelope
    lines = [
        f'name = "{_escaped(tool.name)}"',
        f'version = "{_escaped(version)}"',
        f"expires = {expires.isoformat()}",
        "",
        "[tcp]",
        f"translation_mm = {_numbers(found.flange_from_guide[:3, 3])}",
        f"rotation_vector_deg = {_numbers(turn_deg)}",
        "",
        "[payload]",
        f"mass_kg = {tool.payload_kg!r}",
        f"centre_mm = {_numbers(tool.payload_centre_mm)}",
        "",
        "[tolerance]",
        f"tcp_mm = {tool.tcp_tolerance_mm!r}",
        f"tcp_deg = {_degrees(tool.tcp_tolerance_rad)}",
        f"mass_kg = {tool.payload_tolerance_kg!r}",
        f"centre_mm = {tool.payload_tolerance_mm!r}",
        "",
        "[envelope]",
        f"radius_mm = {envelope.radius_mm!r}",
        f"below_mm = {envelope.below_mm!r}",
        f"above_mm = {envelope.above_mm!r}",
        f"holder_radius_mm = {envelope.holder_radius_mm!r}",
        *_rods(tool),
        "",
        "[calibration]",
        f"images = {len(found.off_mm)}",
        f"translation_sd_mm = {found.translation_sd_mm:.4f}",
        f"rotation_sd_deg = {np.rad2deg(found.rotation_sd_rad):.4f}",
        f"residual_mm = {_rms(found.off_mm):.4f}",
        f"residual_deg = {np.rad2deg(_rms(found.off_rad)):.4f}",
        f"cost_ratio = {found.cost_ratio:.3f}",
    ]
    return "\n".join(lines) + "\n"


def _rods(tool: Tool) -> Iterable[str]:
    rods = tool.envelope.rods
    for name, start_mm, end_mm, radius_mm in zip(
        rods.names, rods.starts_mm, rods.ends_mm, rods.radii_mm.tolist(), strict=True
    ):
        yield from (
            "",
            "[[envelope.rod]]",
            f'name = "{_escaped(name)}"',
            f"start_mm = {_numbers(start_mm)}",
            f"end_mm = {_numbers(end_mm)}",
            f"radius_mm = {radius_mm!r}",
        )


def _numbers(vector: Array) -> list[float]:
    return [round(float(value), 6) for value in vector]


def _degrees(angle_rad: float) -> float:
    """Without the last bits that the way through radians costs."""
    return round(float(np.rad2deg(angle_rad)), 9)


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"')


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
