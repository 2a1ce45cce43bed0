"""Takes out of a case who it was about and who was there: patient, study, people's names and whatever they wrote.

Left are times, technique, geometry and pixels, which a maker needs. The same patient has the same pseudonym in every
archive of one workstation, and without its private key nobody can go back.
"""

import hashlib
import hmac
import json
from collections.abc import Iterable
from typing import Any

from service.archive.anonymous_image import anonymous
from service.archive.contents import Contents, Row
from service.ledger.keys import Signer

_REMOVED = "removed"
_UIDS = frozenset({"study_uid", "sop_uid", "series_uid"})
# Written by people: nobody can say what stands in it.
# The message of an interlock that was overridden is the surgeon's reason; what it was about, its code says.
_WORDS = frozenset({"text", "reason", "what", "label", "abandoned", "overrides", "override", "message", "statement"})
_PLACES = frozenset({"station", "address", "calling_ae"})
# Where a planned target is called by the name that a person gave it; as keys, of what became of each.
_TARGET_NAMES = frozenset({"name", "planned_target"})
_BY_TARGET = frozenset({"targets", "abandoned"})


# For the hospital's archive, with the patient drawn and written into them.
_REPORTS = ("outgoing_objects", "deliveries")


class Pseudonyms:
    """Names that stand for others, made with a secret that only the workstation has."""

    def __init__(self, signer: Signer) -> None:
        self._secret = signer.secret("coaxial pseudonyms")

    def person(self, name: str) -> str:
        """For a patient."""
        return f"P-{self._mac('patient', name).hex()[:16]}"

    def uid(self, uid: str) -> str:
        """For a UID: one under the root for random numbers (ITU-T X.667)."""
        return f"2.25.{int.from_bytes(self._mac('uid', uid)[:16])}"

    def _mac(self, kind: str, name: str) -> bytes:
        return hmac.digest(self._secret, f"{kind} {name}".encode(), hashlib.sha256)


def pseudonymise(contents: Contents, signer: Signer) -> Contents:
    """The same case about nobody; images have other bytes, so every hash of theirs is replaced throughout."""
    pseudonyms = Pseudonyms(signer)
    hashes: dict[str, str] = {}
    files: dict[str, bytes] = {}
    images = {row["sha256"] for row in contents.rows["images"]}
    reports = {row["sha256"] for row in contents.rows["outgoing_objects"]}
    for sha256, content in contents.files.items():
        if sha256 in reports:
            continue
        changed = anonymous(content, pseudonyms.person, pseudonyms.uid) if sha256 in images else content
        hashes[sha256] = hashlib.sha256(changed).hexdigest()
        files[hashes[sha256]] = changed
    targets = {row["name"]: f"target {number}" for number, row in enumerate(contents.rows["planned_targets"], 1)}
    clean = _Cleaning(pseudonyms, hashes, targets)
    rows = {name: [clean.row(row) for row in some] for name, some in contents.rows.items() if name not in _REPORTS}
    users = {user_id: {**user, "name": f"{user['role']} {user_id[:8]}"} for user_id, user in contents.users.items()}
    return Contents(rows, files, users)


class _Cleaning:
    def __init__(self, pseudonyms: Pseudonyms, hashes: dict[str, str], targets: dict[str, str]) -> None:
        self._pseudonyms = pseudonyms
        self._hashes = hashes
        self._targets = targets

    def row(self, row: Row) -> Row:
        """A row, what is JSON in it inside as well."""
        return {name: self._column(name, value) for name, value in row.items()}

    def _column(self, name: str, value: Any) -> Any:
        if isinstance(value, str) and value[:1] in ("{", "["):
            try:
                return json.dumps(self._value(name, json.loads(value)), sort_keys=True, separators=(",", ":"))
            except ValueError:
                return self._value(name, value)
        return self._value(name, value)

    def _value(self, name: str, value: Any) -> Any:
        match value:
            case dict() if name in _WORDS and "code" not in value:  # a refusal's reason is the program's
                return dict.fromkeys(self._keys(name, value), _REMOVED)
            case dict():
                values = (self._value(key, one) for key, one in value.items())
                return dict(zip(self._keys(name, value), values, strict=True))
            case list():
                return [self._value(name, one) for one in value]
            case str():
                return self._text(name, value)
            case _:
                return value

    def _keys(self, name: str, value: Iterable[str]) -> list[str]:
        return [self._targets.get(key, key) if name in _BY_TARGET else key for key in value]

    def _text(self, name: str, value: str) -> str:
        if name in _TARGET_NAMES:
            return self._targets.get(value, value)
        if name == "patient_id":
            return self._pseudonyms.person(value)
        if name in _UIDS:
            return self._pseudonyms.uid(value)
        if name in _WORDS | _PLACES:
            return _REMOVED if value else value
        return self._hashes.get(value, value)
