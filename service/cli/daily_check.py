"""`coaxial daily-check`: the arm, its devices and one image of the guide, before the first patient of the day.

Exit status: 0 passed, 3 failed (each line says what to do), 2 wrong usage or a service that does not answer.
"""

import time
from json import JSONDecodeError
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from service.cli.check_lines import tell
from service.cli.plain import plain_typer
from service.cli.secret import secret

if TYPE_CHECKING:
    from coaxial_client import Coaxial

daily_check = plain_typer()

_FAILED, _UNUSABLE = 3, 2
_LOOK_EVERY_S = 0.2


@daily_check.command()
def daily_check_command(
    url: Annotated[str, typer.Argument(help="Address of the service, as it prints it.")],
    user: Annotated[
        str,
        typer.Option(
            help="An engineer's name; the password from COAXIAL_PASSWORD, else a line of stdin, else asked for."
        ),
    ],
    wait_s: Annotated[float, typer.Option(min=1.0, help="How long to wait for the image.")] = 300.0,
) -> None:
    """Check the room: bring the guide into the beam first, and let the arm rest."""
    import httpx

    from coaxial_client import Coaxial, NoAnswer, Refused

    try:
        with Coaxial(url, timeout_s=90.0) as room:
            _find(room, url)
            room.sign_in(user, secret("COAXIAL_PASSWORD", "Password"))
            passed = _check(room, wait_s)
    except Refused as error:
        _end(f"{error.code}: {error.detail}. {error.what_to_do}")
    except NoAnswer as error:
        _end(f"the service at {url} does not answer: {error}")
    except (httpx.InvalidURL, UnicodeError) as error:
        _end(f"{url} is no address: {error}")
    if not passed:
        raise typer.Exit(_FAILED)


def _find(room: "Coaxial", url: str) -> None:
    """Nobody types a password for an address where no service is."""
    from coaxial_client import Refused

    try:
        room.get("/health/live")
    except (Refused, JSONDecodeError, UnicodeDecodeError):  # neither asks who is there nor can be refused
        _end(f"what answers at {url} is no Coaxial service")


def _check(room: "Coaxial", wait_s: float) -> bool:
    begun = room.begin_daily_check()
    tell(begun["items"])
    if begun["passed"] is not None:
        return bool(begun["passed"])
    typer.echo("now expose the guide once, and leave the arm where it is")
    image_id = _await_image(room, begun["images_before"], wait_s)
    if image_id is None:
        _end(f"no image came within {wait_s:g} s. Check that the C-arm sends to the service, then check anew.")
    finished = room.finish_daily_check(begun["check_id"], image_id)
    tell(finished["items"][len(begun["items"]) :])
    typer.echo("the daily check has passed" if finished["passed"] else "the daily check has FAILED")
    return bool(finished["passed"])


def _await_image(room: "Coaxial", images_before: int, wait_s: float) -> str | None:
    """The first image after so many."""
    end_s = time.monotonic() + wait_s
    while time.monotonic() < end_s:
        newer = [image for image in room.get_list("/images") if image["position"] > images_before]
        if newer:
            return str(min(newer, key=lambda image: image["position"])["id"])
        time.sleep(_LOOK_EVERY_S)
    return None


def _end(line: str) -> NoReturn:
    typer.echo(line, err=True)
    raise typer.Exit(_UNUSABLE)
