"""The signing key: its owner's alone, or refused."""

import stat

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
