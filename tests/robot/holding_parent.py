"""A service that holds a motion: run as a process, so that a test can kill or pause it.

Prints the guard's process id once the arm runs; every line it reads ends it.
"""

import sys
import threading
import time
from itertools import count
from pathlib import Path

import numpy as np

from robot.guard.client import GuardClient, GuardConfig
from robot.guard.messages import BeginMove, Event, Heartbeat, MotionStarted, Status


def main(address: str, journal_folder: str) -> None:
    started = threading.Event()

    def hear(event: Event) -> None:
        if isinstance(event, MotionStarted):
            started.set()

    client = GuardClient(GuardConfig(address, Path(journal_folder)), hear)
    client.start()
    while client.status is None or not client.status.connected:
        time.sleep(0.01)
    client.acknowledge()
    threading.Thread(target=beat, args=(client,), daemon=True).start()
    while client.status.heartbeat_age_s is None:
        time.sleep(0.01)
    client.begin_move(order(client.status))
    assert started.wait(5.0)
    print(client.process_id, flush=True)
    sys.stdin.readline()
    client.close()


def beat(client: GuardClient) -> None:
    for number in count(1):
        if client.status is not None:
            client.heartbeat(Heartbeat("permit-1", number, client.status.challenge, held=True))
        time.sleep(0.05)


def order(status: Status) -> BeginMove:
    assert status.arm is not None
    goal = status.arm.base_from_tcp.copy()
    goal[2, 3] += 60.0
    centre_mm = np.array([0.0, 0.0, 50.0])
    return BeginMove(
        "permit-1", goal, status.arm.joints_rad, 20.0, 50.0, 3.4, np.eye(4), 1.0, centre_mm, 0.05, 3e-4, 0.05, 5.0
    )


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
