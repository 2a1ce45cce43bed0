"""What a caller sends with each command. Numbers are finite and plausible, or the request is refused (H09)."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, model_validator

from service.devices.store import DeviceKind
from workflow.decisions import ImageUse
from workflow.plans import PlanKind
from workflow.states import GuideState

Reason = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=500)]
OptionalReason = Annotated[str, StringConstraints(strip_whitespace=True, max_length=500)]
Identifier = Annotated[str, StringConstraints(min_length=1, max_length=64)]
Name = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=64)]
Pin = Annotated[str, StringConstraints(pattern=r"^[0-9]{4,12}$")]
_Pixel = Annotated[float, Field(ge=-0.5, le=65535.5, allow_inf_nan=False)]
# A UR5 reaches 850 mm; a position in metres is within 1.3 of zero all along and is caught by the path check (H09).
_Reach = Annotated[float, Field(ge=-1300.0, le=1300.0, allow_inf_nan=False)]
_Turn = Annotated[float, Field(ge=-360.0, le=360.0, allow_inf_nan=False)]
# Interlocks that the surgeon overrides with this one request, each with the reason.
Overrides = Annotated[dict[Identifier, Reason], Field(max_length=8)]
DepthMm = Annotated[float, Field(ge=10.0, le=300.0, allow_inf_nan=False)]
Millimetres = tuple[_Reach, _Reach, _Reach]
Degrees = tuple[_Turn, _Turn, _Turn]


class Body(BaseModel):
    """Unknown fields are refused: a misspelt one must not fall back to a default."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Nothing(Body):
    """A command that needs no more than its name."""


class WithReason(Body):
    """A command that asks why."""

    reason: Reason


class WithOptionalReason(Body):
    """A command that may ask why."""

    reason: OptionalReason = ""


class ImageAgain(Body):
    """An image that is stored already."""

    image_id: Identifier


class StateIdentity(Body):
    """Whose an image is that does not say so itself, and of which view and exposure: the ids in force, or none."""

    image_id: Identifier
    patient_id: Identifier
    view_id: Identifier | None = None
    window_id: Identifier | None = None
    purpose: ImageUse | None = None  # what it must turn out to be for; a scout or a depth check only a person knows


class ImagePoint(Body):
    """A point tapped in an image, with the image and the grid that it is in (H08)."""

    image_id: Identifier
    pixel_px: tuple[_Pixel, _Pixel]
    space: Literal["raw", "corrected"]


class ConfirmTarget(Body):
    """The echo that the surgeon saw; the planned target it stands for, if any."""

    echo_id: Identifier
    planned_target: Name | None = None
    depth_mm: DepthMm | None = None
    overrides: Overrides = {}


class Correct(Body):
    """A correction from the verification image; the third needs a reason."""

    reason: OptionalReason = ""
    overrides: Overrides = {}


class Pose(Body):
    """A pose or a step: translation in mm, rotation vector in degrees."""

    translation_mm: Millimetres
    rotation_vector_deg: Degrees = (0.0, 0.0, 0.0)


class RequestPlan(Body):
    """A plan of one kind, and where it goes unless the target says.

    `base_from_goal` for approach and calibration, `step` (in the guide's own frame) for nudge, `distance_mm` for a
    retreat along the guide's axis; targeting and corrective take neither.
    """

    kind: PlanKind
    base_from_goal: Pose | None = None
    step: Pose | None = None
    distance_mm: Annotated[float, Field(ge=1.0, le=400.0, allow_inf_nan=False)] | None = None
    overrides: Overrides = {}

    @model_validator(mode="after")
    def _goal_of_its_kind(self) -> "RequestPlan":
        wanted = _GOAL_OF.get(self.kind)
        given = {name for name in ("base_from_goal", "step", "distance_mm") if getattr(self, name) is not None}
        if given != ({wanted} if wanted else set()):
            raise ValueError(f"a {self.kind} plan takes {wanted or 'its goal from the target'}, nothing else")
        return self


_GOAL_OF = {
    PlanKind.APPROACH: "base_from_goal",
    PlanKind.CALIBRATION: "base_from_goal",
    PlanKind.NUDGE: "step",
    PlanKind.RETREAT: "distance_mm",
}


class ApproveMove(Body):
    """The surgeon's approval of one plan."""

    plan_id: Identifier
    pin: Pin
    overrides: Overrides = {}


class WithPin(Body):
    """A critical step: the PIN with this very request."""

    pin: Pin


class StateGuide(Body):
    """What a person says is in the guide's bore (H35)."""

    guide: GuideState


class RemoveSleeve(Body):
    """What is left in the bore once the sleeve is out."""

    guide: Literal[GuideState.EMPTY, GuideState.WIRE] = GuideState.EMPTY


class FinishTarget(Body):
    """Whether the sleeve is where it belongs, or why the attempt is given up."""

    placed: bool
    reason: OptionalReason = ""


class StateMovement(Body):
    """What moved."""

    what: OptionalReason = ""


class ChangeDevices(Body):
    """Device files to use from now on, by kind; the others stay."""

    what: OptionalReason = ""
    devices: dict[DeviceKind, Identifier] = {}


class Acknowledge(Body):
    """A surgeon looked, and says what is in the guide now."""

    guide: GuideState


class CloseCase(Body):
    """The surgeon's signature, and why each planned target that was not placed is given up."""

    pin: Pin
    abandoned: dict[Name, Reason] = {}


class WriteNote(Body):
    """A remark for the record."""

    text: Reason


class AssignImage(Body):
    """What a person says that an image is for; whose it is and why, where it was quarantined or in no case."""

    image_id: Identifier
    purpose: ImageUse
    reason: OptionalReason = ""
    patient_id: Identifier | None = None


class LabelImage(Body):
    """A word on an image."""

    image_id: Identifier
    label: Name
