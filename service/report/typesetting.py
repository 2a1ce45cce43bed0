"""Sets a report: data and pictures go to the template as files, never into its markup. Runs in the image worker."""

import json
import tempfile
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, Literal

from service.report.figures import LEGEND, legend_sample
from service.report.fonts import FAMILIES, font_folders, printable

TEMPLATE = Path(__file__).with_name("template.typ")
# PDF/A-2b: what an archive may keep; a character without a glyph is an error, not an empty box.
STANDARD: Literal["a-2b"] = "a-2b"


def typeset(document: Mapping[str, Any], pictures: Mapping[str, str], dated: str) -> bytes:
    """The PDF; `pictures` are SVG by the file name that the document has for them, `dated` is its date (UTC).

    The same arguments give the same bytes.
    """
    import typst  # 80 MB that nothing but a report needs

    told, missing = printable(document)
    legend = {f"legend-{name}.svg": legend_sample(name) for name in LEGEND}
    data = json.dumps(told | {"missing": missing, "families": FAMILIES})
    with tempfile.TemporaryDirectory(prefix="coaxial-report-") as name:
        folder = Path(name)
        for file, content in {**pictures, **legend, "report.json": data, TEMPLATE.name: TEMPLATE.read_text()}.items():
            (folder / file).write_text(content, encoding="utf-8")
        return typst.compile(
            folder / TEMPLATE.name,
            root=folder,
            font_paths=typst.Fonts(False, False, font_folders()),  # neither the machine's nor typst's own
            ignore_system_fonts=True,
            pdf_standards=STANDARD,
            timestamp=datetime.fromisoformat(dated).replace(microsecond=0),
        )
