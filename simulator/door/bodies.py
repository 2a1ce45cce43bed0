"""What the door takes."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Joints = Annotated[list[float], Field(min_length=6, max_length=6)]


class Body(BaseModel):
    """Unknown keys, and numbers that are none, are refused."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class CarmPosition(Body):
    """Positioner angles, DICOM patient-based; centred by eye on a pedicle, else on the one that fits the angles."""

    primary_deg: float
    secondary_deg: float
    pedicle: str | None = None


class Study(Body):
    """What the worklist gives to the C-arm."""

    patient_id: Annotated[str, Field(min_length=1, max_length=64)]
    study_uid: Annotated[str, Field(pattern=r"^[0-9.]{1,64}$")]
    patient_name: Annotated[str, Field(min_length=1, max_length=64)] = "Simulated^Patient"


class Override(Body):
    """What is wrong or different for one image; `at_expiration` waits until the patient has breathed out."""

    at_expiration: bool = False

    patient_id: Annotated[str, Field(min_length=1, max_length=64)] | None = None
    study_uid: Annotated[str, Field(pattern=r"^[0-9.]{1,64}$")] | None = None
    patient_name: Annotated[str, Field(min_length=1, max_length=64)] | None = None


class Jog(Body):
    """Joint steps, or a straight step of the TCP in base coordinates; exactly one of them."""

    joints_deg: Joints | None = None
    step_mm: Vector | None = None


class Push(Body):
    """A shove at the arm at rest, base coordinates."""

    step_mm: Vector
