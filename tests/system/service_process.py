"""`coaxial serve` as a process, and a client of one of its users."""

import os
import signal
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

from coaxial_client import Coaxial

PASSWORD, PIN = "correct horse", "2468"
_COAXIAL = [sys.executable, "-c", "from service.cli.main import main; main()"]
_SECRETS = {"COAXIAL_PASSWORD": PASSWORD, "COAXIAL_PIN": PIN}


@dataclass
class Service:
    """`coaxial serve` on a data folder that outlives it."""

    folder: Path
    arm_address: str | None
    database_url: str
    more: dict[str, str] = field(default_factory=dict)  # environment
    process: "subprocess.Popen[str]" = field(init=False)
    url: str = field(init=False)

    def start(self) -> None:
        """Start, and wait for the address."""
        environment = self.environment()
        with (self.folder / "log").open("a") as log:
            self.process = subprocess.Popen(
                [*_COAXIAL, "serve"], env=environment, stdout=subprocess.PIPE, stderr=log, text=True
            )
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().removeprefix("Coaxial listens on ").strip()
        assert self.url, (self.folder / "log").read_text()

    def kill(self) -> None:
        """As a power switch would."""
        self.process.send_signal(signal.SIGKILL)
        self._wait(10)

    def end(self) -> None:
        """As an operator would."""
        self.process.terminate()
        self._wait(20)

    def _wait(self, timeout_s: float) -> None:
        self.process.wait(timeout_s)
        assert self.process.stdout is not None
        self.process.stdout.close()

    def environment(self) -> dict[str, str]:
        """Free ports; nothing of the caller's own settings."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith("COAXIAL_")}
        ours = {"COAXIAL_DATA_FOLDER": str(self.folder), "COAXIAL_DATABASE_URL": self.database_url}
        ours |= {"COAXIAL_HTTP__PORT": "0", "COAXIAL_DICOM__PORT": "0"}
        ours |= {"COAXIAL_DICOM__ACCEPTED_CALLERS": '["CARM"]'}
        arm = {} if self.arm_address is None else {"COAXIAL_ARM_ADDRESS": self.arm_address}
        # the tests bring the guide off its target by displacing it in the image, as a coarse arm would
        coarse = {"COAXIAL_ARM_ACCURACY__POSITION_SD_MM": "2.0"}
        patient = {"COAXIAL_MIN_FREE_BYTES": "0", "COAXIAL_VISION__DEADLINE_S": "90"}
        return kept | ours | arm | coarse | patient | self.more | _SECRETS

    def run(self, *arguments: str) -> "subprocess.CompletedProcess[str]":
        """Another `coaxial` command on the same folder."""
        return subprocess.run(
            [*_COAXIAL, *arguments], env=self.environment(), capture_output=True, text=True, timeout=60
        )

    def log(self) -> str:
        """What the service said."""
        return (self.folder / "log").read_text()

    def sign_in(self, name: str = "surgeon") -> Coaxial:
        """A client of this user."""
        client = Coaxial(self.url)
        client.sign_in(name, PASSWORD)
        return client
