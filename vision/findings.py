"""What a registration found on its way, whatever came of it: what one looks at to see where an error comes from."""

from dataclasses import dataclass

from vision.corrected_image import CorrectedImage
from vision.refusal import Refusal
from vision.registered import Registration
from vision.search import Search


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """The result, and as far as it came: the corrected image and the last search in it."""

    result: Registration | Refusal
    corrected: CorrectedImage | None = None
    search: Search | None = None
