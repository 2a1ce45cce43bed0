"""nginx in front of a service, as the engineer's manual sets it up: only names, ports and folders are a test's own."""

import re
import socket
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from tests.certificates import Certificate
from tests.waiting import until

_MANUAL = Path(__file__).parents[2] / "docs" / "engineers-manual.md"
_KEPT_BY_NGINX = ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")


@dataclass(frozen=True, slots=True)
class Proxy:
    """The proxy's process and where it listens."""

    process: "subprocess.Popen[bytes]"
    port: int
    authority: Path

    @property
    def url(self) -> str:
        return f"https://localhost:{self.port}"

    @property
    def workers(self) -> list[int]:
        """The processes that hold the connections."""
        return [
            int(one) for one in Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        ]


@contextmanager
def proxied(service_url: str, certificate: Certificate, folder: Path) -> Iterator[Proxy]:
    """A proxy before this service while the context lasts."""
    port = _free_port()
    file = folder / "nginx.conf"
    file.write_text(_configuration(service_url, port, certificate, folder))
    with subprocess.Popen(["nginx", "-e", folder / "error.log", "-c", file, "-g", "daemon off;"]) as process:
        try:
            until(lambda: _listens(port), seen=lambda: (folder / "error.log").read_text())
            yield Proxy(process, port, certificate.file)
        finally:
            process.terminate()


def _configuration(service_url: str, port: int, certificate: Certificate, folder: Path) -> str:
    site = "".join(re.findall(r"^    (server \{.*?^    map .*?)$", _MANUAL.read_text(), re.DOTALL | re.MULTILINE))
    ours = {
        "listen 443 ssl": f"listen 127.0.0.1:{port} ssl",
        "room-1.hospital.example": "localhost",
        "/etc/ssl/room-1.pem": str(certificate.file),
        "/etc/ssl/private/room-1.key": str(certificate.key_file),
        "http://127.0.0.1:8700": service_url,
    }
    for manual, test in ours.items():
        assert site.count(manual) == 1, manual
        site = site.replace(manual, test)
    folders = "".join(f"{name}_temp_path {folder / name};\n" for name in _KEPT_BY_NGINX)
    return f"pid {folder / 'nginx.pid'};\nevents {{}}\nhttp {{\naccess_log off;\n{folders}{site}\n}}\n"


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


def _listens(port: int) -> bool:
    with socket.socket() as asking:
        return asking.connect_ex(("127.0.0.1", port)) == 0
