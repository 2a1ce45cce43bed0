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


class _Device(Protocol):
    @property
    def expires(self) -> date | None: ...


DeviceT = TypeVar("DeviceT", bound=_Device)


def read_device(path: Path, parse: Callable[[bytes], DeviceT]) -> DeviceT:
    """The device in a TOML file; ends the command with one line where it cannot be used, warns where it expired."""
    try:
        device = parse(_read(path))
    except ValueError as error:
        end_unusable(path, error)
    if device.expires is not None and device.expires < datetime.now(UTC).date():
        typer.echo(f"warning: {path}: expired on {device.expires}", err=True)
    return device


def read_image(path: Path, frame: int | None) -> "tuple[Identity, XrayImage | Refusal]":
    """The image's identity for the output, and the decoded image or why it is none; ends the command without a file."""
    return _decoded(path, _read(path), frame)


def read_one_of_many(path: Path, frame: int | None) -> "tuple[Identity, XrayImage | Refusal, int]":
    """The same with the status so far; of a file that cannot be read a refusal, so that the other images are done."""
    from vision.refusal import Refusal, RefusalCode

    try:
        data = path.read_bytes()
    except OSError as error:
        return {"path": str(path)}, Refusal(RefusalCode.UNREADABLE_IMAGE, error.strerror or str(error)), UNUSABLE
    identity, image = _decoded(path, data, frame)
    return identity, image, REFUSED if isinstance(image, Refusal) else DONE


def end_many(statuses: Collection[int]) -> None:
    """End a command on several images: a file that cannot be read tells more than an image that was refused."""
    for status in (UNUSABLE, REFUSED):
        if status in statuses:
            raise typer.Exit(status)


def _decoded(path: Path, data: bytes, frame: int | None) -> "tuple[Identity, XrayImage | Refusal]":
    from vision.refusal import Refusal
    from vision.xray import decode

    identity: Identity = {"path": str(path), "sha256": hashlib.sha256(data).hexdigest()}
    image = decode(data, frame)
    if not isinstance(image, Refusal):
        identity |= {"rows": image.rows, "columns": image.columns}
    return identity, image


def read_registration(path: Path) -> "Registration":
    """The registration in a JSON file; ends the command with one line where there is none."""
    from vision.registration_json import from_json

    try:
        return from_json(json.loads(_read(path)))
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
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as part:
            part.write_bytes(data)
    except OSError as error:
        end_unusable(path, error.strerror or error)


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        end_unusable(path, error.strerror or error)


def end_unusable(path: Path, reason: object) -> NoReturn:
    """End the command with one line about a file."""
    complain(path, reason)
    raise typer.Exit(UNUSABLE)


def complain(path: Path, reason: object) -> None:
    """One line about a file."""
    line = " ".join(str(reason).split())
    typer.echo(f"error: {path}: {line}", err=True)
