"""What a run measured, target by target."""

from dataclasses import dataclass

from simulator.demo.door_client import TrueError


@dataclass(frozen=True, slots=True)
class Moved:
    """One motion onto a target."""

    kind: str
    translation_mm: float
    rotation_deg: float


@dataclass(frozen=True, slots=True)
class Verified:
    """One verification: the service's two figures, and beside them what the room knows."""

    passed: bool
    contour_deg: float
    contour_mm: float
    bound_deg: float
    bound_mm: float
    paper_deg: float
    paper_mm: float
    true: TrueError


@dataclass(frozen=True, slots=True)
class TargetResult:
    """One target from C-arm positioned to sleeve inserted; motions and verifications oldest first."""

    name: str
    moved: tuple[Moved, ...]
    verified: tuple[Verified, ...]
    exposures: int
    elapsed_s: float

    @property
    def final(self) -> Verified:
        """The verification that the insertion relied on."""
        return self.verified[-1]

    @property
    def corrections(self) -> int:
        """Motions after the first."""
        return len(self.moved) - 1
