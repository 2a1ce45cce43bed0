"""The HTML page of `coaxial inspect`: a table of all images and their pictures; it needs nothing from elsewhere."""

import os
from dataclasses import dataclass
from html import escape
from string import Template
from urllib.parse import quote

_PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Coaxial: inspection</title>
<style>
  body { margin: 1.5rem; background: #14161a; color: #d6d8dc; font: 16px/1.5 system-ui, sans-serif; }
  h1 { font-size: 1.4rem; } h2 { font-size: 1.1rem; margin: 2.5rem 0 .5rem; overflow-wrap: anywhere; }
  a { color: #8fc7ff; } p { max-width: 75ch; }
  table { border-collapse: collapse; } th, td { padding: .25rem .8rem; text-align: left; }
  th { color: #9aa0a8; font-weight: normal; } tr + tr { border-top: 1px solid #33373d; }
  td.number { text-align: right; font-variant-numeric: tabular-nums; }
  .refused { color: #ff9c8a; } .registered { color: #9fe0a0; }
  img { width: 100%; max-width: 2000px; display: block; }
</style>
<h1>Inspection of $count images, $refused refused</h1>
<p>Left the whole image without its distortion: balls of the plate with their residuals, those left out in red. Right
the guide: small ring blue, big ring orange, line pink, bead yellow, the 12 fiducials white, target and 95&nbsp;% bounds
green. Of a refused image the fit as far as it came, and in dull blue all that was taken for a ring, with the share of
its circumference that was found. Below, the residuals along each wire; the white curve is their running mean.
Exaggerations stand in each picture's head. Research software, not for clinical use.</p>
<table>
<tr><th>image<th>result<th>measured<th>limit<th>residual, px<th>balls<th>bound, deg<th>bound, mm</tr>
$rows
</table>
$pictures
</html>
""")


@dataclass(frozen=True, slots=True)
class Entry:
    """One image of the page; numbers are None where there is none, `picture` where the image cannot be read."""

    name: str
    code: str
    message: str
    measured: float | None = None
    limit: float | None = None
    residual_px: float | None = None
    balls: int | None = None
    angle_deg: float | None = None
    position_mm: float | None = None
    picture: str | None = None

    @property
    def refused(self) -> bool:
        """Whether there is no registration."""
        return self.angle_deg is None


def page(entries: list[Entry]) -> str:
    """The whole page; the pictures lie beside it."""
    return _PAGE.substitute(
        count=len(entries),
        refused=sum(entry.refused for entry in entries),
        rows="\n".join(_row(number, entry) for number, entry in enumerate(entries, 1)),
        pictures="\n".join(_section(number, entry) for number, entry in enumerate(entries, 1)),
    )


def _row(number: int, entry: Entry) -> str:
    kind = "refused" if entry.refused else "registered"
    numbers = (
        _text(entry.measured),
        _text(entry.limit),
        _text(entry.residual_px, ".3f"),
        _text(entry.balls, "d"),
        _text(entry.angle_deg, ".3f"),
        _text(entry.position_mm, ".3f"),
    )
    cells = "".join(f'<td class="number">{number}' for number in numbers)
    name, code = escape(entry.name), escape(entry.code)
    return f'<tr><td><a href="#image-{number}">{name}</a><td class="{kind}">{code}{cells}</tr>'


def _text(value: float | None, form: str = ".4g") -> str:
    return "" if value is None else format(value, form)


def _section(number: int, entry: Entry) -> str:
    kind = "refused" if entry.refused else "registered"
    picture = "<p>There is no picture: the image cannot be read.</p>"
    if entry.picture is not None:
        source = quote(os.fsencode(entry.picture))
        picture = f'<a href="{source}"><img src="{source}" alt="what was found in the image" loading="lazy"></a>'
    measured = "" if entry.measured is None else f": {_text(entry.measured)}"
    limit = "" if entry.limit is None else f", limit {_text(entry.limit)}"
    return (
        f'<h2 id="image-{number}">{escape(entry.name)}: <span class="{kind}">{escape(entry.code)}</span></h2>\n'
        f"<p>{escape(entry.message)}{measured}{limit}</p>\n{picture}"
    )
