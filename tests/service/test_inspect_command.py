import json
import os
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote_to_bytes

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from service.cli.inspection_page import Entry, page
from service.cli.main import app
from simulator.carm.drawing import random_scene
from simulator.carm.render import render

_DEVICES = Path(__file__).parents[1] / "devices"


class Reading(HTMLParser):
    """What a browser would be sent to fetch, and the words that it would show."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.fetched += [value for name, value in attrs if name in ("src", "href") and value is not None]

    def handle_data(self, data: str) -> None:
        self.words.append(data.strip())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An image with a guide, the same mirrored, and a file that is no image."""
    path = tmp_path_factory.mktemp("inspected")
    image = render(random_scene(30, "flat"), 30).pixels
    cv2.imwrite(str(path / "image.png"), image)
    cv2.imwrite(str(path / "flipped.png"), np.fliplr(image))
    (path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\nno more")
    return path


def run(folder: Path, out: Path, *more: str) -> Result:
    """`coaxial inspect` on all images of the folder."""
    images = [str(folder / name) for name in ("image.png", "flipped.png", "broken.png")]
    devices = ["--guide", str(_DEVICES / "guide.toml"), "--carm", str(_DEVICES / "flat-panel.toml")]
    return CliRunner().invoke(app, ["inspect", *images, *devices, "--out", str(out), *more])


def test_every_image_is_on_the_page_the_refused_too(folder: Path, tmp_path: Path) -> None:
    result = run(folder, tmp_path / "new" / "out", "--pixel", "500,480")
    assert result.exit_code == 0, result.output
    good, flipped, broken = map(json.loads, result.stdout.splitlines())
    assert good["status"] == "registered"
    assert "target" not in good
    assert flipped["reason"]["code"] == "mirrored"
    assert broken["reason"]["code"] == "unreadable_image"
    assert "picture" not in broken
    reading = Reading((tmp_path / "new" / "out" / "index.html").read_text())
    assert {"registered", "mirrored", "unreadable_image"} <= set(reading.words)
    pictures = {name for name in reading.fetched if name.endswith(".png")}
    assert pictures == {good["picture"], flipped["picture"]}
    for name in pictures:
        assert cv2.imread(str(tmp_path / "new" / "out" / name)).shape[1] == 2000


def test_a_target_that_cannot_be_aimed_at_is_told_beside_the_bounds_of_the_usual_one(
    folder: Path, tmp_path: Path
) -> None:
    result = run(folder, tmp_path, "--pixel", "nan,480")
    assert result.exit_code == 0, result.output
    good, *_ = map(json.loads, result.stdout.splitlines())
    assert good["status"] == "registered"
    assert (good["target"]["status"], good["target"]["reason"]["code"]) == ("refused", "target_not_finite")


def test_a_page_fetches_nothing_from_elsewhere_and_shows_names_as_they_are() -> None:
    name = '<script src="http://elsewhere/">"&.png'
    reading = Reading(page([Entry(name, "mirrored", "<b>", 3.0, 20.0, picture="001-a b.png")]))
    assert name in reading.words
    assert set(reading.fetched) == {"#image-1", "001-a%20b.png"}


def test_a_folder_that_cannot_be_made_ends_with_one_line(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    result = run(folder, tmp_path / "file" / "out")
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1


def test_a_missing_file_is_a_row_of_the_page_and_status_2_and_the_others_are_drawn(
    folder: Path, tmp_path: Path
) -> None:
    names = [str(folder / name) for name in ("none.png", "image.png")]
    devices = ["--guide", str(_DEVICES / "guide.toml"), "--carm", str(_DEVICES / "flat-panel.toml")]
    result = CliRunner().invoke(app, ["inspect", *names, *devices, "--out", str(tmp_path)])
    assert result.exit_code == 2
    assert result.stderr == f"error: {names[0]}: No such file or directory\n"
    missing, drawn = map(json.loads, result.stdout.splitlines())
    assert (missing["image"], missing["reason"]["code"]) == ({"path": names[0]}, "unreadable_image")
    assert drawn["status"] == "registered"
    words = Reading((tmp_path / "index.html").read_text()).words
    assert {"registered", "unreadable_image", "No such file or directory"} <= set(words)


def test_any_name_that_a_file_may_have_is_drawn_and_its_picture_linked(folder: Path, tmp_path: Path) -> None:
    image = (folder / "image.png").read_bytes()
    names = ["a#b?c%20d.png", "n" * 251 + ".png", os.fsdecode(b"\xe9.png")]
    for name in names:
        (tmp_path / name).write_bytes(image)
    devices = ["--guide", str(_DEVICES / "guide.toml"), "--carm", str(_DEVICES / "flat-panel.toml")]
    out = tmp_path / "out"
    result = CliRunner().invoke(app, ["inspect", *(str(tmp_path / one) for one in names), *devices, "--out", str(out)])
    assert result.exit_code == 0, result.output
    fetched = Reading((out / "index.html").read_text()).fetched
    linked = {os.fsdecode(unquote_to_bytes(name)) for name in fetched if not name.startswith("#")}
    assert linked == {file.name for file in out.iterdir()} - {"index.html"}
    assert len(linked) == 3
