"""Errors and pose of every verification as DICOM Comprehensive SR (PS3.16 TID 1500).

The names of what is measured are Coaxial's own (scheme 99COAXIAL): no standard vocabulary has them.
"""

import numpy as np
from highdicom.sr import (
    CodedConcept,
    ComprehensiveSR,
    DeviceObserverIdentifyingAttributes,
    Measurement,
    MeasurementReport,
    MeasurementsAndQualitativeEvaluations,
    ObservationContext,
    ObserverContext,
    QualitativeEvaluation,
    SourceImageForMeasurementGroup,
    TrackingIdentifier,
)
from pydicom import Dataset
from pydicom.sr.codedict import codes
from pydicom.uid import UID
from scipy.spatial.transform import Rotation

from service.cases.records import Json
from service.cases.verifications import Verification
from service.pacs.derived import MANUFACTURER, DerivedObject, ObjectKind, Place, finished
from service.version import PRODUCT_VERSION

_SCHEME = "99COAXIAL"
_FLUOROSCOPY = CodedConcept("44491008", "SCT", "Fluoroscopy")
_NEEDLE_GUIDE = CodedConcept("guide", _SCHEME, "Needle guide against its target")
_DEG = CodedConcept("deg", "UCUM", "degree")
_MM = CodedConcept("mm", "UCUM", "millimeter")


def structured_report(
    place: Place, device_uid: UID, verifications: list[Verification], evidence: dict[str, Dataset]
) -> DerivedObject:
    """One group of measurements per verification.

    `evidence` holds the headers of the C-arm's images by image id, at least that of one verification; patient and
    study are theirs.
    """
    groups = [_group(one, evidence) for one in verifications if one.image_id in evidence]
    report = ComprehensiveSR(
        evidence=list(evidence.values()),
        content=MeasurementReport(
            observation_context=ObservationContext(observer_device_context=_observer(device_uid)),
            procedure_reported=_FLUOROSCOPY,
            imaging_measurements=groups,
            title=codes.DCM.ImagingMeasurementReport,
        ),
        series_instance_uid=place.series_uid,
        series_number=place.series_number,
        sop_instance_uid=place.sop_uid,
        instance_number=place.number,
        manufacturer=MANUFACTURER,
        is_complete=True,
        series_description="Coaxial: errors and poses",
    )
    return finished(ObjectKind.STRUCTURED_REPORT, report)


def _observer(device_uid: UID) -> ObserverContext:
    device = DeviceObserverIdentifyingAttributes(
        uid=device_uid, name=MANUFACTURER, manufacturer_name=MANUFACTURER, model_name=f"Coaxial {PRODUCT_VERSION}"
    )
    return ObserverContext(observer_type=codes.DCM.Device, observer_identifying_attributes=device)


def _group(one: Verification, evidence: dict[str, Dataset]) -> MeasurementsAndQualitativeEvaluations:
    after = evidence[one.image_id]
    verdict = ("passed", "Verification passed") if one.passed else ("failed", "Verification failed: limit exceeded")
    return MeasurementsAndQualitativeEvaluations(
        tracking_identifier=TrackingIdentifier(uid=None, identifier=one.planned_target or "unplanned target"),
        finding_type=_NEEDLE_GUIDE,
        measurements=[*_errors(one.figures), *_pose(one.registration)],
        qualitative_evaluations=[
            QualitativeEvaluation(_named("verification", "Verification"), CodedConcept(verdict[0], _SCHEME, verdict[1]))
        ],
        source_images=[SourceImageForMeasurementGroup(str(after.SOPClassUID), str(after.SOPInstanceUID))],
    )


def _errors(figures: Json) -> list[Measurement]:
    """Both evaluations, and the contour evaluation's 95 % bounds."""
    contour, paper = figures["contour"], figures["paper"]
    bounds = contour["predicted_error_95"]
    return [
        Measurement(_named("contour-angle", "Angle error by contours"), contour["angle_error_deg"], _DEG),
        Measurement(_named("contour-angle-95", "95 % bound of angle error"), bounds["angle_deg"], _DEG),
        Measurement(_named("contour-position", "Position error by contours"), contour["position_error_mm"], _MM),
        Measurement(_named("contour-position-95", "95 % bound of position error"), bounds["position_mm"], _MM),
        Measurement(_named("depth", "Target depth below the big ring"), bounds["depth_mm"], _MM),
        Measurement(_named("paper-angle", "Angle error by ring centres"), paper["angle_error_deg"], _DEG),
        Measurement(_named("paper-position", "Position error by ring centres"), paper["position_error_mm"], _MM),
    ]


def _pose(registration: Json) -> list[Measurement]:
    """The guide in the X-ray source's frame: origin (3,), mm, and rotation vector (3,), deg."""
    source_from_guide = np.array(registration["source_from_guide"], dtype=np.float64)
    turn_deg = np.rad2deg(Rotation.from_matrix(source_from_guide[:3, :3]).as_rotvec())
    origins = [
        Measurement(_named(f"origin-{axis}", f"Guide origin {axis} from source"), float(value), _MM)
        for axis, value in zip("xyz", source_from_guide[:3, 3], strict=True)
    ]
    turns = [
        Measurement(_named(f"rotation-{axis}", f"Guide rotation vector {axis} from source"), float(value), _DEG)
        for axis, value in zip("xyz", turn_deg, strict=True)
    ]
    return [*origins, *turns]


def _named(value: str, meaning: str) -> CodedConcept:
    return CodedConcept(value, _SCHEME, meaning)
