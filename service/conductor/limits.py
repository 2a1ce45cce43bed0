"""The limits of the interlocks, from the settings of the site."""

import math

from service.settings import ProcedureLimits
from workflow.limits import Limits


def limits_from(settings: ProcedureLimits) -> Limits:
    """What the site may set, the rest as the rules have it."""
    return Limits(
        exposure_window_s=settings.exposure_window_s,
        image_age_s=settings.image_age_s,
        permit_life_s=settings.permit_s,
        angle_error_rad=math.radians(settings.angle_error_deg),
        position_error_mm=settings.position_error_mm,
    )
