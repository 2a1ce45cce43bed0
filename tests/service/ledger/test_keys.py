"""The signing key: its owner's alone, or refused."""

import os
import stat
from concurrent.futures import ThreadPoolExecutor

import pytest
from cryptography.hazmat.primitives.asymmetric.rsa import generate_private_key
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat

from service.errors import ErrorCode, ServiceError
from service.ledger.keys import public_file, public_key, signing_key


def test_a_key_is_made_once_for_its_owner_alone(tmp_path):
    file = tmp_path / "audit" / "signing.key"
    first, again = signing_key(file), signing_key(file)
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert stat.S_IMODE(file.parent.stat().st_mode) == 0o700
    assert first.verifier.name == again.verifier.name == public_key(public_file(file)).name
    assert again.verifier.confirms("text", first.sign("text"))
    assert not again.verifier.confirms("another", first.sign("text"))
    assert not again.verifier.confirms("text", "no signature")


def test_a_key_whose_making_was_cut_short_is_made_the_next_time(tmp_path, monkeypatch):
    file = tmp_path / "signing.key"
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", _cut_short)
        with pytest.raises(KeyboardInterrupt):
            signing_key(file)
    assert not file.exists()
    key = signing_key(file)
    public_file(file).unlink()
    assert signing_key(file).verifier.name == key.verifier.name == public_key(public_file(file)).name


def _cut_short(_: int) -> None:
    raise KeyboardInterrupt


def test_of_keys_made_at_once_the_first_is_the_one(tmp_path):
    files = [tmp_path / "signing.key"] * 8
    with ThreadPoolExecutor(len(files)) as pool:
        names = {signer.verifier.name for signer in pool.map(signing_key, files)}
    assert names == {public_key(public_file(files[0])).name}


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o620, 0o660, 0o601])
def test_a_key_that_others_may_touch_is_refused(tmp_path, mode):
    file = tmp_path / "signing.key"
    signing_key(file)
    file.chmod(mode)
    with pytest.raises(ServiceError) as refusal:
        signing_key(file)
    assert (refusal.value.code, refusal.value.measured, refusal.value.limit) == (
        ErrorCode.KEY_REFUSED,
        f"{mode:04o}",
        "0600",
    )


def test_what_is_no_such_key_is_refused(tmp_path):
    file = tmp_path / "signing.key"
    other = generate_private_key(65537, 2048).private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    for content in (b"", b"no key", other):
        file.write_bytes(content)
        file.chmod(0o600)
        for read in (signing_key, public_key):
            with pytest.raises(ServiceError) as refusal:
                read(file)
            assert refusal.value.code == ErrorCode.KEY_REFUSED
