"""`coaxial calibrate-tcp`: where the guide is on the flange, from recorded poses of the arm and images of the guide.

Exit status: 0 done, 3 refused (the JSON says why), 2 wrong usage or unreadable input.
"""

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.cli.geometry import CArmOption, GuideOption
from service.cli.plain import plain_typer
from service.cli.streams import (
    REFUSED,
    end_unusable,
    print_line,
    print_refusal,
    read_device,
    read_image,
    read_text_file,
    write_file,
)

if TYPE_CHECKING:
    from robot.frames import Transform
    from robot.hand_eye import HandEye
    from robot.refusal import Refusal
    from robot.tool import Tool
    from vision.devices import CArm, Guide
    from vision.registered import Registration

calibrate_tcp = plain_typer()


def _not_past(expires: datetime) -> datetime:
    """A file that has expired is refused wherever it is used: said before the images are looked at."""
    if expires.date() < datetime.now(UTC).date():
        raise typer.BadParameter(f"{expires.date()} is past")
    return expires


@calibrate_tcp.command()
def calibrate_tcp_command(
    poses: Annotated[
        Path,
        typer.Argument(
            metavar="POSES.jsonl",
            help='One line an image: {"image": "file", "base_from_tcp": 4x4 in mm}; files beside POSES.jsonl.',
        ),
    ],
    guide: GuideOption,
    carm: CArmOption,
    tool: Annotated[Path, typer.Option("--tool", help="The TCP file that the controller used at these poses.")],
    version: Annotated[str, typer.Option("--version", help="Version of the new file.")],
    expires: Annotated[
        datetime, typer.Option("--expires", formats=["%Y-%m-%d"], callback=_not_past, help="Its last day of use.")
    ],
    out: Annotated[Path, typer.Option("--out", help="Where to write the new TCP file.")],
) -> None:
    """Calibrate the TCP: twelve poses or so, the guide turned about two axes, one C-arm that stands still."""
    from robot.refusal import Refusal
    from robot.tool import read_tool
    from robot.tool_text import tool_text
    from vision.devices import read_carm, read_guide

    before = read_device(tool, read_tool)
    recorded = _recorded(poses)
    registrations = _registrations(recorded, read_device(guide, read_guide), read_device(carm, read_carm))
    found = _calibrated([pose for _, pose in recorded], registrations, before)
    if isinstance(found, Refusal):
        print_line(
            {"status": "refused", "code": found.code, "message": found.message}
            | {"measured": found.measured, "limit": found.limit}
        )
        raise typer.Exit(REFUSED)
    text = tool_text(before, found, version, expires.date())
    read_tool(text.encode())
    write_file(out, text.encode())
    print_line(_result(found, before, out))


def _recorded(path: Path) -> "list[tuple[Path, Transform]]":
    """Image files and what the controller reported, in the order of the lines."""
    import numpy as np

    from robot.frames import check_rigid

    recorded = []
    for number, text in enumerate(read_text_file(path).splitlines(), 1):
        if not text.strip():
            continue
        try:
            line = json.loads(text)
            recorded.append((path.parent / line["image"], check_rigid(np.array(line["base_from_tcp"]))))
        except KeyError as error:
            end_unusable(path, f"line {number} has no {error}")
        except (ValueError, TypeError, RecursionError) as error:
            end_unusable(path, f"line {number} is no pose with its image: {error}")
    return recorded


def _registrations(recorded: "list[tuple[Path, Transform]]", guide: "Guide", carm: "CArm") -> "list[Registration]":
    """Of every image; ends the command with the first that is refused: a pose without its image is none."""
    from vision.refusal import Refusal
    from vision.registration import register

    registrations = []
    for path, _ in recorded:
        identity, image = read_image(path, None)
        result = image if isinstance(image, Refusal) else register(image, guide, carm)
        if isinstance(result, Refusal):
            print_refusal(result, identity)
            raise typer.Exit(REFUSED)
        registrations.append(result)
    return registrations


def _calibrated(
    base_from_tcps: "list[Transform]", registrations: "list[Registration]", before: "Tool"
) -> "HandEye | Refusal":
    import numpy as np

    from robot.hand_eye import FEWEST, SharedPrior, Sighting, calibrate
    from robot.refusal import Refusal, RefusalCode
    from vision.sightings import sightings

    if len(registrations) < FEWEST:
        return Refusal(RefusalCode.TOO_FEW_POSES, "images of the guide", float(len(registrations)), float(FEWEST))
    seen, prior = sightings(registrations)
    tcp_from_flange = np.linalg.inv(before.flange_from_guide)
    pairs = zip(base_from_tcps, seen, strict=True)
    poses = [Sighting(p @ tcp_from_flange, s.source_from_guide, s.shared, s.weights, s.offset) for p, s in pairs]
    return calibrate(poses, SharedPrior(prior.values, prior.weights), before.flange_from_guide)


def _result(found: "HandEye", before: "Tool", out: Path) -> dict[str, Any]:
    import numpy as np

    from robot.frames import distance_between

    shift_mm, turn_rad = distance_between(before.flange_from_guide, found.flange_from_guide)
    return {
        "status": "calibrated",
        "file": str(out),
        "flange_from_guide": found.flange_from_guide.tolist(),
        "changed_mm": shift_mm,
        "changed_deg": float(np.rad2deg(turn_rad)),
        "translation_sd_mm": found.translation_sd_mm,
        "rotation_sd_deg": float(np.rad2deg(found.rotation_sd_rad)),
        "residuals_mm": found.off_mm.tolist(),
        "residuals_deg": np.rad2deg(found.off_rad).tolist(),
        "cost_ratio": found.cost_ratio,
    }
