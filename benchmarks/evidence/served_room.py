"""`coaxial serve` as a process over a simulated controller, with one person of each role and the device files."""

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TypeVar

import numpy as np

from simulator.controller import ControllerProcess, ControllerSettings, Payload, free_loopback_address
from tests.databases import SqliteFiles
from tests.system.conftest import add_users, upload_devices
from tests.system.service_process import Service

_ServiceT = TypeVar("_ServiceT", bound=Service)


def serve_room(
    opened: ExitStack, folder: Path, make: Callable[[Path, str, str], _ServiceT]
) -> tuple[_ServiceT, ControllerProcess]:
    """Both, ended with the block; the service's log and data lie in a folder below this one.

    `make` is given data folder, address of the arm and address of the database.
    """
    flange_from_tcp = np.eye(4)
    flange_from_tcp[2, 3] = 150.0
    settings = ControllerSettings(free_loopback_address(), flange_from_tcp=flange_from_tcp, payload=Payload())
    controller = opened.enter_context(ControllerProcess(settings))
    data = folder / "data"
    data.mkdir()
    service = make(data, controller.address, opened.enter_context(SqliteFiles(folder).migrated(data)))
    add_users(service.database_url)
    service.start()
    opened.callback(service.end)
    with service.sign_in() as client:
        upload_devices(client)
    return service, controller
