"""The guide as an X-ray sees it: two wire tori, a straight wire, a bead, a thin radiolucent housing."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from simulator.carm.chords import ball_chord, ring_chord, rod_chord, shell_chord

Array = NDArray[np.float64]


class Part(StrEnum):
    """What a guide consists of, and what a test can take away."""

    SMALL_RING = "small_ring"
    BIG_RING = "big_ring"
    LINE = "line"
    BEAD = "bead"
    HOUSING = "housing"


ALL_PARTS = frozenset(Part)

METAL_PER_MM = 0.80
_HOUSING_PER_MM = 0.011
_HOUSING_OUTER_MM, _HOUSING_INNER_MM = 38.0, 34.0
_HOUSING_BEYOND_MM = 5.0  # it stands out over both rings


@dataclass(frozen=True, slots=True)
class GuideShape:
    """True dimensions in the guide frame, mm: the small ring in z = 0, the big one in z = -separation."""

    small_radius_mm: float = 20.0
    big_radius_mm: float = 30.0
    separation_mm: float = 60.0
    line_start_mm: float = 26.0
    line_end_mm: float = 66.0
    wire_diameter_mm: float = 1.2
    bead_mm: tuple[float, float, float] = (0.0, 45.0, -30.0)
    bead_diameter_mm: float = 3.0
    big_centre_mm: tuple[float, float] = (0.0, 0.0)
    parts: frozenset[Part] = ALL_PARTS

    def scaled(self, factor: float) -> "GuideShape":
        """Another size of the same guide, its wires and bead too."""
        x, y, z = self.bead_mm
        u, v = self.big_centre_mm
        return GuideShape(
            small_radius_mm=factor * self.small_radius_mm,
            big_radius_mm=factor * self.big_radius_mm,
            separation_mm=factor * self.separation_mm,
            line_start_mm=factor * self.line_start_mm,
            line_end_mm=factor * self.line_end_mm,
            wire_diameter_mm=factor * self.wire_diameter_mm,
            bead_mm=(factor * x, factor * y, factor * z),
            bead_diameter_mm=factor * self.bead_diameter_mm,
            big_centre_mm=(factor * u, factor * v),
            parts=self.parts,
        )

    def metal_outline(self) -> tuple[tuple[Array, float], ...]:
        """Points (n, 3) along every wire and at the bead, with its diameter: where to look closely at an image."""
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        circle = np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], axis=-1)
        along = np.linspace(self.line_start_mm, self.line_end_mm, 21)
        wire = self.wire_diameter_mm
        outlines = {
            Part.SMALL_RING: (circle * self.small_radius_mm, wire),
            Part.BIG_RING: (circle * self.big_radius_mm + self._big_centre, wire),
            Part.LINE: (np.stack([along, 0.0 * along, 0.0 * along], axis=-1), wire),
            Part.BEAD: (np.array([self.bead_mm, self.bead_mm]), self.bead_diameter_mm),
        }
        return tuple(outline for part, outline in outlines.items() if part in self.parts)

    def metal_depths(self, origin: Array, rays: Array) -> Array:
        """Optical depth (n,) of wires and bead along rays from one origin (3,), unit directions (n, 3), guide frame."""
        wire = self.wire_diameter_mm / 2.0
        chord = np.zeros(len(rays))
        if Part.SMALL_RING in self.parts:
            chord += ring_chord(origin, rays, self.small_radius_mm, wire)
        if Part.BIG_RING in self.parts:
            chord += ring_chord(origin - self._big_centre, rays, self.big_radius_mm, wire)
        if Part.LINE in self.parts:
            chord += rod_chord(origin, rays, self.line_start_mm, self.line_end_mm, wire)
        if Part.BEAD in self.parts:
            chord += ball_chord(origin - np.array(self.bead_mm), rays, self.bead_diameter_mm / 2.0)
        return METAL_PER_MM * chord

    def housing_ball(self) -> tuple[Array, float]:
        """Middle (3,) and radius of a ball that holds the housing, guide frame, mm."""
        half_length = self.separation_mm / 2.0 + _HOUSING_BEYOND_MM
        return np.array([0.0, 0.0, -self.separation_mm / 2.0]), float(np.hypot(half_length, _HOUSING_OUTER_MM))

    def housing_depths(self, origin: Array, rays: Array) -> Array:
        """Optical depth (n,) of the housing, a tube around both rings."""
        if Part.HOUSING not in self.parts:
            return np.zeros(len(rays))
        ends = (-self.separation_mm - _HOUSING_BEYOND_MM, _HOUSING_BEYOND_MM)
        return _HOUSING_PER_MM * shell_chord(origin, rays, _HOUSING_OUTER_MM, _HOUSING_INNER_MM, ends)

    @property
    def _big_centre(self) -> Array:
        return np.array([*self.big_centre_mm, -self.separation_mm])
