"""`coaxial demo --stay` leaves a room for the tablet and for programs."""

import signal

import httpx
import pytest

from coaxial_client import Coaxial
from tests.system import guide_page
from tests.system.demo_process import nothing_answers, running_demo


@pytest.mark.timeout(600)
def test_stay_leaves_a_room_that_the_python_clients_guide_goes_through_a_procedure_in(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with running_demo(tmp_path, "--stay") as demo:
        url = demo.wait_for(r"service +(http://\S+) +interface").group(1)
        room_url = demo.wait_for(r"room +(http://\S+) +planned").group(1)
        name, password, pin = demo.wait_for(r"sign-in +(surgeon) +password (\S+) +PIN (\d+)").groups()
        with Coaxial(url) as client:
            assert client.sign_in(name, password)["role"] == "surgeon"
            assert client.status()["arm_address"] is not None
            assert {one["kind"] for one in client.get_list("/devices")} == {"guide", "carm", "tcp", "room"}
            guide_page.run({"url": url, "room_url": room_url, "password": password, "pin": pin}, client)
            case = client.get_list("/cases")[0]
            assert (case["state"], case["patient_id"]) == (
                "closed",
                httpx.get(f"{room_url}/room").json()["patient"]["id"],
            )
            assert client.case(case["id"]).status()["targets"] == {"L1-left": "placed"}
        assert {file.name for file in tmp_path.glob("*.zip")} == {"case.zip", "case-for-the-maker.zip"}
        assert demo.end(signal.SIGINT) == 0
    assert nothing_answers(demo)
