"""The fonts of the report, which come with the product's dependencies; no font of the machine changes a page.

A character that none of them has is printed as its code point, `[U+0E01]`, and the report says so: PDF/A allows no
empty box, and a reader must not take one for a name.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from unicodedata import category

FAMILIES = ("Noto Sans", "Noto Sans Arabic", "Noto Sans Thai", "Noto Sans CJK SC", "DejaVu Sans")
# Package and the folder within it. DejaVu, which matplotlib brings, has Hebrew, Armenian, Georgian and many signs.
_PACKAGES = (
    ("fontpkg_noto_sans", "files"),
    ("fontpkg_noto_sans_arabic", "files"),
    ("fontpkg_noto_sans_thai", "files"),
    ("noto_cjk_sans_otc", ""),
    ("matplotlib", "mpl-data/fonts/ttf"),
)
_SUFFIXES = (".ttf", ".otf", ".ttc")
_UPRIGHT = ("Regular", "Book", "Bold")  # faces that text is set in
# What turns text around (U+202E) or is not seen could make a name another one; these two only join letters.
_UNSEEN, _JOINERS = ("Cc", "Cf", "Cs", "Co", "Cn"), ("\N{ZERO WIDTH JOINER}", "\N{ZERO WIDTH NON-JOINER}")


def font_folders() -> list[Path]:
    """Where the fonts lie."""
    return [_installed(package) / folder for package, folder in _PACKAGES]


def printable(document: Any) -> tuple[Any, list[str]]:
    """A document of texts, lists and mappings with every character that can be printed, and those that cannot."""
    missing: set[str] = set()

    def told(value: Any) -> Any:
        match value:
            case str():
                return "".join(_character(one, missing) for one in value)
            case Mapping():
                return {key: told(one) for key, one in value.items()}
            case Sequence():
                return [told(one) for one in value]
            case _:
                return value

    return told(document), sorted(missing)


def _character(one: str, missing: set[str]) -> str:
    if one.isascii() and one.isprintable():
        return one
    if one.isspace():
        return one if one == "\N{NO-BREAK SPACE}" else " "
    seen = category(one) not in _UNSEEN or one in _JOINERS
    if seen and ord(one) in _coverage():
        return one
    missing.add(_code_point(one))
    return f"[{_code_point(one)}]"


def _code_point(one: str) -> str:
    return f"U+{ord(one):04X}"


def _installed(package: str) -> Path:
    spec = find_spec(package)
    if spec is None or spec.origin is None:
        raise FileNotFoundError(f"the fonts of {package} are not installed")
    return Path(spec.origin).parent


@lru_cache(maxsize=1)
def _coverage() -> frozenset[int]:
    """The code points that all upright faces of some family have."""
    by_family: dict[str, set[int]] = {}
    for family, points in _faces():
        by_family[family] = by_family[family] & points if family in by_family else points
    return frozenset().union(*by_family.values())


def _faces() -> Iterator[tuple[str, set[int]]]:
    # Imported here: only this worker's first report needs it.
    from fontTools.ttLib import TTCollection, TTFont

    for file in (one for folder in font_folders() for one in sorted(folder.iterdir()) if one.suffix in _SUFFIXES):
        with TTCollection(file, lazy=True) if file.suffix == ".ttc" else TTFont(file, lazy=True) as opened:
            for font in opened.fonts if isinstance(opened, TTCollection) else [opened]:
                family, face = font["name"].getBestFamilyName(), font["name"].getBestSubFamilyName()
                if family in FAMILIES and face in _UPRIGHT:
                    yield family, set(font.getBestCmap())
