"""The key that signs checkpoints (Ed25519): made once, kept in a file that only its owner may read."""

import hashlib
import os
import stat
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    PublicFormat,
    load_pem_private_key,
    load_pem_public_key,
)

from service.errors import ErrorCode, ServiceError
from service.whole_file import whole_file

_OTHERS = stat.S_IRWXG | stat.S_IRWXO


@dataclass(frozen=True, slots=True)
class Verifier:
    """A public key, and the name that signed statements give it."""

    key: Ed25519PublicKey

    @property
    def name(self) -> str:
        """SHA-256 of the raw public key."""
        return hashlib.sha256(self.key.public_bytes(Encoding.Raw, PublicFormat.Raw)).hexdigest()

    @property
    def pem(self) -> str:
        """The key as text, to be kept outside the machine."""
        return self.key.public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo).decode()

    def confirms(self, text: str, signature: str) -> bool:
        """Whether this key has signed the text, and the signature is written as it was: in small letters alone."""
        try:
            raw = bytes.fromhex(signature)
            self.key.verify(raw, text.encode())
        except (InvalidSignature, ValueError):
            return False
        return raw.hex() == signature


@dataclass(frozen=True, slots=True)
class Signer:
    """The private key."""

    key: Ed25519PrivateKey
    verifier: Verifier

    def sign(self, text: str) -> str:
        """The signature, hexadecimal."""
        return self.key.sign(text.encode()).hex()

    def secret(self, purpose: str) -> bytes:
        """A secret for one purpose, the same each time, that nobody has without the key."""
        return self.key.sign(purpose.encode())


def signing_key(file: Path) -> Signer:
    """The key in `file`, with its public half beside it; each is made where there is none.

    ServiceError KEY_REFUSED, as where others may read it.
    """
    try:
        if not file.exists():
            _make_key(file)
        signer = _private_key(file)
        if not public_file(file).exists():
            _make_public(public_file(file), signer.verifier)
        return signer
    except OSError as error:
        raise _unreadable(file, error) from error


def kept_key(file: Path) -> Signer | None:
    """The same, none made."""
    try:
        return _private_key(file) if file.exists() else None
    except OSError as error:
        raise _unreadable(file, error) from error


def _private_key(file: Path) -> Signer:
    owner, mode = file.stat().st_uid, stat.S_IMODE(file.stat().st_mode)
    if owner != os.geteuid() or mode & _OTHERS:
        raise ServiceError(
            ErrorCode.KEY_REFUSED, f"{file} may be read by others than its owner", measured=f"{mode:04o}", limit="0600"
        )
    try:
        key = load_pem_private_key(file.read_bytes(), password=None)
    except ValueError as error:
        raise ServiceError(ErrorCode.KEY_REFUSED, f"{file} holds no private key") from error
    if not isinstance(key, Ed25519PrivateKey):
        raise ServiceError(ErrorCode.KEY_REFUSED, f"{file} holds no Ed25519 key")
    return Signer(key, Verifier(key.public_key()))


def public_key(file: Path) -> Verifier:
    """The public key in `file` (PEM); ServiceError KEY_REFUSED."""
    try:
        return public_key_in(file.read_bytes())
    except OSError as error:
        raise _unreadable(file, error) from error
    except ValueError as error:
        raise ServiceError(ErrorCode.KEY_REFUSED, f"{file} holds no public Ed25519 key") from error


def public_key_in(pem: bytes) -> Verifier:
    """The public key in PEM; ValueError where there is none of Ed25519."""
    key = load_pem_public_key(pem)
    if not isinstance(key, Ed25519PublicKey):
        raise ValueError("no Ed25519 key")
    return Verifier(key)


def public_file(file: Path) -> Path:
    """Where the public half of a key file lies."""
    return file.with_suffix(".pub")


def _unreadable(file: Path, error: OSError) -> ServiceError:
    return ServiceError(ErrorCode.KEY_REFUSED, f"{file} cannot be read or made ({error.strerror})")


def _make_key(file: Path) -> None:
    file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    pem = Ed25519PrivateKey.generate().private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    with suppress(FileExistsError), whole_file(file, is_new=True) as part:  # another process may be quicker
        _write_for_its_owner(part, pem)


def _write_for_its_owner(file: Path, content: bytes) -> None:
    """Created with its rights, never narrowed afterwards: in between others could open it."""
    with os.fdopen(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "wb") as opened:
        opened.write(content)


def _make_public(file: Path, verifier: Verifier) -> None:
    with whole_file(file) as part:
        part.write_text(verifier.pem)
