"""How long the commit of a permit takes while four C-arms send images.

    python benchmarks/four_senders.py [--count N] [--senders N] [--side PIXELS] [--seed N] [--database URL]

The receiver and its database are the service's own; the senders are processes of dcmtk's storescu, each with all of
its images on one association. A permit is committed ten times a second as `move-approved` does it: the attempt with 22
verdicts, the event, the permit, their entry in the ledger. Told are the wait until its transaction begins and the whole
time until it is committed, first without senders, then with them, and whether all that was acknowledged is stored. Exit
status 1 where a permit waits longer than the limit, or an image is missing.
"""

import argparse
import logging
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import structlog
from argon2 import PasswordHasher
from pydicom import Dataset
from pydicom.dataset import FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, XRayAngiographicImageStorage, generate_uid

from service.auth.permissions import Role
from service.auth.users import UserStore
from service.cases import store
from service.cases.attempts import record_attempt
from service.cases.records import ArtefactKind, NewArtefact, NewAttempt, NewCase, NewEvent, NewVerdict
from service.database.engines import Database, open_database
from service.database.migrate import migrate
from service.images.arrivals import ImageArrivals
from service.images.receiver import DicomReceiver
from service.images.store import count_images
from service.ledger.keys import signing_key
from service.settings import DicomSettings

GREATEST_WAIT_MS = 50.0
_EVERY_S = 0.1
_QUIET = 50
_CALLER = "CARM"
_VERDICTS = tuple(NewVerdict(f"check_{n}", "H03", True, 12.3456789, 1800.0, "s", "") for n in range(22))
_STATE = {"state": "target_chosen", "chain": dict.fromkeys("abcdefgh", "0" * 32), "text": "x" * 600}


@dataclass(frozen=True, slots=True)
class Commit:
    """One permit, ms: until its transaction began, until it was committed."""

    wait_ms: float
    whole_ms: float


class Permits:
    """A case whose permits are committed, one after another, until told to end."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._user_id = (
            UserStore(database, PasswordHasher(1, 8, 1)).add("anna", Role.SURGEON, "correct horse", "2468").id
        )
        case = NewCase("case", "room", "P1", "1.2.3", self._user_id, "0" * 64, {}, {})
        with database.write() as connection:
            store.open_case(connection, case, NewEvent("case_opened", self._user_id, "case_open", _STATE, {}))

    def commit(self, number: int) -> Commit:
        """As `move-approved` records it."""
        attempt = NewAttempt("case", self._user_id, "move_approved", True, "taken", "", "target_chosen", _VERDICTS)
        event = NewEvent("move_approved", self._user_id, "target_chosen", _STATE, {"made": {"permit": str(number)}})
        permit = NewArtefact(ArtefactKind.PERMIT, str(number), (), _STATE, {"approved_by": self._user_id})
        asked_s = time.perf_counter()
        with self._database.write() as connection:
            began_s = time.perf_counter()
            record_attempt(connection, attempt)
            store.append(connection, "case", event, expected_version=None, artefacts=[permit])
        return Commit(1e3 * (began_s - asked_s), 1e3 * (time.perf_counter() - asked_s))

    def until(self, ended: threading.Event, first: int) -> list[Commit]:
        """Ten a second."""
        commits = []
        while not ended.wait(_EVERY_S):
            commits.append(self.commit(first + len(commits)))
        return commits


def main() -> int:
    """Measure; the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--count", type=int, default=100, help="images of each sender")
    parser.add_argument("--senders", type=int, default=4)
    parser.add_argument("--side", type=int, default=1024, help="of an image of 16 bits, pixels")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--database", help="an empty one; without it a file")
    wanted = parser.parse_args()
    structlog.configure(wrapper_class=structlog.make_filtering_bound_logger(logging.WARNING))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folders = [_images(folder / str(n), wanted.count, wanted.side, wanted.seed + n) for n in range(wanted.senders)]
        with _database(folder, wanted.database) as database:
            return _measure(database, folders, wanted)


def _measure(database: Database, folders: Sequence[Path], wanted: argparse.Namespace) -> int:
    permits = Permits(database)
    quiet = [permits.commit(number) for number in range(_QUIET)]
    limits = DicomSettings(port=0, accepted_callers=(_CALLER,))
    with DicomReceiver(limits, database, ImageArrivals(), lambda: None).listening() as port:
        began_s, ended, busy = time.perf_counter(), threading.Event(), []
        thread = threading.Thread(target=lambda: busy.extend(permits.until(ended, _QUIET)))
        thread.start()
        senders = [_sender(port, one) for one in folders]
        acknowledged = sum(one.communicate()[0].count("Received Store Response (Success)") for one in senders)
        lasted_s = time.perf_counter() - began_s
        ended.set()
        thread.join()
    with database.read() as connection:
        stored = count_images(connection)
    megabytes = 2e-6 * wanted.side**2 * stored
    print(f"{wanted.senders} senders, {wanted.count} images each of {wanted.side} x {wanted.side}, seed {wanted.seed}")
    print(f"acknowledged {acknowledged}, stored {stored}, {megabytes / lasted_s:.1f} MB/s, {lasted_s:.1f} s")
    for words, commits in (("no sender", quiet), ("sending", busy)):
        print(_line(f"{words}, wait", [one.wait_ms for one in commits]))
        print(_line(f"{words}, whole", [one.whole_ms for one in commits]))
    waited = max(one.wait_ms for one in busy)
    missing = stored != acknowledged or stored != wanted.count * wanted.senders
    return int(waited > GREATEST_WAIT_MS or missing)


def _line(words: str, values_ms: Sequence[float]) -> str:
    shown = "  ".join(f"{name} {np.percentile(values_ms, share):6.1f}" for name, share in _SHARES.items())
    return f"{words:18} {len(values_ms):5} permits, ms:  {shown}"


_SHARES = {"median": 50, "95 %": 95, "99 %": 99, "greatest": 100}


@contextmanager
def _database(folder: Path, url: str | None) -> Iterator[Database]:
    database = open_database(url or f"sqlite:///{folder / 'coaxial.sqlite'}", signing_key(folder / "signing.key"))
    try:
        migrate(database)
        yield database
    finally:
        database.close()


def _sender(port: int, folder: Path) -> "subprocess.Popen[str]":
    program = shutil.which("storescu")
    if program is None:
        raise SystemExit("missing Debian package: apt-get install dcmtk")
    command = [program, "-v", "-aet", _CALLER, "127.0.0.1", str(port), *map(str, sorted(folder.iterdir()))]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def _images(folder: Path, count: int, side: int, seed: int) -> Path:
    folder.mkdir()
    random = np.random.default_rng(seed)
    for number in range(count):
        pixels = random.integers(0, 2**16, (side, side), np.uint16)
        _image(pixels).save_as(folder / f"{number:06}.dcm", enforce_file_format=True)
    return folder


def _image(pixels: np.ndarray) -> Dataset:
    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset.SOPClassUID, dataset.SOPInstanceUID = XRayAngiographicImageStorage, generate_uid()
    dataset.PatientID, dataset.StudyInstanceUID, dataset.Modality = "P1", "1.2.3", "XA"
    dataset.Rows, dataset.Columns = pixels.shape
    dataset.SamplesPerPixel, dataset.PixelRepresentation = 1, 0
    dataset.PhotometricInterpretation = "MONOCHROME2"
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit = 16, 16, 15
    dataset.PixelData = pixels.tobytes()
    return dataset


if __name__ == "__main__":
    sys.exit(main())
