"""The totals that the method's authors report of their own work, of this case."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.report.course import Judgement, TargetWork
from service.report.record import CaseRecord

DOSE = "dose_area_product_dgy_cm2"  # key in an image's metadata


@dataclass(frozen=True, slots=True)
class Totals:
    """Figures of a whole case; None where there is nothing to take one from.

    Errors are the largest with which a target was last verified. The dose is that of the `dosed` images whose C-arm
    told one.
    """

    targets_placed: int
    images: int
    images_per_target: float | None
    minutes_per_target: float | None
    angle_deg: float | None
    position_mm: float | None
    paper_angle_deg: float | None
    paper_position_mm: float | None
    dosed: int
    dose_dgy_cm2: float | None


def totals_of(record: CaseRecord, course: Sequence[TargetWork]) -> Totals:
    """Every image that the case was given counts, whatever it was for; time counts of targets that were placed."""
    placed = len({one.name for one in course if one.placed})
    seconds = [one.seconds for one in course]
    known = [one for one in seconds if one is not None]
    doses = [one.stored.metadata[DOSE] for one in record.images.values() if DOSE in one.stored.metadata]
    finals = [one.final for one in course if one.final is not None]
    return Totals(
        targets_placed=placed,
        images=len(record.images),
        images_per_target=len(record.images) / placed if placed else None,
        minutes_per_target=sum(known) / 60.0 / placed if placed and len(known) == len(seconds) else None,
        angle_deg=_largest(finals, "contour", "angle_error_deg"),
        position_mm=_largest(finals, "contour", "position_error_mm"),
        paper_angle_deg=_largest(finals, "paper", "angle_error_deg"),
        paper_position_mm=_largest(finals, "paper", "position_error_mm"),
        dosed=len(doses),
        dose_dgy_cm2=sum(doses) if doses else None,
    )


def _largest(judgements: Sequence[Judgement], way: str, name: str) -> float | None:
    return max((float(one.figures[way][name]) for one in judgements), default=None)
