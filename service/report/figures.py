"""Images for the page: the X-ray in grey with what was found in it drawn over it as lines, as SVG.

Runs in the image worker. Line styles differ in dashes and widths as well as in colour, so that they are told apart in
grey too. The pictures of one target show the same part of the image.
"""

import base64
from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from service.vision_overlay import outlines
from vision.refusal import Refusal
from vision.registration_json import from_json
from vision.xray import XrayImage, decode

Array = NDArray[np.float64]
Json = dict[str, Any]
_AROUND = 1.15  # the extent of what is drawn that a picture shows
_STROKE = 0.0035  # of the picture's width: 0.8 pt where it is 80 mm wide
_JPEG_QUALITY = 90
_DARKEST_PERCENT, _LIGHTEST_PERCENT = 0.5, 99.5  # of the pixels shown, stretched from black to white
_GAMMA = 0.7  # shows what lies in the shadows of dense bone
_CROSS = 0.03  # arm of the target's cross, of the picture's width
_GAP = 0.008  # left open in its middle, so that the anatomy shows

# Colour, width in strokes, and dashes in strokes.
_STYLES: dict[str, tuple[str, float, str]] = {
    "small_ring": ("#ffd23c", 1.0, ""),
    "big_ring": ("#4cc3ff", 1.0, "9 3"),
    "line": ("#ff8ad8", 1.6, ""),
    "goal": ("#8dff8d", 1.0, "2 2"),
    "target": ("#ffffff", 1.6, ""),
    "bounds": ("#ffffff", 0.7, ""),
}
LEGEND = tuple(_STYLES)


def draw_figures(images: Sequence[Json]) -> list[str | None]:
    """One SVG per image, of the same part; None for an image that cannot be decoded or drawn.

    Each image has `content`, its `registration` (or None), the `target` that it shows (or None) and `with_goal`:
    whether the guide is drawn where it was to go.
    """
    decoded = [decode(one["content"]) for one in images]
    found = [_lines(one, image) for one, image in zip(images, decoded, strict=True)]
    points = [np.array(line) for lines in found if lines is not None for line in lines.values() if line]
    window = _window(points, decoded)
    return [
        None if isinstance(image, Refusal) or lines is None else _svg(image, lines, window)
        for image, lines in zip(decoded, found, strict=True)
    ]


def legend_sample(name: str) -> str:
    """A short piece of one style on a dark ground, for the legend."""
    middle = [(2.0, 8.0), (38.0, 8.0)] if name != "bounds" else _circle(20.0, 8.0, 6.0)
    drawn = _cross((20.0, 8.0), 7.0, 1.5, 1.2) if name == "target" else _path(name, middle, 1.2)
    return _document((0.0, 0.0, 40.0, 16.0), f'<rect width="40" height="16" fill="#404040"/>{drawn}')


def _lines(one: Json, image: XrayImage | Refusal) -> dict[str, list[tuple[float, float]]] | None:
    """What is drawn by the name of its style, raw pixels; the goal's wires as goal1, goal2, ..."""
    if isinstance(image, Refusal):
        return None
    if one["registration"] is None:
        return {}
    targets = [] if one["target"] is None else [one["target"]]
    drawn = outlines(image, from_json(one["registration"]), targets)
    if isinstance(drawn, Refusal):
        return None
    goal = drawn["goal"].values() if one["with_goal"] else ()
    lines = dict(drawn["wires"]) | {f"goal{number}": points for number, points in enumerate(goal)}
    if targets:
        lines |= {"bounds": drawn["bounds"], "target": [tuple(targets[0]["raw_px"])]}
    return lines


def _window(points: list[Array], decoded: Sequence[XrayImage | Refusal]) -> tuple[float, float, float]:
    """Left, top and width, raw pixels, of a square around all that is drawn; the whole image where nothing is."""
    sizes = [(one.columns, one.rows) for one in decoded if not isinstance(one, Refusal)] or [(1, 1)]
    widest = float(max(max(size) for size in sizes))
    if not points:
        return 0.0, 0.0, widest
    every = np.vstack(points)
    low, high = every.min(axis=0), every.max(axis=0)
    width = min(widest, _AROUND * float((high - low).max()))
    left, top = np.clip((low + high - width) / 2.0, 0.0, [max(0.0, size - width) for size in sizes[0]])
    return float(left), float(top), width


def _svg(image: XrayImage, lines: dict[str, list[tuple[float, float]]], window: tuple[float, float, float]) -> str:
    left, top, width = window
    columns, rows = (slice(int(start), int(np.ceil(start + width))) for start in (left, top))
    cut = _grey(image.pixels[rows, columns])
    _, jpeg = cv2.imencode(".jpg", cut, [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
    # a pixel's centre is at its number, its corner half a pixel before
    picture = (
        f'<image x="{columns.start - 0.5}" y="{rows.start - 0.5}" width="{cut.shape[1]}" height="{cut.shape[0]}" '
        f'href="data:image/jpeg;base64,{base64.b64encode(jpeg.tobytes()).decode()}"/>'
    )
    stroke = _STROKE * width
    drawn = [_path(name.rstrip("0123456789"), points, stroke) for name, points in lines.items() if name != "target"]
    drawn += [_cross(point, _CROSS * width, _GAP * width, stroke) for point in lines.get("target", ())]
    return _document((left, top, width, width), picture + "".join(drawn))


def _grey(pixels: NDArray[np.float32]) -> NDArray[np.uint8]:
    lit = pixels[pixels > 0.0]
    low, high = np.percentile(lit, (_DARKEST_PERCENT, _LIGHTEST_PERCENT)) if lit.size else (0.0, 1.0)
    stretched = np.clip((pixels - low) / max(float(high - low), 1e-6), 0.0, 1.0)
    return np.asarray(stretched**_GAMMA * 255.0, dtype=np.uint8)


def _document(box: tuple[float, float, float, float], inside: str) -> str:
    left, top, width, height = (f"{value:.2f}" for value in box)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{left} {top} {width} {height}" width="{width}" '
        f'height="{height}" fill="none">{inside}</svg>'
    )


def _path(name: str, points: Sequence[tuple[float, float]], stroke: float) -> str:
    """A line over a dark one, so that it is seen on bright and on dark ground."""
    colour, wide, dashes = _STYLES[name]
    along = "M" + "L".join(f"{u:.2f} {v:.2f}" for u, v in points)
    pattern = " ".join(f"{float(dash) * stroke:.2f}" for dash in dashes.split())
    dashed = f' stroke-dasharray="{pattern}"' if pattern else ""
    ground = f'<path d="{along}" stroke="#000000" stroke-opacity="0.55" stroke-width="{(wide + 1.2) * stroke:.2f}"/>'
    return f'{ground}<path d="{along}" stroke="{colour}" stroke-width="{wide * stroke:.2f}"{dashed}/>'


def _cross(point: tuple[float, float], arm: float, gap: float, stroke: float) -> str:
    (u, v), drawn = point, []
    for du, dv in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        drawn.append(_path("target", [(u + du * gap, v + dv * gap), (u + du * arm, v + dv * arm)], stroke))
    return "".join(drawn)


def _circle(u: float, v: float, radius: float) -> list[tuple[float, float]]:
    turn = np.linspace(0.0, 2.0 * np.pi, 25)
    return [(u + radius * float(np.cos(angle)), v + radius * float(np.sin(angle))) for angle in turn]
