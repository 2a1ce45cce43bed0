"""The totals that the method's authors report of their own work, of this case."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from service.report.course import Judgement, TargetWork
from service.report.record import CaseImage, CaseRecord

_DOSE = "dose_area_product_dgy_cm2"  # key in an image's metadata


@dataclass(frozen=True, slots=True)
class Exposures:
    """So many images; the dose-area product is that of the `dosed` ones whose C-arm told one, None where none did."""

    images: int
    dosed: int
    dose_dgy_cm2: float | None


def exposures_of(images: Iterable[CaseImage]) -> Exposures:
    """How many, and their dose."""
    doses = [dose_of(one) for one in images]
    told = [one for one in doses if one is not None]
    return Exposures(len(doses), len(told), sum(told) if told else None)


def dose_of(image: CaseImage) -> float | None:
    """The dose-area product in dGy cm2, where the C-arm told one."""
    dose: float | None = image.stored.metadata.get(_DOSE)
    return dose


@dataclass(frozen=True, slots=True)
class Totals:
    """Figures of a whole case; None where there is nothing to take one from.

    Errors are the largest with which a target was last verified.
    """

    targets_placed: int
    exposures: Exposures
    images_per_target: float | None
    minutes_per_target: float | None
    angle_deg: float | None
    position_mm: float | None
    paper_angle_deg: float | None
    paper_position_mm: float | None


def totals_of(record: CaseRecord, course: Sequence[TargetWork]) -> Totals:
    """Every image that the case was given counts, whatever it was for; time counts of targets that were placed."""
    placed = len({one.name for one in course if one.placed})
    seconds = [one.seconds for one in course]
    known = [one for one in seconds if one is not None]
    finals = [one.final for one in course if one.final is not None]
    return Totals(
        targets_placed=placed,
        exposures=exposures_of(record.images.values()),
        images_per_target=len(record.images) / placed if placed else None,
        minutes_per_target=sum(known) / 60.0 / placed if placed and len(known) == len(seconds) else None,
        angle_deg=_largest(finals, "contour", "angle_error_deg"),
        position_mm=_largest(finals, "contour", "position_error_mm"),
        paper_angle_deg=_largest(finals, "paper", "angle_error_deg"),
        paper_position_mm=_largest(finals, "paper", "position_error_mm"),
    )


def _largest(judgements: Sequence[Judgement], way: str, name: str) -> float | None:
    return max((float(one.figures[way][name]) for one in judgements), default=None)
