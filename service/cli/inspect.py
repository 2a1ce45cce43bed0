"""`coaxial inspect`: what was found in images, as pictures and one page to look at, of refused ones too.

Exit status: 0 drawn, refused images too; 2 wrong usage, or a file that could not be read: the others are done still.
"""

import math
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.cli.geometry import CArmOption, DepthOption, FrameOption, GuideOption, ImagesArgument, SpaceOption, pair
from service.cli.inspection_page import Entry, page
from service.cli.plain import plain_typer
from service.cli.streams import (
    UNUSABLE,
    complain,
    end_many,
    print_line,
    print_refusal,
    read_device,
    read_one_of_many,
    write_file,
)

if TYPE_CHECKING:
    from vision.inspection import Inspection
    from vision.refusal import Refusal

inspect = plain_typer()

_LONGEST_STEM = 200  # bytes of the 255 that a name may have

_TargetOption = Annotated[Any, typer.Option("--pixel", parser=pair, metavar="U,V", help="A target to aim at.")]


@inspect.command()
def inspect_command(
    images: ImagesArgument,
    guide: GuideOption,
    carm: CArmOption,
    out: Annotated[Path, typer.Option("--out", metavar="FOLDER", help="Where pictures and index.html go.")],
    target: _TargetOption = None,
    space: Annotated[SpaceOption, typer.Option("--space", help="The grid of --pixel.")] = SpaceOption.RAW,
    depth_mm: DepthOption = 80.0,
    frame: FrameOption = None,
) -> None:
    """Draw what was found in each image, refused or not; one JSON line per image, and a page of all."""
    from vision.devices import read_carm, read_guide
    from vision.drawing import draw, png
    from vision.inspection import inspect as inspect_findings
    from vision.refusal import Refusal
    from vision.registered import PixelSpace
    from vision.registration import examine

    guide_file, carm_file = read_device(guide, read_guide), read_device(carm, read_carm)
    entries: list[Entry] = []
    statuses = set()
    try:
        for number, path in enumerate(images, 1):
            identity, image, status = read_one_of_many(path, frame)
            if isinstance(image, Refusal):
                if status == UNUSABLE:
                    statuses.add(status)
                    complain(path, image.message)
                entries.append(_refused(path, image))
                print_refusal(image, identity)
                continue
            findings = examine(image, guide_file, carm_file)
            inspection = inspect_findings(image, guide_file, carm_file, findings, target, PixelSpace(space), depth_mm)
            picture = _picture_name(number, path)
            write_file(out / picture, png(draw(inspection)))
            entries.append(replace(_entry(path, inspection), picture=picture))
            print_line(_to_json(inspection) | {"image": identity, "picture": picture})
    finally:  # what was drawn until the command is interrupted is on the page
        if entries:
            write_file(out / "index.html", page(entries).encode(errors="backslashreplace"))
    end_many(statuses)


def _picture_name(number: int, path: Path) -> str:
    """After the image's own name, which may be as long as a file's name can be."""
    return f"{number:03d}-{os.fsdecode(os.fsencode(path.stem)[:_LONGEST_STEM])}.png"


def _to_json(inspection: "Inspection") -> dict[str, Any]:
    from vision.inspection import Aim
    from vision.refusal import Refusal
    from vision.result_json import predicted_error_to_json, refusal_to_json

    result = inspection.result
    if isinstance(result, Refusal):
        return refusal_to_json(result)
    aim = inspection.aim
    bounds = aim.bounds_95 if isinstance(aim, Aim) else result.predicted_error_95
    return {
        "status": "registered",
        "residual_rms_px": result.residual_rms_px,
        "balls": result.distortion.balls,
        "predicted_error_95": predicted_error_to_json(bounds),
    } | ({"target": refusal_to_json(aim)} if isinstance(aim, Refusal) else {})


def _entry(path: Path, inspection: "Inspection") -> Entry:
    from vision.drawing import summary
    from vision.inspection import Aim
    from vision.refusal import Refusal

    result, aim = inspection.result, inspection.aim
    balls = None if inspection.balls is None else int(inspection.balls.kept.sum())
    if isinstance(result, Refusal):
        return replace(_refused(path, result), balls=balls)
    bounds = aim.bounds_95 if isinstance(aim, Aim) else result.predicted_error_95
    aside = f". No target drawn: {aim.message}" if isinstance(aim, Refusal) else ""
    return Entry(
        name=str(path),
        code="registered",
        message=summary(inspection) + aside,
        residual_px=result.residual_rms_px,
        balls=balls,
        angle_deg=math.degrees(bounds.angle_rad),
        position_mm=bounds.position_mm,
    )


def _refused(path: Path, refusal: "Refusal") -> Entry:
    return Entry(str(path), refusal.code.value, refusal.message, refusal.measured, refusal.limit)
