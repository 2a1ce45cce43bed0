"""Who is next, asked of dcmtk's worklist server."""

import shutil
import subprocess

import pytest

from service.errors import ErrorCode, ServiceError
from service.pacs.worklist import find_scheduled
from service.settings import PeerSettings

_ENTRY = """
(0008,0005) CS ISO_IR 192
(0008,0050) SH {number}
(0010,0010) PN {name}
(0010,0020) LO {patient}
(0010,0030) DA 19600101
(0010,0040) CS F
(0020,000d) UI 1.2.3.{number}
(0032,1060) LO Pedicle screws L3
(0040,0100) SQ
(fffe,e000) -
(0008,0060) CS XA
(0040,0001) AE COAXIAL
(0040,0002) DA {date}
(0040,0003) TM 081500
(0040,0006) PN Surgeon
(0040,0007) LO Screws
(0040,0009) SH S{number}
(fffe,e00d) -
(fffe,e0dd) -
(0040,1001) SH R{number}
"""
_SCHEDULED = [("1", "Müller^Änne", "P1", "20261122"), ("2", "Doe^Jane", "P2", "20261123")]


@pytest.fixture
def worklist(tmp_path, free_port, program_at_work):
    folder = tmp_path / "lists" / "PACS"
    folder.mkdir(parents=True)
    (folder / "lockfile").touch()
    for number, name, patient, date in _SCHEDULED:
        text = tmp_path / f"{number}.txt"
        text.write_text(_ENTRY.format(number=number, name=name, patient=patient, date=date), encoding="utf-8")
        subprocess.run([shutil.which("dump2dcm"), text, folder / f"{number}.wl"], check=True, timeout=20)
    with program_at_work(free_port, "wlmscpfs", "-csk", "-dfp", str(tmp_path / "lists"), str(free_port)):
        yield PeerSettings(host="127.0.0.1", port=free_port)


def test_the_worklist_says_who_is_next(worklist):
    first, second = sorted(find_scheduled(worklist, "COAXIAL"), key=lambda one: one.patient_id)
    assert (first.patient_id, first.patient_name, first.study_uid) == ("P1", "Müller^Änne", "1.2.3.1")
    assert (first.scheduled_at, first.description, first.station) == ("20261122 081500", "Pedicle screws L3", "COAXIAL")
    assert second.patient_name == "Doe^Jane"


def test_a_date_and_a_patient_choose(worklist):
    assert [one.patient_id for one in find_scheduled(worklist, "COAXIAL", date="20261123")] == ["P2"]
    assert [one.patient_id for one in find_scheduled(worklist, "COAXIAL", patient_id="P1")] == ["P1"]
    assert find_scheduled(worklist, "COAXIAL", date="20200101") == []


def test_a_worklist_that_is_down_or_not_named_is_said_so(free_port):
    with pytest.raises(ServiceError) as down:
        find_scheduled(PeerSettings(host="127.0.0.1", port=free_port), "COAXIAL")
    assert down.value.code == ErrorCode.PEER_UNREACHABLE
    with pytest.raises(ServiceError) as unnamed:
        find_scheduled(PeerSettings(), "COAXIAL")
    assert unnamed.value.code == ErrorCode.PEER_UNKNOWN


def test_the_wrong_title_is_refused_in_words(worklist):
    with pytest.raises(ServiceError) as wrong:
        find_scheduled(worklist.model_copy(update={"ae_title": "ELSEWHERE"}), "COAXIAL")
    assert wrong.value.code == ErrorCode.PEER_UNREACHABLE
