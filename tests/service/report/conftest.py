"""A case's record without a database: events as a procedure leaves them, a second apart."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from pydicom import Dataset

from service.cases.records import ArtefactKind, StoredArtefact, StoredCase, StoredEvent
from service.report.record import CaseImage, CaseRecord

_PLAN = {"length_mm": 12.34, "rotation_deg": 1.5, "kind": "targeting"}


class Telling:
    """Tells a case event by event."""

    def __init__(self) -> None:
        self.events: list[StoredEvent] = []
        self.artefacts: dict[ArtefactKind, dict[str, StoredArtefact]] = {kind: {} for kind in ArtefactKind}
        self.images: dict[str, CaseImage] = {}
        self.decisions: list[dict[str, Any]] = []
        self.standing: str | None = None
        self.tell("case_opened", state="case_open")

    def tell(self, trigger: str, user: str | None = "s", state: str = "moved", **data: Any):
        number = len(self.events) + 1
        recorded_at = f"2026-11-22T10:{number // 60:02d}:{number % 60:02d}.000000Z"
        case_state = {"target": {"id": self.standing} if self.standing else None}
        event = StoredEvent("c", number, number, trigger, user, state, case_state, data, recorded_at)
        self.events.append(event)
        return event

    def make(self, kind: ArtefactKind, content: dict[str, Any], **columns: Any) -> str:
        """An artefact of the event that is told next."""
        made = f"{kind}-{len(self.artefacts[kind])}"
        sequence = len(self.events) + 1
        self.artefacts[kind][made] = StoredArtefact(made, "c", sequence, (), content, columns, "2026-11-22T10:59:59Z")
        return made

    def image(self, dose: float | None = None, purpose: str = "registration") -> str:
        image_id = f"image-{len(self.images)}"
        metadata = {} if dose is None else {"dose_area_product_dgy_cm2": dose}
        stored = SimpleNamespace(id=image_id, metadata=metadata, received_at="2026-11-22T10:00:00Z")
        self.images[image_id] = CaseImage(stored, SimpleNamespace(purpose=purpose))
        self.tell("image_arrived", None, image_id=image_id)
        return image_id

    def aim(self, name: str | None, image_id: str, trigger: str = "target_confirmed") -> None:
        self.standing = self.make(
            ArtefactKind.TARGET, {"planned_target": name, "image_id": image_id, "raw_px": (1.0, 2.0), "depth_mm": 80.0}
        )
        self.tell(trigger, overrides={})

    def move(self, kind: str = "targeting", cause: str = "arrived") -> None:
        plan = self.make(ArtefactKind.PLAN, _PLAN | {"kind": kind})
        self.tell("plan_requested", kind=kind)
        self.tell("move_approved", plan_id=plan)
        motion = f"motion-{len(self.artefacts[ArtefactKind.MOTION])}"
        self.tell("move_started", kind=kind, plan_id=plan, motion_id=motion)
        content = {"cause": cause, "distance_mm": 0.0}
        self.artefacts[ArtefactKind.MOTION][motion] = StoredArtefact(
            motion, "c", len(self.events) + 1, (), content, {}, self.events[-1].recorded_at
        )
        self.tell("arrived", None)

    def verify(self, image_id: str, position_mm: float, limit_mm: float = 1.5) -> None:
        bounds = {"angle_deg": 0.05, "position_mm": 0.12, "depth_mm": 80.0}
        contour = {"angle_error_deg": 0.4, "position_error_mm": position_mm, "predicted_error_95": bounds}
        paper = {"angle_error_deg": 0.5, "position_error_mm": position_mm + 0.1}
        self.make(ArtefactKind.EVALUATION, {"contour": contour, "paper": paper}, image_id=image_id)
        passed = position_mm + 0.12 <= limit_mm
        verdict = {
            "code": "position_error", "hazard": "H28", "passed": passed, "measured": position_mm + 0.12,
            "limit": limit_mm, "unit": "mm", "message": "" if passed else "exceeds the limit",
        }  # fmt: skip
        self.decide("verification_passed", None, verdict)
        trigger = "verification_passed" if passed else "verification_failed"
        self.tell(trigger, None, told_as="verification_passed", image_id=image_id)

    def decide(self, trigger: str, user: str | None, *verdicts: dict[str, Any], accepted: bool = True) -> None:
        self.decisions.append(
            {"trigger": trigger, "user_id": user, "accepted": accepted, "code": "taken", "message": "",
             "recorded_at": "2026-11-22T10:00:00Z", "verdicts": list(verdicts)}
        )  # fmt: skip

    def record(self, *planned: str) -> CaseRecord:
        case = StoredCase("c", "room-1", "P1", "1.2.3", "s", "0.1.0", "0" * 64, {}, self.events[0].recorded_at)
        return CaseRecord(
            case=case, identity=Dataset(), planned={name: {} for name in planned}, events=self.events,
            artefacts=self.artefacts, images=self.images, image_bytes={}, devices=[], decisions=self.decisions,
            people={"s": "anna"}, proof=None,
        )  # fmt: skip


@pytest.fixture
def telling() -> Telling:
    return Telling()


@pytest.fixture
def place(telling: Telling) -> Callable[..., None]:
    """The whole way of one target, with a correction where a first position error is told."""

    def go(name: str, position_mm: float, first_mm: float | None = None) -> None:
        telling.tell("carm_position_confirmed", "o")
        before = telling.image(0.35)
        telling.aim(name, before)
        telling.move()
        if first_mm is not None:
            off = telling.image(0.35, "verification")
            telling.verify(off, first_mm)
            telling.aim(name, off, "correction_requested")
            telling.move("corrective")
        telling.verify(telling.image(0.35, "verification"), position_mm)
        telling.tell("target_done", placed=True, reason="", planned_target=name)
        telling.standing = None
        telling.move("retreat")

    return go
