"""The client's files in memory: read once at start, so that no request names a path of the disk."""

import base64
import hashlib
import json
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

_FOLDER = Path(__file__).with_name("client")
_INDEX = "index.html"
_MEDIA_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
    ".webmanifest": "application/manifest+json",
}
# Fetched beside the page instead of one after the other as each module names the next.
_PRELOADED = (".js",)
_PRELOAD_MARK = b"<!-- modules -->"
# An icon that came by itself would come after its screen, and not at all while the network is lost.
_ICON_SHEET = "css/icons.css"
_ICON_NAMED = re.compile(rb'url\("/(icons/[a-z-]+\.svg)"\)')
_LOCALES = "locales"
_OWN_NAME = "language.name"  # what a language calls itself, in its own file


@dataclass(frozen=True, slots=True)
class Asset:
    """One file as it is served; `etag` is the hash of its bytes, quoted."""

    content: bytes
    media_type: str
    etag: str


@cache
def assets() -> dict[str, Asset]:
    """The client as it was installed."""
    return assets_in(_FOLDER)


def assets_in(folder: Path) -> dict[str, Asset]:
    """Every file of a client's folder by its address; the page itself at `/`, its languages at `/locales.json`.

    Icons stand in the style sheet that names them.
    """
    files = {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    files[""] = files.pop(_INDEX).replace(_PRELOAD_MARK, _preloads(files))
    files[_ICON_SHEET] = _ICON_NAMED.sub(lambda named: _inline(files[named[1].decode()]), files[_ICON_SHEET])
    files[f"{_LOCALES}.json"] = _languages(files)
    return {f"/{name}": _asset(name or _INDEX, content) for name, content in files.items()}


def _inline(icon: bytes) -> bytes:
    return b'url("data:image/svg+xml;base64,%s")' % base64.b64encode(icon)


def _languages(files: dict[str, bytes]) -> bytes:
    """What there is a file of words for: names by their code."""
    words = {Path(name): content for name, content in files.items() if name.startswith(f"{_LOCALES}/")}
    return json.dumps({path.stem: json.loads(words[path])[_OWN_NAME] for path in sorted(words)}).encode()


def _preloads(files: dict[str, bytes]) -> bytes:
    modules = sorted(name for name in files if name.endswith(_PRELOADED))
    return "\n    ".join(f'<link rel="modulepreload" href="/{name}" />' for name in modules).encode()


def _asset(name: str, content: bytes) -> Asset:
    etag = f'"{hashlib.sha256(content).hexdigest()[:32]}"'
    return Asset(content, _MEDIA_TYPES[Path(name).suffix], etag)
