"""The people of a run, with secrets drawn anew each time."""

import secrets
import subprocess
from dataclasses import dataclass
from pathlib import Path

from simulator.demo.child import clean_environment, coaxial
from simulator.demo.failure import DemoFailed

ROLES = ("surgeon", "operator", "engineer")


@dataclass(frozen=True, slots=True)
class Person:
    """Who signs in; the name is the role."""

    name: str
    password: str
    pin: str


def draw_people() -> dict[str, Person]:
    """One person of each role, by role."""
    return {role: Person(role, secrets.token_urlsafe(9), f"{secrets.randbelow(10**6):06d}") for role in ROLES}


def add_person(person: Person, settings: Path) -> None:
    """By `coaxial user add`, on the machine itself, as the first users of a room are made; DemoFailed."""
    command = coaxial("user", "add", person.name, "--role", person.name, "--config", str(settings))
    secret = {"COAXIAL_PASSWORD": person.password, "COAXIAL_PIN": person.pin}
    done = subprocess.run(  # noqa: S603  our own command
        command, env=clean_environment(**secret), capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise DemoFailed("user_not_added", (done.stderr or done.stdout).strip())
