"""The guide to the Python client as a program: its examples one after the other, as a reader would type them."""

import re
import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from coaxial_client import Coaxial, Refused
from tests.certificates import make_certificate
from tests.waiting import until

_PAGE = Path(__file__).parents[2] / "docs" / "python-client.md"
_LOST_LINKS = ("heartbeat_lost", "feedback_lost")
_TRIED_FOR_S = 300.0
_BACK_WITHIN_S = 30.0


def run(given: dict[str, Any], surgeon: Coaxial) -> None:
    """Every example with these names given, in the working folder; anew where a crowded machine lost a link."""
    _leave_files()
    end_s = time.monotonic() + _TRIED_FOR_S
    while True:
        try:
            return _run(dict(given))
        except (Refused, RuntimeError, TimeoutError) as error:
            if not _left_a_lost_link(surgeon, error) or time.monotonic() > end_s:
                raise


def _run(names: dict[str, Any]) -> None:
    try:
        for number, example in enumerate(re.findall(r"```python\n(.*?)```", _PAGE.read_text(), re.DOTALL)):
            exec(compile(example, f"example {number} of {_PAGE.name}", "exec"), names)
    finally:
        for opened in ("surgeon", "room"):  # where the examples did not come to their end
            if opened in names:
                names[opened].close()


def _left_a_lost_link(surgeon: Coaxial, error: Exception) -> bool:
    """Whether that was what the examples ran into; the case is aborted as soon as the arm is read again."""
    case = surgeon.case(surgeon.get_list("/cases")[0]["id"])
    held_for = case.status()["held_for"]
    until(lambda: case.status()["arm"]["connected"], _BACK_WITHIN_S)
    case.command("case-aborted", reason="the guide is gone through anew")
    late = isinstance(error, Refused) and any(" s old, at most" in one["message"] for one in error.verdicts)
    return late or held_for in _LOST_LINKS or str(error).startswith(_LOST_LINKS)


def _leave_files() -> None:
    """What the page takes for granted: a picture, an authority's certificate."""
    noise = np.random.default_rng(0).integers(0, 256, (256, 256), np.uint8)
    Image.fromarray(noise).save("scout.png")
    make_certificate(Path()).file.rename("hospital-ca.pem")
