"""An image as every later step reads it: absorption, distortion, and where the plate's balls lie."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision import gates
from vision.absorption import Absorption, absorption
from vision.devices import CArm
from vision.distortion import DistortionMap, PlateFit, exact
from vision.plate import MOST_CHANCE_BALLS, balls_on_any_lattice, find_lattice
from vision.plate_fit import fit
from vision.refusal import Refusal, RefusalCode
from vision.xray import XrayImage

Array = NDArray[np.float64]

_LEAST_FIELD_SHARE = 0.1  # a guide covers more of the smallest field
_BALL_HALO_PX = 2.0  # around a ball's rim: blur


@dataclass(frozen=True, slots=True, eq=False)
class CorrectedImage:
    """The image's absorption with its distortion; the radius of a ball's shadow, 0 without a plate."""

    absorption: Absorption
    plate: PlateFit
    ball_radius_px: float

    @property
    def balls_raw(self) -> Array:
        """(m, 3): raw pixel and radius with its halo."""
        sites = self.plate.sites
        return np.column_stack((sites, np.full(len(sites), self.ball_radius_px + _BALL_HALO_PX)))

    @property
    def balls_corrected(self) -> Array:
        """(m, 3): corrected pixel and radius."""
        corrected = self.plate.map.corrected_from_raw(self.plate.sites)
        return np.column_stack((corrected, np.full(len(corrected), self.ball_radius_px)))

    def share_inside(self, points: Array) -> float:
        """Share of corrected pixels (n, 2) that lie in the field."""
        raw = np.rint(self.plate.map.raw_from_corrected(points)).astype(np.intp)
        rows, columns = self.absorption.inside.shape
        seen: NDArray[np.bool_] = np.all((raw >= 0) & (raw < (columns, rows)), axis=1)
        return float(self.absorption.inside[raw[seen, 1], raw[seen, 0]].sum()) / len(points)


def correct(image: XrayImage, carm: CArm) -> CorrectedImage | Refusal:
    """Absorption and distortion of an image.

    Parameters
    ----------
    image : XrayImage
        Decoded.
    carm : CArm
        With a plate, whose balls are looked for, or without one: nothing is bent then.

    Returns
    -------
    CorrectedImage or Refusal
        `no_guide_found` where hardly any beam arrived, `plate_missing`, `plate_too_sparse`, `plate_unexpected` where
        the file knows of none, or `scale_mismatch` where plate or header contradict the file's pixel size.
    """
    seen = absorption(image)
    field_share = seen.field_area_px / seen.inside.size
    if field_share < _LEAST_FIELD_SHARE:
        message = "share of the image that the beam reached"
        return Refusal(RefusalCode.NO_GUIDE_FOUND, message, field_share, _LEAST_FIELD_SHARE)
    file_pixel_mm = carm.field_of_view_mm / max(image.rows, image.columns)
    if (told := _told_otherwise(image, carm, file_pixel_mm)) is not None:
        return told
    if carm.plate is None:
        return _without_plate(seen, image, file_pixel_mm)
    lattice = find_lattice(seen, carm.plate, file_pixel_mm)
    if isinstance(lattice, Refusal):
        return lattice
    plate = fit(lattice.raw, lattice.places, image.rows, image.columns, carm.plate.ball_spacing_mm)
    refusal = gates.check_scale(plate.map.pixel_size_mm, file_pixel_mm)
    return refusal or CorrectedImage(seen, plate, carm.plate.ball_diameter_mm / 2.0 / plate.map.pixel_size_mm)


def _told_otherwise(image: XrayImage, carm: CArm, file_pixel_mm: float) -> Refusal | None:
    """H06: another field than the file's, where the image's header tells it; an intensifier's size is nominal."""
    greatest_off = gates.GREATEST_TOLD_SCALE_OFF if carm.plate is None else gates.GREATEST_SCALE_OFF
    return None if image.pixel_mm is None else gates.check_told_scale(image.pixel_mm, file_pixel_mm, greatest_off)


def _without_plate(seen: Absorption, image: XrayImage, file_pixel_mm: float) -> CorrectedImage | Refusal:
    """H06: nothing is bent, unless balls show that it is an intensifier's image after all."""
    balls = balls_on_any_lattice(seen, file_pixel_mm)
    if balls > MOST_CHANCE_BALLS:
        message = "balls of a correction plate, of which the C-arm file knows nothing"
        return Refusal(RefusalCode.PLATE_UNEXPECTED, message, balls, MOST_CHANCE_BALLS)
    return CorrectedImage(seen, exact(DistortionMap.identity(image.rows, image.columns, file_pixel_mm)), 0.0)
