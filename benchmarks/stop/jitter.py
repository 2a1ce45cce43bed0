"""A network between tablet and service that delays what passes by up to 40 ms, each way, in order.

    python -m benchmarks.stop.jitter HOST PORT

Prints the port that it listens on, and ends with its input.
"""

import asyncio
import random
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from urllib.parse import urlsplit

DELAY_S = 0.04


async def _carry(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Pass on each piece at its own time; a piece waits for those before it."""
    due: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue()
    loop = asyncio.get_running_loop()

    async def deliver() -> None:
        while True:
            at_s, piece = await due.get()
            await asyncio.sleep(max(0.0, at_s - loop.time()))
            writer.write(piece)
            if not piece:
                writer.close()
                return

    delivering = asyncio.create_task(deliver())
    piece = b"."
    while piece:
        try:
            piece = await reader.read(65536)
        except OSError:
            piece = b""
        due.put_nowait((loop.time() + random.uniform(0.0, DELAY_S), piece))
    await delivering


@contextmanager
def jittering(url: str) -> Iterator[str]:
    """The address of a service as it is to be had through this network, in a process of its own."""
    address = urlsplit(url)
    command = [sys.executable, "-m", "benchmarks.stop.jitter", str(address.hostname), str(address.port)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        yield f"http://127.0.0.1:{int(process.stdout.readline())}"
        process.stdin.close()


async def main(host: str, port: int) -> None:
    """Carry every connection until the input ends."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        far_reader, far_writer = await asyncio.open_connection(host, port)
        # A connection that is open at the end is cancelled, which the server of Python 3.11 takes for a fault.
        with suppress(OSError, asyncio.CancelledError):
            await asyncio.gather(_carry(reader, far_writer), _carry(far_reader, writer))

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    print(server.sockets[0].getsockname()[1], flush=True)
    await asyncio.to_thread(sys.stdin.read)


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], int(sys.argv[2])))
