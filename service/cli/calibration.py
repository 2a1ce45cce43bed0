"""`coaxial calibrate-tcp`: where the guide is on the flange, from recorded poses of the arm and images of the guide.

Exit status: 0 done, 3 refused (the JSON says why), 2 wrong usage or unreadable input.
"""

import json
import math
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

# H09: so far a TCP may stand from the base's origin: a UR5 reaches 850 mm, its tool at most 600 mm farther. What was
# written in metres stands a millimetre away.
_FROM_BASE_MM = (50.0, 1500.0)
# Own choice: a ruler finds a TCP to less. Beyond, the controller had another TCP than --tool, which no residual shows;
# the envelope that is kept from the patient would be off by it (H12).
_CHANGE_LIMIT_MM = 10.0
_CHANGE_LIMIT_RAD = math.radians(5.0)


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
    registrations = _registrations(poses, recorded, read_device(guide, read_guide), read_device(carm, read_carm))
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
            pose = _in_reach(check_rigid(np.array(line["base_from_tcp"])))
            recorded.append((path.parent / line["image"], pose))
        except KeyError as error:
            end_unusable(path, f"line {number} has no {error}")
        except (ValueError, TypeError, RecursionError) as error:
            end_unusable(path, f"line {number} is no pose with its image: {error}")
    return recorded


def _in_reach(base_from_tcp: "Transform") -> "Transform":
    """The pose unchanged; ValueError where no arm could hold it."""
    import numpy as np

    low_mm, high_mm = _FROM_BASE_MM
    from_base_mm = float(np.linalg.norm(base_from_tcp[:3, 3]))
    if not low_mm <= from_base_mm <= high_mm:
        raise ValueError(
            f"base_from_tcp stands {from_base_mm:.4g} mm from the base, not {low_mm:g} to {high_mm:g}: write it in mm"
        )
    return base_from_tcp


def _registrations(
    poses: Path, recorded: "list[tuple[Path, Transform]]", guide: "Guide", carm: "CArm"
) -> "list[Registration]":
    """Of every image; ends the command with the first that is refused: a pose without its image is none.

    The same image again would count as another witness: what is left uncertain would come out too small.
    """
    from vision.refusal import Refusal
    from vision.registration import register

    registrations: list[Registration] = []
    seen: dict[str, Path] = {}
    for path, _ in recorded:
        identity, image = read_image(path, None)
        digest = identity.get("sha256", str(path))  # a file that is too large has none, and is refused below
        if digest in seen:
            again = f"{path.name} is the image {seen[digest].name} again"
            end_unusable(poses, f"{again}: each pose needs an exposure of its own")
        seen[digest] = path
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
    found = calibrate(poses, SharedPrior(prior.values, prior.weights), before.flange_from_guide)
    return found if isinstance(found, Refusal) else _refuse_change(found, before) or found


def _refuse_change(found: "HandEye", before: "Tool") -> "Refusal | None":
    from robot.frames import distance_between
    from robot.refusal import Refusal, RefusalCode

    advice = (
        "the TCP comes out too far from that in --tool: name the file whose TCP the controller had at these poses; if"
        " it is that, measure the TCP with a ruler, set the controller to it and record the poses anew"
    )
    change_mm, change_rad = distance_between(before.flange_from_guide, found.flange_from_guide)
    if not change_mm <= _CHANGE_LIMIT_MM:
        return Refusal(RefusalCode.TCP_MISMATCH, f"{advice} (mm)", change_mm, _CHANGE_LIMIT_MM)
    if not change_rad <= _CHANGE_LIMIT_RAD:
        return Refusal(RefusalCode.TCP_MISMATCH, f"{advice} (rad)", change_rad, _CHANGE_LIMIT_RAD)
    return None


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
