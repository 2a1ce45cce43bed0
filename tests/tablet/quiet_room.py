"""A service without arm and C-arm, with one closed case in its record: for the screens that need neither."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from uuid import uuid4

from argon2 import PasswordHasher
from playwright.sync_api import APIResponse, Route
from sqlalchemy.engine import Connection

from benchmarks.recorded_cases import Results, record
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.cases import store
from service.cases.records import ArtefactKind, NewEvent
from service.database.current import current_database
from service.settings import DicomSettings, HttpSettings, Settings
from tests.service.conftest import PASSWORD, PIN, RunningService, serve_in_thread
from tests.tablet.tablet import Tablet
from workflow.case import Verification
from workflow.case_json import from_json, to_json
from workflow.links import Artefact
from workflow.states import State

_TARGET = {"name": "L3-left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}
_CHEAP = PasswordHasher(time_cost=1, memory_cost=8, parallelism=1)


@dataclass(frozen=True)
class QuietRoom:
    """What is up, and the case in its record."""

    running: RunningService
    case_id: str
    open_at: Callable[..., Tablet]

    def tablet_of(self, role: Role, place: str = "", **differing: object) -> Tablet:
        """A tablet at a place, where this role is signed in."""
        tablet = self.open_at(self.running.url, **differing)
        tablet.go_in(role.value, PIN, place)
        return tablet

    def open_case(self) -> str:
        """A case of patient P1; its id."""
        body = {"patient_id": "P1", "study_uid": "1.2.3", "targets": [_TARGET]}
        with self.running.client() as client:
            case: dict[str, Any] = client.post("/cases", json=body, headers=_new_intent()).json()
        return str(case["id"])

    def abort_case(self) -> dict[str, Any]:
        """End the open case; what it was."""
        with self.running.client() as client:
            case: dict[str, Any] = client.get(f"/cases/{client.get('/status').json()['open_case']}").json()
            client.post(f"/cases/{case['id']}/case-aborted", json={"reason": "test"}, headers=_new_intent())
            assert client.get("/status").json()["open_case"] is None
        return case

    def put(self, state: State, **otherwise: object) -> None:
        """The recorded case, with its whole chain unless said otherwise, is in this state now."""
        with self.running.parts.database.write() as connection:
            last = from_json(dict(store.newest_event(connection, self.case_id).case_state))
            case = replace(last, state=state, **self._chain(connection) | otherwise)
            event = NewEvent("note", None, state, to_json(case), {"text": f"put into {state}"})
            store.append(connection, self.case_id, event, expected_version=None)

    def tell(self, trigger: str, data: dict[str, object]) -> None:
        """An event of the recorded case that changes nothing else."""
        with self.running.parts.database.write() as connection:
            last = store.newest_event(connection, self.case_id)
            event = NewEvent(trigger, None, last.state, last.case_state, data)
            store.append(connection, self.case_id, event, expected_version=None)

    def _chain(self, connection: Connection) -> dict[str, object]:
        first, second = store.artefacts_of(connection, ArtefactKind.REGISTRATION, self.case_id)
        (target,) = store.artefacts_of(connection, ArtefactKind.TARGET, self.case_id)
        (evaluation,) = store.artefacts_of(connection, ArtefactKind.EVALUATION, self.case_id)
        return {
            "view": Artefact("view", ()),
            "image": Artefact(first.columns["image_id"], ("view",)),
            "registration": Artefact(first.id, first.made_from),
            "target": Artefact(target.id, target.made_from),
            "verification": Verification(
                evaluation.id, evaluation.made_from, second.columns["image_id"], "motion", passed=True, judged_s=0.0
            ),
        }


def answer_as_if_all_were_allowed(route: Route, answer: APIResponse) -> None:
    """The quiet room has no arm; what an arm would allow is not what is looked at."""
    told: dict[str, Any] = answer.json()
    free = {"allowed": True, "permitted": True, "needs_control": False, "reasons": []}
    told["allowed"] = {trigger: asked | free for trigger, asked in told["allowed"].items()}
    route.fulfill(response=answer, json=told)


def _new_intent() -> dict[str, str]:
    return {"Idempotency-Key": uuid4().hex}


@contextmanager
def closed_case(folder: Path, results: Results) -> Iterator[tuple[RunningService, str]]:
    """The service over the record of one closed case, and the case's id."""
    settings = Settings(data_folder=folder, min_free_bytes=0, http=HttpSettings(port=0), dicom=DicomSettings(port=0))
    with current_database(settings) as database:
        surgeon = UserStore(database, _CHEAP).add(Role.SURGEON.value, Role.SURGEON, PASSWORD, PIN)
        case_id = record(database, settings, surgeon.id, results, State.CLOSED)
    with contextmanager(serve_in_thread)(settings) as running:
        yield running, case_id
