"""The file: a zip of members as they are, in one order and with one date, so that it repeats to the byte."""

import hashlib
import json
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from service.archive.contents import line
from service.errors import ErrorCode, ServiceError
from service.ledger.keys import Signer
from service.whole_file import whole_file

MANIFEST, SIGNATURE, KEY = "manifest.json", "manifest.sig", "public-key.pem"
SIGNED_APART = (MANIFEST, SIGNATURE, KEY)
_SAID = frozenset({"case_id", "key", "members", "pseudonymised"})
_DATE = (1980, 1, 1, 0, 0, 0)  # the first that a zip can say: when it was written is no part of the record
_RIGHTS = 0o644 << 16


def manifest_of(members: Mapping[str, bytes], about: Mapping[str, Any], signer: Signer) -> bytes:
    """What is signed: what this is, and the hash of every member."""
    hashes = {name: hashlib.sha256(content).hexdigest() for name, content in members.items()}
    return line({**about, "key": signer.verifier.name, "members": hashes})


def write_archive(out: Path, members: Mapping[str, bytes], manifest: bytes, signer: Signer) -> None:
    """Write the members with their signed manifest; an unfinished file never has the name."""
    signature = signer.sign(manifest.decode()).encode()
    everything = {**members, MANIFEST: manifest, SIGNATURE: signature, KEY: signer.verifier.pem.encode()}
    try:
        with whole_file(out) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_STORED) as file:
            for name in sorted(everything):
                information = zipfile.ZipInfo(name, _DATE)
                information.external_attr = _RIGHTS
                information.create_system = 3  # Unix, whatever writes it
                file.writestr(information, everything[name])
    except OSError as error:
        raise ServiceError(ErrorCode.ARCHIVE_REFUSED, f"{out} cannot be written ({error.strerror})") from error


class Archive:
    """An archive that is open to be read."""

    def __init__(self, file: zipfile.ZipFile) -> None:
        self._file = file
        self.names = file.namelist()

    def read(self, name: str) -> bytes:
        """A member; empty where it is not there. ServiceError ARCHIVE_REFUSED where it is not stored as it is."""
        try:
            if self._file.getinfo(name).compress_type != zipfile.ZIP_STORED:
                raise ServiceError(ErrorCode.ARCHIVE_REFUSED, f"{name} is compressed: not written by an export")
            return self._file.read(name)
        except (KeyError, zipfile.BadZipFile, OSError, EOFError):
            return b""

    def objects(self, name: str) -> list[dict[str, Any]]:
        """The JSON objects of a member, a line each; ServiceError ARCHIVE_REFUSED."""
        try:
            found = [json.loads(text) for text in self.read(name).splitlines()]
        except (ValueError, RecursionError) as error:
            raise ServiceError(ErrorCode.ARCHIVE_REFUSED, f"{name} is not JSON, a line each") from error
        if not all(isinstance(one, dict) for one in found):
            raise ServiceError(ErrorCode.ARCHIVE_REFUSED, f"{name} holds something else than objects")
        return found

    @property
    def manifest(self) -> dict[str, Any]:
        """What the archive says of itself; ServiceError ARCHIVE_REFUSED."""
        objects = self.objects(MANIFEST)
        if len(objects) != 1 or not objects[0].keys() >= _SAID or not isinstance(objects[0]["members"], dict):
            raise ServiceError(ErrorCode.ARCHIVE_REFUSED, f"{MANIFEST} does not say what this is")
        return objects[0]


@contextmanager
def open_archive(path: Path) -> Iterator[Archive]:
    """Open an archive; ServiceError ARCHIVE_REFUSED where it is none."""
    try:
        file = zipfile.ZipFile(path)
    except OSError as error:
        raise ServiceError(ErrorCode.ARCHIVE_REFUSED, f"{path} cannot be read ({error.strerror})") from error
    except (zipfile.BadZipFile, ValueError) as error:
        raise ServiceError(ErrorCode.ARCHIVE_REFUSED, f"{path.name} is no archive of a case") from error
    with file:
        yield Archive(file)
