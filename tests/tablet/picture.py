"""Pictures of the screens for the documentation, taken by the tests where `make pictures` names a folder."""

import io
import os
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page

_FOLDER = os.environ.get("COAXIAL_TEST_PICTURES")
_COLOURS = 256  # of a picture: a third of its size, and nothing lost that the eye would miss
_SETTLED_MS = 300  # a frame more than what the eye waits for


def take_picture(page: Page, name: str) -> None:
    """Keep a picture of the screen, if anybody wants one; the last of a name stays."""
    if _FOLDER:
        page.wait_for_timeout(_SETTLED_MS)
        picture = Image.open(io.BytesIO(page.screenshot(animations="disabled")))
        picture.convert("RGB").quantize(_COLOURS).save(Path(_FOLDER) / f"{name}.png", optimize=True)
