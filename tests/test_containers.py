"""docker-compose.yml and the Dockerfile say what the program understands; no engine runs here to try them."""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from service.app import create_app
from service.cli.main import LazyCommands
from service.settings import Settings, load_settings

_ROOT = Path(__file__).parent.parent
_DOCKERFILE = (_ROOT / "service" / "Dockerfile").read_text()
_COMPOSE: dict[str, Any] = yaml.safe_load((_ROOT / "docker-compose.yml").read_text())
_OURS = {name: one for name, one in _COMPOSE["services"].items() if one["image"].startswith("coaxial:")}
# `${NAME:-default}` and `${NAME:?what to do}`, as the compose file format has them
_VARIABLE = re.compile(r"\$\{(\w+):([-?])([^}]*)\}")


def _filled_in(value: object) -> str:
    """A value as an engine would fill it in: the default, or something where one must be chosen."""
    return _VARIABLE.sub(lambda found: found[3] if found[2] == "-" else "chosen", str(value))


def _settings(name: str, monkeypatch: pytest.MonkeyPatch) -> Settings:
    for key, value in _OURS[name].get("environment", {}).items():
        monkeypatch.setenv(key, _filled_in(value))
    return load_settings()


@pytest.mark.parametrize("name", _OURS)
def test_each_start_command_is_one_that_the_program_has(name):
    words = [str(word) for word in _OURS[name]["command"]]
    command = LazyCommands().get_command(None, words[0])
    context = command.make_context(words[0], words[1:])
    assert not context.args


def test_the_services_environment_is_settings_and_they_fit_together(monkeypatch):
    settings = _settings("service", monkeypatch)
    room, services = _OURS["room"], _COMPOSE["services"]
    assert settings.database_url.endswith("@postgresql/coaxial")
    assert services["postgresql"]["environment"]["POSTGRES_USER"] == "coaxial"
    assert settings.pacs.host in services
    assert settings.pacs.ae_title == services["orthanc"]["environment"]["ORTHANC__DICOM_AET"]
    assert settings.arm_address in room["command"]
    assert str(settings.dicom.port) in room["command"]
    assert {f"127.0.0.1:{port}:{port}" for port in (settings.http.port, settings.metrics.port)} == set(room["ports"])


def test_nothing_is_published_beyond_the_machine_and_no_password_is_written_down():
    published = [port for one in _COMPOSE["services"].values() for port in one.get("ports", ())]
    assert published
    assert all(port.startswith("127.0.0.1:") for port in published)
    secrets = [one["environment"][key] for one in _COMPOSE["services"].values() for key in one.get("environment", {})]
    passwords = [value for value in secrets if "PASSWORD" in str(value)]
    assert len(passwords) == 2
    assert all(_VARIABLE.fullmatch(value)[2] == "?" for value in passwords)


def test_every_container_of_ours_runs_read_only_without_rights_and_within_bounds():
    for name, one in _OURS.items():
        assert one["read_only"] is True, name
        assert one["cap_drop"] == ["ALL"], name
        assert "no-new-privileges:true" in one["security_opt"], name
        assert {"mem_limit", "cpus", "pids_limit"} <= one.keys(), name
        assert "privileged" not in one, name


def test_a_linter_of_compose_files_finds_nothing_grave():
    command = [sys.executable, "-m", "compose_lint", "check", "--format", "json", str(_ROOT / "docker-compose.yml")]
    told = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert told.returncode == 0, told.stdout
    rules = {one["rule_id"] for one in json.loads(told.stdout)["findings"] if one["service"] in _OURS}
    # Our own image has no digest before it is built.
    assert rules == {"CL-0019"}


def test_the_image_is_not_run_by_root_and_is_asked_whether_it_lives(tmp_path):
    lines = _DOCKERFILE.splitlines()
    user = lines.index("USER 10001")
    assert not [line for line in lines[user:] if line.startswith(("RUN", "COPY", "USER 0", "USER root"))]
    asked = re.search(r"HEALTHCHECK(.|\n)*?http://127\.0\.0\.1:8700(/\S+?)'", _DOCKERFILE)
    paths = create_app(Settings(data_folder=tmp_path)).openapi()["paths"]
    assert asked is not None
    assert asked[2] in paths


def test_the_image_can_back_up_the_database_beside_it():
    """pg_dump refuses a server that is newer than itself; Debian's releases each have one version."""
    (release,) = re.findall(r"^FROM python:\S+-(\w+)$", _DOCKERFILE, re.MULTILINE)
    (server,) = re.findall(r"postgres:(\d+)-", _COMPOSE["services"]["postgresql"]["image"])
    assert re.search(r"apt-get install .*\bpostgresql-client\b", _DOCKERFILE)
    assert int(server) <= {"bookworm": 15, "trixie": 17}[release]


def test_everything_that_the_image_copies_is_there_and_every_package_is_copied():
    copied = {word for line in _DOCKERFILE.splitlines() if line.startswith("COPY") for word in line.split()[1:-1]}
    assert all((_ROOT / one).exists() for one in copied)
    assert {"service", "workflow", "vision", "robot", "simulator", "migrations", "requirements.lock"} <= copied


def test_the_image_keeps_its_data_where_the_volume_is():
    folder = re.search(r"COAXIAL_DATA_FOLDER=(\S+)", _DOCKERFILE)
    assert folder is not None
    assert f"service-data:{folder[1]}" in _OURS["service"]["volumes"]
