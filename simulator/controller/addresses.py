"""Loopback addresses for controllers, whose three ports are fixed."""

import random
import socket

DASHBOARD_PORT = 29999
SCRIPT_PORT = 30003
RTDE_PORT = 30004
PORTS = (DASHBOARD_PORT, SCRIPT_PORT, RTDE_PORT)


def free_loopback_address() -> str:
    """An address in 127.0.0.0/16 whose three controller ports are free, and which nobody else is given meanwhile.

    It is this process's own until it ends, so that tests may run side by side.

    Raises
    ------
    RuntimeError
        If none of a hundred drawn addresses is free.
    """
    drawn = random.SystemRandom()
    for _ in range(100):
        address = f"127.0.{drawn.randint(1, 254)}.{drawn.randint(2, 254)}"
        if _reserve(address) and all(_is_free(address, port) for port in PORTS):
            return address
    raise RuntimeError("no free loopback address for a controller")


def _reserve(address: str) -> bool:
    """Keep the address to this process, by a datagram port that nothing else uses; False if another one has it."""
    mark = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        mark.bind((address, RTDE_PORT))
    except OSError:
        mark.close()
        return False
    mark.detach()  # stays open until the process ends
    return True


def _is_free(address: str, port: int) -> bool:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((address, port))
        except OSError:
            return False
    return True
