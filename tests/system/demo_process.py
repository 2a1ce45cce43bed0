"""`coaxial demo` as a process, its output in files."""

import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx

_COAXIAL = str(Path(sys.executable).with_name("coaxial"))
_UP = re.compile(r"service (http://\S+), room (http://\S+), arm (\S+)")


class Demo:
    """A running demonstration with its output in files."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self._folder = folder
        self.data = folder / "data"
        command = [_COAXIAL, "demo", "--data", str(self.data), *arguments]
        with (folder / "out").open("wb") as out, (folder / "err").open("wb") as err:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=err)

    @property
    def out(self) -> str:
        return (self._folder / "out").read_text()

    @property
    def err(self) -> str:
        return (self._folder / "err").read_text()

    def wait_for(self, pattern: str, within_s: float = 120.0) -> re.Match:
        end_s = time.monotonic() + within_s
        while (found := re.search(pattern, self.out)) is None:
            assert self.process.poll() is None, self.out + self.err
            assert time.monotonic() < end_s, self.out + self.err
            time.sleep(0.05)
        return found

    def children(self) -> dict[str, int]:
        """Ids of what it started, by the subcommand."""
        ids = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        commands = {one: Path(f"/proc/{one}/cmdline").read_bytes().split(b"\0") for one in ids}
        return {words[2].decode(): int(one) for one, words in commands.items() if len(words) > 2}

    def end(self, number: signal.Signals, within_s: float = 60.0) -> int:
        self.process.send_signal(number)
        return self.process.wait(within_s)


def coaxial(*arguments: object) -> str:
    """What a command of the program says on standard output; it succeeds."""
    done = subprocess.run([_COAXIAL, *map(str, arguments)], capture_output=True, text=True, timeout=180)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@contextmanager
def running_demo(folder: Path, *arguments: str) -> Iterator[Demo]:
    """A demonstration that is over at the end of the context."""
    demo = Demo(folder, *arguments)
    try:
        yield demo
    finally:
        if demo.process.poll() is None:
            demo.end(signal.SIGTERM)


def nothing_answers(demo: Demo) -> bool:
    """Whether service and room are gone, by their addresses."""
    service, room, arm = _UP.search(demo.out).groups()
    for url in (service, room, f"http://{arm}:29999"):
        try:
            httpx.get(url, timeout=2, trust_env=False)
        except httpx.ConnectError:
            continue
        except httpx.HTTPError:
            return False
        return False
    return True
