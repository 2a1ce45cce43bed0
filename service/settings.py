"""Settings of one room's service: defaults, then a TOML file, then COAXIAL_ environment variables.

Later ones win.
"""

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import sqlalchemy as sa
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator
from pydantic_settings import BaseSettings, PydanticBaseSettingsSource, SettingsConfigDict, TomlConfigSettingsSource

from service.errors import ErrorCode, ServiceError


def _data_folder() -> Path:
    base = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(base) / "coaxial"


def _embedded_database(settings: dict[str, Any]) -> str:
    return f"sqlite:///{settings['data_folder'] / 'coaxial.sqlite'}"


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class HttpSettings(_Section):
    """Where the tablet connects. Other `origins` than the service's own must be named (H27)."""

    host: str = "127.0.0.1"
    port: int = Field(default=8700, ge=0, le=65535)
    origins: tuple[str, ...] = ()
    secure_cookie: bool = False  # True behind TLS; a browser drops a secure cookie on plain loopback HTTP
    max_body_bytes: int = Field(default=4_000_000, gt=0)
    shutdown_grace_s: int = Field(default=3, ge=0)


class DicomSettings(_Section):
    """The receiver of X-ray images; it takes none from a calling AE title that is not named among those accepted."""

    host: str = "127.0.0.1"
    port: int = Field(default=11112, ge=0, le=65535)
    ae_title: str = Field(default="COAXIAL", min_length=1, max_length=16)
    accepted_callers: tuple[str, ...] = ()
    max_image_bytes: int = Field(default=64_000_000, gt=0)
    max_pixels: int = Field(default=16_000_000, gt=0)
    min_side_px: int = Field(default=64, gt=0)


class PeerSettings(_Section):
    """A DICOM peer of the hospital's that the service calls; without a host it calls none."""

    host: str | None = None
    port: int = Field(default=104, ge=1, le=65535)
    ae_title: str = Field(default="PACS", min_length=1, max_length=16)


class SlicerSettings(_Section):
    """Where 3D Slicer may watch (OpenIGTLink); it tells nobody who the patient is, but asks nobody who they are."""

    host: str = "127.0.0.1"
    port: int | None = Field(default=None, ge=1, le=65535)  # None: nobody watches; 18944 is customary


class MetricsSettings(_Section):
    """Where Prometheus may read what is counted and timed; it holds no patient, but asks nobody who they are."""

    host: str = "127.0.0.1"
    port: int | None = Field(default=None, ge=1, le=65535)  # None: nothing listens


class SessionSettings(_Section):
    """How long a sign-in lasts, when it locks, and how many wrong answers are borne."""

    lifetime_s: float = Field(default=12 * 3600.0, gt=0)
    idle_lock_s: float = Field(default=15 * 60.0, gt=0)
    pin_sign_in: bool = True  # at a tablet; False asks for the password there too
    wrong_answers: int = Field(default=5, gt=0)
    wrong_answers_window_s: int = Field(default=300, gt=0)
    lock_out_s: float = Field(default=300.0, gt=0)


class VisionSettings(_Section):
    """Bounds of one piece of image work."""

    deadline_s: float = Field(default=20.0, gt=0)
    start_deadline_s: float = Field(default=60.0, gt=0)
    memory_bytes: int = Field(default=3_000_000_000, gt=0)


class AuditSettings(_Section):
    """Where the ledger's key lies, and where its head is kept outside the database (H26)."""

    key_file: Path | None = None  # None: audit/signing.key in the data folder
    anchor_file: Path | None = None  # None: audit/head.json there; better on another machine's disk
    syslog_host: str | None = None  # signed checkpoints go there over TLS (RFC 5425)
    syslog_port: int = Field(default=6514, ge=1, le=65535)
    syslog_ca_file: Path | None = None  # None: the system's certificate authorities


class ArmAccuracy(_Section):
    """Standard deviation of a pose that the arm reports, along and about each axis (H03).

    For motions of some centimetres about one posture; the defaults are those of an arm calibrated at its factory.
    """

    position_sd_mm: float = Field(default=0.1, gt=0, le=5)
    rotation_sd_deg: float = Field(default=0.02, gt=0, le=5)


