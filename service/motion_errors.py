"""How well the arm's own word of a motion is known: what two images are held against (H03)."""

import math
from typing import Any

from robot.tool import Tool
from service.settings import ArmAccuracy


def motion_errors(arm: ArmAccuracy, tool: Tool) -> dict[str, Any]:
    """Standard deviations of the arm's poses, by the site, and of the TCP calibration, by its file."""
    return {
        "arm_sd_mm": arm.position_sd_mm,
        "arm_sd_deg": arm.rotation_sd_deg,
        "tcp_sd_mm": tool.calibration_sd_mm,
        "tcp_sd_deg": math.degrees(tool.calibration_sd_rad),
    }
