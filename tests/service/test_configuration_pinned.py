"""H30: a case that was opened under other settings, another program or other device bytes goes no further."""

import pytest

from coaxial_client import Coaxial, Refused
from service.auth.permissions import Role
from service.settings import ProcedureLimits

_CASE = {
    "patient_id": "P1",
    "study_uid": "1.2.3",
    "targets": [{"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}],
}


def _surgeon(room) -> Coaxial:
    client = Coaxial(room.url)
    client.sign_in(Role.SURGEON.value, "correct horse")
    return client


@pytest.fixture
def left_open(settings, serving, device_files):
    """A case of an earlier run."""
    with serving(settings) as room, _surgeon(room) as surgeon:
        for kind, content in device_files.items():
            surgeon.upload_device(kind, content.encode())
        surgeon.open_case(_CASE)
    return settings


def _refused(case):
    status = case.status()["allowed"]
    reasons = {trigger: {reason["code"]: reason for reason in one["reasons"]} for trigger, one in status.items()}
    return {trigger: found["configuration"] for trigger, found in reasons.items() if "configuration" in found}


def _other_program(monkeypatch, _settings, _databases):
    monkeypatch.setattr("service.conductor.configuration.PRODUCT_VERSION", "9.9.9")


def _other_settings(_monkeypatch, settings, _databases):
    return settings.model_copy(update={"limits": ProcedureLimits(angle_error_deg=2.0)})


def _other_device_bytes(_monkeypatch, settings, databases):
    with databases.attack(settings.database_url) as attacker:
        (content,) = attacker.execute("SELECT content FROM device_files WHERE kind = 'tcp'").fetchone()
        attacker.execute("UPDATE device_files SET content = ? WHERE kind = 'tcp'", [content + b"\n"])


@pytest.mark.hazard("H30")
@pytest.mark.parametrize("change", [_other_program, _other_settings, _other_device_bytes])
def test_after_a_change_the_case_goes_no_further_but_can_be_ended(left_open, serving, monkeypatch, databases, change):
    settings = change(monkeypatch, left_open, databases) or left_open
    with serving(settings) as room, _surgeon(room) as surgeon:
        case = surgeon.case(surgeon.get_list("/cases")[0]["id"])
        reason = _refused(case)["carm_position_confirmed"]
        assert len(reason["measured"]) == len(reason["limit"]) == 12
        assert reason["measured"] != reason["limit"]
        with pytest.raises(Refused) as refused:
            case.command("carm-position-confirmed")
        assert "configuration" in {one["code"] for one in refused.value.verdicts if not one["passed"]}
        case.command("guide-state-stated", guide="empty")
        case.command("note", text="the program was updated")
        assert surgeon.post("/stop", {}, {})["recorded"]
        assert not {"acknowledged", "case_closed", "lease_taken", "target_done"} & _refused(case).keys()
        assert case.command("case-aborted", reason="updated in the middle")["state"] == "aborted"


def test_without_a_change_the_next_run_goes_on(left_open, serving):
    with serving(left_open) as room, _surgeon(room) as surgeon:
        case = surgeon.case(surgeon.get_list("/cases")[0]["id"])
        assert _refused(case) == {}
        case.command("case-aborted", reason="end of the test")
