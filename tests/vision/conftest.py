"""The reference devices, a flat-panel registration and exact views of the guide, for every test of `vision`."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vision.conics import RingPair, ellipse_from_conic
from vision.devices import CArm, Guide, read_carm, read_guide
from vision.distortion import DistortionMap
from vision.paper import solve
from vision.projection import Intrinsics, View, fiducials_in_guide, project, ring_conic
from vision.refusal import Refusal
from vision.registered import ImageIdentity, Method, PredictedError, Registration

_DEVICES = Path(__file__).parents[1] / "devices"
GUIDE_TOML = (_DEVICES / "guide.toml").read_bytes()

FLAT_PANEL_TOML = (_DEVICES / "flat-panel.toml").read_bytes()

INTENSIFIER_TOML = (
    FLAT_PANEL_TOML.replace(b"flat-panel", b"image-intensifier")
    + b"""
[plate]
ball_spacing = 15.0
ball_diameter = 2.0
"""
)


@pytest.fixture(scope="session")
def guide_toml() -> bytes:
    """The reference guide's file."""
    return GUIDE_TOML


@pytest.fixture(scope="session")
def flat_panel_toml() -> bytes:
    """The reference flat panel's file."""
    return FLAT_PANEL_TOML


@pytest.fixture(scope="session")
def intensifier_toml() -> bytes:
    """The reference image intensifier's file."""
    return INTENSIFIER_TOML


@pytest.fixture(scope="session")
def guide() -> Guide:
    """The reference guide."""
    return read_guide(GUIDE_TOML)


@pytest.fixture(scope="session")
def flat_panel() -> CArm:
    """The reference C-arm with a flat panel."""
    return read_carm(FLAT_PANEL_TOML)


@pytest.fixture(scope="session")
def intensifier() -> CArm:
    """The reference C-arm with an image intensifier and a plate."""
    return read_carm(INTENSIFIER_TOML)


@pytest.fixture(scope="session")
def make_view() -> Callable[..., View]:
    """Views by tilt, azimuth of the tilt's axis and roll (deg), translation (mm) and principal point (px)."""

    def make(
        tilt_deg: float,
        azimuth_deg: float = 0.0,
        roll_deg: float = 0.0,
        translation_mm: tuple[float, float, float] = (10.0, -5.0, 750.0),
        centre_px: tuple[float, float] = (511.5, 511.5),
        alpha_px: float = 1000.0 / 360.0 * 1024.0,
    ) -> View:
        azimuth = np.radians(azimuth_deg)
        tilt = Rotation.from_rotvec(np.radians(tilt_deg) * np.array([np.cos(azimuth), np.sin(azimuth), 0.0]))
        pose: NDArray[np.float64] = np.eye(4)
        pose[:3, :3] = (tilt * Rotation.from_euler("z", roll_deg, degrees=True)).as_matrix()
        pose[:3, 3] = translation_mm
        return View(Intrinsics(alpha_px, alpha_px, *centre_px), pose)

    return make


@pytest.fixture(scope="session")
def vector_view(make_view: Callable[..., View]) -> View:
    """The view of the test vector in docs/method.md."""
    return make_view(10.0)


@dataclass(frozen=True)
class ShiftedMap:
    """A distortion that anyone can check by hand: corrected = raw + shift."""

    shift_px: tuple[float, float]
    balls: int = 0
    rms_px: float = 0.0
    pixel_size_mm: float = 360.0 / 1024.0

    def corrected_from_raw(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Corrected pixels (n, 2)."""
        return points + self.shift_px

    def raw_from_corrected(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Raw pixels (n, 2)."""
        return points - self.shift_px


@pytest.fixture(scope="session")
def make_registration(guide: Guide, flat_panel: CArm) -> Callable[..., Registration]:
    """A registration that is exactly right about `view`; corrected pixels are raw ones shifted by `shift_px`."""

    def make(
        view: View, carm: CArm = flat_panel, shift_px: tuple[float, float] = (0.0, 0.0), used_guide: Guide = guide
    ) -> Registration:
        names, points = zip(*fiducials_in_guide(used_guide).items(), strict=True)
        pixels = dict(zip(names, project(view, np.array(points)), strict=True))
        small = ellipse_from_conic(ring_conic(view, used_guide.small_ring_radius_mm, 0.0))
        big = ellipse_from_conic(ring_conic(view, used_guide.big_ring_radius_mm, -used_guide.separation_mm))
        solution = solve(pixels, used_guide)
        assert small is not None
        assert big is not None
        assert not isinstance(solution, Refusal)
        return Registration(
            image=ImageIdentity("ab" * 32, 1024, 1024),
            method=Method.CONTOUR,
            guide=guide,
            carm=carm,
            intrinsics=view.intrinsics,
            source_from_guide=view.source_from_guide,
            distortion=cast(DistortionMap, ShiftedMap(shift_px)),
            fiducials_px=pixels,
            bead_px=project(view, np.array([[0.0, 45.0, -30.0]]))[0],
            rings=RingPair(small, big),
            residual_rms_px=0.05,
            covariance=solution.covariance,
            predicted_error_95=PredictedError(1e-3, 0.1, 80.0),
            elapsed_ms=12.0,
        )

    return make
