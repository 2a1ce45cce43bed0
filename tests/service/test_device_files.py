"""Device files over HTTP: refused with the line that is wrong, never replaced, kept to the byte (H09, H10)."""

import hashlib

import pytest

from service.auth.permissions import Role


@pytest.fixture
def engineer(running):
    with running.client(Role.ENGINEER) as client:
        yield client


@pytest.mark.parametrize("kind", ["guide", "carm", "tcp", "room"])
def test_a_file_is_kept_to_the_byte_with_its_hash(engineer, device_files, kind):
    content = device_files[kind].encode()
    answer = engineer.post(f"/devices/{kind}", content=content)
    assert answer.status_code == 201
    device = answer.json()
    assert device["sha256"] == hashlib.sha256(content).hexdigest()
    assert engineer.get(f"/devices/{device['id']}/original").content == content
    assert device in engineer.get("/devices").json()


def test_the_same_bytes_again_are_the_same_device(engineer, device_files):
    first = engineer.post("/devices/guide", content=device_files["guide"]).json()
    again = engineer.post("/devices/guide", content=device_files["guide"]).json()
    assert again == first


@pytest.mark.hazard("H10")
def test_other_bytes_under_a_stored_version_are_refused(engineer, device_files):
    engineer.post("/devices/guide", content=device_files["guide"])
    changed = device_files["guide"].replace("radius = 30.0", "radius = 30.1")
    answer = engineer.post("/devices/guide", content=changed)
    assert (answer.status_code, answer.json()["code"]) == (409, "device_version_taken")
    newer = engineer.post("/devices/guide", content=changed.replace("version = 1", "version = 2"))
    assert newer.status_code == 201


@pytest.mark.hazard("H09")
@pytest.mark.parametrize(
    ("kind", "before", "after", "named"),
    [
        ("guide", "radius = 20.0", "radius = 0.02", "radius"),  # metres
        ("guide", "radius = 20.0", "radius = 20000.0", "radius"),  # micrometres
        ("guide", "separation = 60.0", "separation = nan", "separation"),
        ("guide", "radius = 20.0", "", "radius"),
        ("guide", "radius = 20.0", "radius = 40.0", "radius"),
        ("guide", "version = 1", 'version = "one"', "version"),
        ("carm", "source_to_image_distance = 1000.0", "source_to_image_distance = 1.0", "source_to_image"),
        ("tcp", "mass_kg = 0.8", "mass_kg = 800.0", "mass_kg"),
        ("tcp", "[tcp]", "[[[", "TOML"),
        ("tcp", "[envelope]", "[other]", "envelope"),
        ("room", "radius_mm = 150.0", "radius_mm = 0.15", "radius_mm"),  # metres
        ("room", 'occupant = "patient"', 'occupant = "other"', "patient"),
    ],
)
def test_an_implausible_file_is_refused_with_the_line(engineer, device_files, kind, before, after, named):
    before_count = len(engineer.get("/devices").json())
    answer = engineer.post(f"/devices/{kind}", content=device_files[kind].replace(before, after, 1))
    problem = answer.json()
    assert (answer.status_code, problem["code"]) == (422, "device_refused")
    assert named in problem["detail"]
    assert "\n" not in problem["detail"]
    assert len(engineer.get("/devices").json()) == before_count


@pytest.mark.parametrize("content", [b"", b"\x00\xff", b"\xef\xbb\xbf", b"[" * 10_000, b"a = " + b"[" * 10_000])
def test_what_is_no_toml_is_refused(engineer, content):
    answer = engineer.post("/devices/guide", content=content)
    assert (answer.status_code, answer.json()["code"]) == (422, "device_refused")


def test_a_guide_is_no_carm(engineer, device_files):
    answer = engineer.post("/devices/carm", content=device_files["guide"])
    assert (answer.status_code, answer.json()["code"]) == (422, "device_refused")
