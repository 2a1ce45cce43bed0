"""The documentation as a site: built strictly, whole, and fetching nothing from elsewhere."""

import logging
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import pytest
from mkdocs.commands.build import build
from mkdocs.config import load_config

_ROOT = Path(__file__).parents[2]
_CONFIG = _ROOT / "docs" / "site" / "mkdocs.yml"
# What a browser fetches by itself; a link that a person may follow is none of it.
_FETCHED = {"script": "src", "img": "src", "link": "href", "iframe": "src", "source": "src"}
_STYLE_URL = re.compile(r"url\(\s*['\"]?(https?:[^)'\"]+)")


class _Fetches(HTMLParser):
    """Every address that a page makes a browser fetch."""

    def __init__(self) -> None:
        super().__init__()
        self.addresses: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        wanted, given = _FETCHED.get(tag), dict(attrs)
        if wanted and given.get(wanted) and given.get("rel") != "canonical":
            self.addresses.append(given[wanted] or "")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    told = _Told()
    logging.getLogger("mkdocs").addHandler(told)
    try:
        build(load_config(str(_CONFIG), strict=True, site_dir=str(folder)))
    finally:
        logging.getLogger("mkdocs").removeHandler(told)
    assert told.warnings == []
    return folder


class _Told(logging.Handler):
    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.warnings: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.warnings.append(record.getMessage())


def _pages(site: Path) -> Iterator[tuple[str, _Fetches]]:
    for file in sorted(site.rglob("*.html")):
        fetches = _Fetches()
        fetches.feed(file.read_text())
        yield str(file.relative_to(site)), fetches


def test_every_page_is_built_and_nothing_is_fetched_from_elsewhere(site):
    pages = dict(_pages(site))
    documents = {str(file.relative_to(_ROOT / "docs").with_suffix(".html")) for file in (_ROOT / "docs").rglob("*.md")}
    assert documents <= pages.keys()
    foreign = {name: [one for one in page.addresses if one.startswith(("http", "//"))] for name, page in pages.items()}
    assert {name: some for name, some in foreign.items() if some} == {}
    assert [url for sheet in site.rglob("*.css") for url in _STYLE_URL.findall(sheet.read_text())] == []


def test_every_picture_that_a_page_shows_is_there(site):
    for name, page in _pages(site):
        if name == "404.html":  # for a server, and so with addresses from its root
            continue
        for address in page.addresses:
            assert (site / name).parent.joinpath(address.split("?")[0]).exists(), f"{name}: {address}"
