"""What is installed: the wheel holds every package, and what is no Python in them."""

import subprocess
import zipfile
from collections.abc import Set
from pathlib import Path

import pytest
from hatchling.builders.wheel import WheelBuilder

_ROOT = Path(__file__).parents[1]
_CLIENT = "service/python_client/"
_PACKAGES = ("service", "workflow", "vision", "robot", "simulator", "migrations")


@pytest.fixture(scope="module")
def held(tmp_path_factory) -> Set[str]:
    folder = tmp_path_factory.mktemp("wheel")
    (wheel,) = WheelBuilder(str(_ROOT)).build(directory=str(folder), versions=["standard"])
    with zipfile.ZipFile(wheel) as file:
        names = file.namelist()
    assert len(names) == len(set(names))
    return set(names)


def test_the_wheel_holds_every_file_of_every_package(held) -> None:
    listed = subprocess.run(["git", "ls-files", *_PACKAGES], cwd=_ROOT, capture_output=True, text=True, check=True)
    assert {name.removeprefix(_CLIENT) for name in listed.stdout.splitlines()} - held == set()


def test_the_python_client_is_a_package_of_its_own_and_tells_its_types(held) -> None:
    assert {"coaxial_client/__init__.py", "coaxial_client/py.typed"} <= held
    assert not any(name.startswith(_CLIENT) for name in held)
