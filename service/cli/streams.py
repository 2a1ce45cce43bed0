"""What the geometry commands read and print: files in, JSON lines out, complaints on stderr with an exit status."""

import hashlib
import json
from collections.abc import Callable, Collection, Mapping
from datetime import UTC, date, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, Protocol, TypeVar

import typer

from service.whole_file import whole_file

if TYPE_CHECKING:
    from vision.refusal import Refusal
    from vision.registered import Registration
    from vision.xray import XrayImage

DONE, UNUSABLE, REFUSED = 0, 2, 3
Identity = dict[str, Any]
_MOST_TEXT_BYTES = 16 * 1024 * 1024  # a registration takes some kilobytes, poses a hundred each


class _Device(Protocol):
    @property
    def expires(self) -> date | None: ...


DeviceT = TypeVar("DeviceT", bound=_Device)


def read_device(path: Path, parse: Callable[[bytes], DeviceT]) -> DeviceT:
    """The device in a TOML file; ends the command with one line where it cannot be used, warns where it expired."""
    try:
        device = parse(read_text_file(path))
    except ValueError as error:
        end_unusable(path, error)
    if device.expires is not None and device.expires < datetime.now(UTC).date():
        typer.echo(f"warning: {path}: expired on {device.expires}", err=True)
    return device


def read_image(path: Path, frame: int | None) -> "tuple[Identity, XrayImage | Refusal]":
    """The image's identity for the output, and the decoded image or why it is none; ends the command without a file."""
    try:
        return _decoded(path, frame)
    except OSError as error:
        end_unusable(path, error.strerror or error)


def read_one_of_many(path: Path, frame: int | None) -> "tuple[Identity, XrayImage | Refusal, int]":
    """The same with the status so far; of a file that cannot be read a refusal, so that the other images are done."""
    from vision.refusal import Refusal, RefusalCode

    try:
        identity, image = _decoded(path, frame)
    except OSError as error:
        return {"path": str(path)}, Refusal(RefusalCode.UNREADABLE_IMAGE, error.strerror or str(error)), UNUSABLE
    return identity, image, REFUSED if isinstance(image, Refusal) else DONE


def end_many(statuses: Collection[int]) -> None:
    """End a command on several images: a file that cannot be read tells more than an image that was refused."""
    for status in (UNUSABLE, REFUSED):
        if status in statuses:
            raise typer.Exit(status)


def _decoded(path: Path, frame: int | None) -> "tuple[Identity, XrayImage | Refusal]":
    from vision.refusal import Refusal, RefusalCode
    from vision.xray import GREATEST_BYTES, decode

    identity: Identity = {"path": str(path)}
    data = _beginning(path, GREATEST_BYTES + 1)
    if len(data) > GREATEST_BYTES:
        size = max(len(data), path.stat().st_size)  # a device has none
        return identity, Refusal(RefusalCode.IMAGE_TOO_LARGE, "the file's size in bytes", size, GREATEST_BYTES)
    identity |= {"sha256": hashlib.sha256(data).hexdigest()}
    image = decode(data, frame)
    if not isinstance(image, Refusal):
        identity |= {"rows": image.rows, "columns": image.columns}
    return identity, image


def read_registration(path: Path) -> "Registration":
    """The registration in a JSON file; ends the command with one line where there is none."""
    from vision.registration_json import from_json

    try:
        return from_json(json.loads(read_text_file(path)))
    except json.JSONDecodeError as error:
        end_unusable(path, f"no single line of `register`: {error}")
    except (ValueError, RecursionError) as error:
        end_unusable(path, error)


def print_line(result: Mapping[str, Any]) -> None:
    """One JSON object on a line of stdout."""
    typer.echo(json.dumps(result, allow_nan=False))


def print_refusal(refusal: "Refusal", image: Mapping[str, Any]) -> None:
    """One refusal on a line of stdout, with the image that it concerns."""
    print_line(refusal_line(refusal, image))


def refusal_line(refusal: "Refusal", image: Mapping[str, Any]) -> dict[str, Any]:
    """The JSON object of a refusal, with the image that it concerns."""
    from vision.result_json import refusal_to_json

    return {"status": "refused", "image": dict(image)} | refusal_to_json(refusal)


def write_file(path: Path, data: bytes) -> None:
    """Write a file whole or not at all, its folder made where missing; ends the command where that cannot be done."""
    place = place_of(path)
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(place) as part:
            part.write_bytes(data)
    except OSError as error:
        end_unusable(path, error.strerror or error)


def place_of(path: Path) -> Path:
    """Where a file is written that will take the place of what is there: of what a link leads to, never of a device.

    Ends the command there: as the superuser it would put a file into the place of /dev/stdout for everybody.
    """
    try:
        is_another = path.exists() and not path.is_file() and not path.is_dir()
        place = path.resolve()
    except (OSError, RuntimeError) as error:  # no right to look, links in a circle
        end_unusable(path, error)
    if is_another:
        end_unusable(path, "a device or a pipe, and no file")
    return place


def read_text_file(path: Path) -> bytes:
    """A file of text; ends the command where there is none, or where it is no such one by its size."""
    try:
        data = _beginning(path, _MOST_TEXT_BYTES + 1)
    except OSError as error:
        end_unusable(path, error.strerror or error)
    if len(data) > _MOST_TEXT_BYTES:
        end_unusable(path, f"larger than {_MOST_TEXT_BYTES} bytes")
    return data


def _beginning(path: Path, most: int) -> bytes:
    """So much is never held in memory that there is none left."""
    with path.open("rb") as file:
        return file.read(most)


def end_unusable(path: Path, reason: object) -> NoReturn:
    """End the command with one line about a file."""
    complain(path, reason)
    raise typer.Exit(UNUSABLE)


def complain(path: Path, reason: object) -> None:
    """One line about a file."""
    line = " ".join(str(reason).split())
    typer.echo(f"error: {path}: {line}", err=True)
