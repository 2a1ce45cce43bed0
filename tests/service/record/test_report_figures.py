"""The pictures of a report: the same part of each image, the goal only where a motion was planned from it."""

import re

import pytest

from service.report.figures import LEGEND, draw_figures, legend_sample

_GOAL, _TARGET = "#8dff8d", "#ffffff"


@pytest.fixture(scope="module")
def images(results) -> list[dict]:
    target = {"raw_px": results.targeting["target_raw_px"], "depth_mm": 80.0}
    before, after = results.images
    return [
        {"content": before, "registration": dict(results.registration), "target": target, "with_goal": True},
        {"content": after, "registration": results.evaluation["registration"], "target": target, "with_goal": False},
    ]


def _window(svg: str) -> str:
    return re.search(r'viewBox="([^"]+)"', svg).group(1)


def test_before_and_after_show_the_same_part_and_the_goal_stands_in_the_first(images):
    before, after = draw_figures(images)
    assert _window(before) == _window(after)
    assert (before.count(_GOAL), after.count(_GOAL)) == (3, 0), "two rings and a line"
    for one in (before, after):
        assert one.count(_TARGET) == 5, "four arms of the cross and the bounds"
        assert one.count("data:image/jpeg") == 1
    width = float(_window(before).split()[2])
    assert 0.2 * 1024 < width < 1024, "the guide and its surroundings, not the whole image"


def test_what_is_drawn_lies_within_the_picture(images):
    (svg,) = draw_figures(images[:1])
    left, top, width, _ = map(float, _window(svg).split())
    points = re.findall(r"[ML](-?\d+\.\d+) (-?\d+\.\d+)", svg)
    assert len(points) > 500
    assert all(left <= float(u) <= left + width and top <= float(v) <= top + width for u, v in points)


def test_an_image_that_nothing_was_found_in_is_shown_whole_and_one_that_is_none_not_at_all(images):
    bare = images[0] | {"registration": None, "target": None}
    shown, none = draw_figures([bare, {**bare, "content": b"no image"}])
    assert _window(shown) == "0.00 0.00 1024.00 1024.00"
    assert "<path" not in shown
    assert none is None


def test_every_style_has_a_sample_and_no_two_look_alike():
    assert len({legend_sample(name) for name in LEGEND}) == len(LEGEND)
