"""What decides in a case (H30): the program's version, the site's settings, the bytes of the device files."""

import hashlib
from dataclasses import dataclass

from service.cases.records import StoredCase
from service.conductor.device_set import DeviceSet
from service.version import PRODUCT_VERSION


@dataclass(frozen=True, slots=True)
class Configuration:
    """One hash over it as it is now, and as it was when the case was opened."""

    now: str
    opened: str


def configuration_of(case: StoredCase, settings_sha256: str, devices: DeviceSet) -> Configuration:
    """The configuration of a case; its device files count as they were stored, and as they are read now."""
    return Configuration(
        now=_hash(PRODUCT_VERSION, settings_sha256, devices.bytes_sha256),
        opened=_hash(case.product_version, case.settings_sha256, devices.sha256),
    )


def _hash(*parts: str) -> str:
    return hashlib.sha256(" ".join(parts).encode()).hexdigest()
