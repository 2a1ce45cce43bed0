"""A service without arm and C-arm, with one closed case in its record: for the screens that need neither."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from argon2 import PasswordHasher

from benchmarks import recorded_cases
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.database.current import current_database
from service.settings import DicomSettings, HttpSettings, Settings
from tests.service.conftest import PASSWORD, PIN, RunningService, serve_in_thread
from tests.tablet.tablet import Tablet
from workflow.states import State

_CHEAP = PasswordHasher(time_cost=1, memory_cost=8, parallelism=1)


@dataclass(frozen=True)
class QuietRoom:
    """What is up, and the case in its record."""

    running: RunningService
    case_id: str
    open_at: Callable[..., Tablet]

    def tablet_of(self, role: Role, **differing: object) -> Tablet:
        """A tablet that this role has signed in to."""
        tablet = self.open_at(self.running.url, **differing)
        tablet.sign_in(role.value, PIN)
        return tablet


@contextmanager
def closed_case(folder: Path) -> Iterator[tuple[RunningService, str]]:
    """The service over the record of one closed case, and the case's id."""
    settings = Settings(data_folder=folder, min_free_bytes=0, http=HttpSettings(port=0), dicom=DicomSettings(port=0))
    results = recorded_cases.compute(settings)
    with current_database(settings) as database:
        surgeon = UserStore(database, _CHEAP).add(Role.SURGEON.value, Role.SURGEON, PASSWORD, PIN)
        case_id = recorded_cases.record(database, settings, surgeon.id, results, State.CLOSED)
    with contextmanager(serve_in_thread)(settings) as running:
        yield running, case_id
