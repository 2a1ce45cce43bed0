"""A scene on a detector of another size or field."""

from dataclasses import replace

from simulator.carm.distortion import Distortion
from simulator.carm.drawing import PIXEL_MM
from simulator.carm.scene import Exposure, Scene

Edges = tuple[float, float, float, float]

_SIDE_PX = 1024  # of the detectors that scenes are drawn for
_LEAST_BLUR_PX = 0.6  # sd: a pixel is blurred by its own size at least


def resized(scene: Scene, side_px: int, field_mm: float) -> Scene:
    """The scene with as many pixels a side for a field; bends and shutters keep their place in the image.

    What depends on distances in the room keeps its size in mm, the dose is the same per area.
    """
    camera, scale, finer = scene.camera, side_px / _SIDE_PX, PIXEL_MM * side_px / field_mm
    middle, old_middle = (side_px - 1) / 2.0, (_SIDE_PX - 1) / 2.0
    u, v = (middle + (place - old_middle) * scale for place in scene.target_ideal_px)
    return replace(
        scene,
        camera=replace(
            camera,
            pixel_mm=camera.pixel_mm / finer,
            rows=side_px,
            columns=side_px,
            principal_u_px=middle + (camera.principal_u_px - old_middle) * scale,
            principal_v_px=middle + (camera.principal_v_px - old_middle) * scale,
        ),
        distortion=_scaled(scene.distortion, scale, middle),
        target_ideal_px=(u, v),
        exposure=_exposed(scene.exposure, scale, finer),
    )


def _scaled(distortion: Distortion, scale: float, middle_px: float) -> Distortion:
    waves = tuple(
        replace(
            wave,
            amplitude_px=(wave.amplitude_px[0] * scale, wave.amplitude_px[1] * scale),
            cycles_per_px=(wave.cycles_per_px[0] / scale, wave.cycles_per_px[1] / scale),
        )
        for wave in distortion.waves
    )
    shift = (distortion.shift_px[0] * scale, distortion.shift_px[1] * scale)
    return replace(distortion, centre_px=middle_px, shift_px=shift, waves=waves)


def _exposed(exposure: Exposure, scale: float, finer: float) -> Exposure:
    """`finer` is by how much more pixels a millimetre has."""
    return replace(
        exposure,
        blur_px=max(_LEAST_BLUR_PX, exposure.blur_px * finer),
        photons=exposure.photons / finer**2,
        motion_px=exposure.motion_px * finer,
        collimator_px=exposure.collimator_px and _edges(exposure.collimator_px, scale),
        crop_px=exposure.crop_px and _whole(_edges(exposure.crop_px, scale)),
    )


def _edges(edges_px: Edges, scale: float) -> Edges:
    left, right, top, bottom = edges_px
    return left * scale, right * scale, top * scale, bottom * scale


def _whole(edges_px: Edges) -> tuple[int, int, int, int]:
    left, right, top, bottom = edges_px
    return int(left), int(right), int(top), int(bottom)
