"""`coaxial register`, `target`, `evaluate` and `plan-carm`: one JSON object a line on stdout, all else on stderr.

Exit status: 0 done, 3 refused (the JSON says why), 2 wrong usage or unreadable input. Of several images each is done,
whatever is wrong with another; 2 then means that a file could not be read, else 3 that an image was refused. The
modules of `vision` are imported where they are used, so that `--help` needs none of them.
"""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli.plain import plain_typer
from service.cli.registering import Job, answers
from service.cli.streams import REFUSED, end_many, print_line, print_refusal, read_device, read_image, read_registration


class MethodOption(StrEnum):
    """Choices of --method; the values are those of vision.registered.Method."""

    CONTOUR = "contour"
    PAPER = "paper"


class SpaceOption(StrEnum):
    """Choices of --space; the values are those of vision.registered.PixelSpace."""

    RAW = "raw"
    CORRECTED = "corrected"


class PositionOption(StrEnum):
    """Choices of --position; the values are those of vision.carm_angles.Position."""

    PRONE = "prone"
    SUPINE = "supine"


def _numbers(text: str, count: int) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) != count:
        raise typer.BadParameter(f"{text!r} is not {count} numbers separated by commas")
    return values


def pair(text: str) -> tuple[float, ...]:
    """Two numbers of an option, separated by a comma."""
    return _numbers(text, 2)


def _triple(text: str) -> tuple[float, ...]:
    return _numbers(text, 3)


# Whether a file can be read is seen when it is: typer would end the command for one of many, in four lines.
ImagesArgument = Annotated[
    list[Path], typer.Argument(metavar="IMAGE...", readable=False, help="PNG, TIFF or DICOM images.")
]
GuideOption = Annotated[Path, typer.Option("--guide", readable=False, help="The guide's TOML file.")]
CArmOption = Annotated[Path, typer.Option("--carm", readable=False, help="The C-arm's TOML file.")]
FrameOption = Annotated[int | None, typer.Option("--frame", min=1, help="Which frame of a DICOM image, from 1.")]
PixelOption = Annotated[Any, typer.Option("--pixel", parser=pair, metavar="U,V", help="The target's pixel.")]
SpaceChoice = Annotated[SpaceOption, typer.Option("--space", help="The grid in which the pixel was picked.")]
DepthOption = Annotated[float, typer.Option("--depth-mm", help="Depth of the target below the big ring, mm.")]


register, target, evaluate, plan_carm = plain_typer(), plain_typer(), plain_typer(), plain_typer()


@register.command()
def register_command(
    images: ImagesArgument,
    guide: GuideOption,
    carm: CArmOption,
    method: Annotated[MethodOption, typer.Option(help="All contour points, or the paper's 12.")] = MethodOption.CONTOUR,
    frame: FrameOption = None,
) -> None:
    """Find the guide in each image: intrinsics and pose, one JSON line per image."""
    from vision.devices import read_carm, read_guide

    guide_file, carm_file = read_device(guide, read_guide), read_device(carm, read_carm)
    statuses = set()
    for answer in answers([Job(path, frame, guide_file, carm_file, method.value) for path in images]):
        statuses.add(answer.status)
        print_line(answer.line)
    end_many(statuses)


@target.command()
def target_command(
    registration: Annotated[
        Path, typer.Argument(metavar="REGISTRATION.json", readable=False, help="One line of `register`.")
    ],
    pixel: PixelOption,
    space: SpaceChoice,
    depth_mm: DepthOption = 80.0,
) -> None:
    """Where the guide must go so that its axis holds the X-ray source and the target."""
    from vision.refusal import Refusal
    from vision.registered import PixelSpace
    from vision.result_json import targeting_to_json
    from vision.targeting import target as aim

    registered = read_registration(registration)
    result = aim(registered, pixel, PixelSpace(space), depth_mm)
    if isinstance(result, Refusal):
        identity = registered.image
        print_refusal(result, {"sha256": identity.sha256, "rows": identity.rows, "columns": identity.columns})
        raise typer.Exit(REFUSED)
    print_line(targeting_to_json(result))


@evaluate.command()
def evaluate_command(
    image: Annotated[
        Path, typer.Argument(metavar="IMAGE", readable=False, help="PNG, TIFF or DICOM image after the move.")
    ],
    guide: GuideOption,
    carm: CArmOption,
    pixel: PixelOption,
    space: SpaceChoice,
    depth_mm: DepthOption = 80.0,
    frame: FrameOption = None,
) -> None:
    """How far the guide's axis is from the target in an image: contour and paper figures, and whether they agree."""
    from vision.devices import read_carm, read_guide
    from vision.evaluation import evaluate as evaluate_image
    from vision.refusal import Refusal
    from vision.registered import PixelSpace
    from vision.result_json import evaluation_to_json

    guide_file, carm_file = read_device(guide, read_guide), read_device(carm, read_carm)
    identity, decoded = read_image(image, frame)
    result = (
        decoded
        if isinstance(decoded, Refusal)
        else evaluate_image(decoded, guide_file, carm_file, pixel, PixelSpace(space), depth_mm)
    )
    if isinstance(result, Refusal):
        print_refusal(result, identity)
        raise typer.Exit(REFUSED)
    print_line(evaluation_to_json(result) | {"image": identity})


@plan_carm.command()
def plan_carm_command(
    entry: Annotated[Any, typer.Option(parser=_triple, metavar="X,Y,Z", help="Entry point, patient LPS, mm.")],
    target: Annotated[Any, typer.Option(parser=_triple, metavar="X,Y,Z", help="Target point, patient LPS, mm.")],
    position: Annotated[PositionOption, typer.Option(help="How the patient lies.")] = PositionOption.PRONE,
) -> None:
    """The C-arm's angles in which a planned path projects to a point."""
    import numpy as np

    from vision.carm_angles import Position, carm_angles
    from vision.refusal import Refusal
    from vision.result_json import carm_angles_to_json

    result = carm_angles(np.array(entry), np.array(target), Position(position))
    if isinstance(result, Refusal):
        print_refusal(result, {})
        raise typer.Exit(REFUSED)
    print_line(carm_angles_to_json(result))