class ProcedureLimits(_Section):
    """The limits of the procedure; degrees and mm are 95 % bounds (error + its uncertainty)."""

    angle_error_deg: float = Field(default=1.0, gt=0, le=5)
    position_error_mm: float = Field(default=1.5, gt=0, le=5)
    image_age_s: float = Field(default=1800.0, gt=0)
    exposure_window_s: float = Field(default=120.0, gt=0)
    permit_s: float = Field(default=30.0, gt=0, le=30)  # a site may shorten the life of a permit, not lengthen it
    depth_mm: float = Field(default=80.0, gt=0, le=300)


class Settings(BaseSettings):
    """Everything a site can set. Unknown keys are refused: a misspelt limit must not fall back to its default."""

    model_config = SettingsConfigDict(env_prefix="COAXIAL_", env_nested_delimiter="__", extra="forbid", frozen=True)

    room: str = Field(default="room-1", min_length=1, max_length=64)
    data_folder: Path = Field(default_factory=_data_folder)
    database_url: str = Field(default_factory=_embedded_database)
    arm_address: str | None = None  # None: a service without an arm
    min_free_bytes: int = Field(default=500_000_000, ge=0)
    http: HttpSettings = HttpSettings()
    dicom: DicomSettings = DicomSettings()
    pacs: PeerSettings = PeerSettings()  # takes pictures, errors and report of each case that is over
    worklist: PeerSettings = PeerSettings()  # knows who is next
    slicer: SlicerSettings = SlicerSettings()
    metrics: MetricsSettings = MetricsSettings()
    session: SessionSettings = SessionSettings()
    vision: VisionSettings = VisionSettings()
    limits: ProcedureLimits = ProcedureLimits()
    arm_accuracy: ArmAccuracy = ArmAccuracy()
    audit: AuditSettings = AuditSettings()

    @field_validator("database_url")
    @classmethod
    def _is_known(cls, url: str) -> str:
        """Refuse what no engine here opens, without saying it: a password may be in it."""
        try:
            address = sa.make_url(url)
        except (sa.exc.ArgumentError, ValueError):
            address = None
        backend = address and address.get_backend_name()
        if address is None or not (backend == "postgresql" or (backend == "sqlite" and address.database)):
            raise ValueError("neither sqlite:///FILE nor postgresql://USER@HOST/NAME")
        return url

    @property
    def key_file(self) -> Path:
        """The key that signs checkpoints."""
        return self.audit.key_file or self.data_folder / "audit" / "signing.key"

    @property
    def anchor_file(self) -> Path:
        """Where the ledger's newest entry is noted outside the database."""
        return self.audit.anchor_file or self.data_folder / "audit" / "head.json"

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Arguments, then environment, then the TOML file; no .env file and no secrets folder."""
        del dotenv_settings, file_secret_settings
        return init_settings, env_settings, TomlConfigSettingsSource(settings_cls)

    def decisive(self) -> bytes:
        """What decides during a case (H30), as JSON; addresses, folders and session lengths do not."""
        decide = {"room", "arm_address", "dicom", "vision", "limits", "arm_accuracy"}
        return self.model_dump_json(include=decide).encode()

    def fingerprint(self) -> str:
        """SHA-256 of what decides."""
        return hashlib.sha256(self.decisive()).hexdigest()


def load_settings(file: Path | None = None, overrides: Mapping[str, Any] | None = None) -> Settings:
    """Settings from `file`, environment and `overrides`; raises ServiceError naming the key that is wrong."""
    if file is not None and not file.is_file():
        raise ServiceError(ErrorCode.SETTINGS_REFUSED, f"settings file {file} does not exist, or is no file")

    class FileSettings(Settings):
        model_config = SettingsConfigDict(toml_file=file)

    try:
        return FileSettings(**(overrides or {}))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        key = ".".join(str(part) for part in first["loc"])
        wrong = "there is no such setting" if first["type"] == "extra_forbidden" else first["msg"]
        raise ServiceError(ErrorCode.SETTINGS_REFUSED, f"setting {key or file}: {wrong}") from error
    except ValueError as error:  # the file is not TOML, or an environment variable is not JSON
        named = "" if file is None else f", file {file}"
        raise ServiceError(ErrorCode.SETTINGS_REFUSED, f"settings{named} cannot be read: {error}") from error
