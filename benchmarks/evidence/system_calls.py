"""The system calls by which a process changes a folder: recorded, made to fail, or the last thing it does (strace)."""

import multiprocessing
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.evidence import whole_case

# Whatever changes a file or makes a change durable.
WRITING = ("pwrite64", "write", "ftruncate", "fdatasync", "fsync", "rename", "unlink")
_VICTIM = [sys.executable, "-m", whole_case.__name__]
_VICTIMS = multiprocessing.get_context("forkserver")
_VICTIMS.set_forkserver_preload([whole_case.__name__])
_CALL = re.compile(r"\d+ +(\w+)\((.*)\) += (-?\d+)", re.DOTALL)
_DESCRIPTOR = re.compile(r"(\w+)<([^>]*)>")
_TIMEOUT_S = 300.0


@dataclass(frozen=True, slots=True)
class Call:
    """One call that succeeded."""

    name: str
    path: str  # inside the folder; `stdout` for what was acknowledged
    data: bytes = b""
    number: int = 0  # offset of a write, size of a truncation
    to: str = ""  # of a rename


def strace() -> str:
    """The program; AssertionError tells what to install."""
    program = shutil.which("strace")
    assert program, "missing Debian package: apt-get install strace"
    return program


def recorded(folder: Path, pragmas: Sequence[str] = ()) -> list[Call]:
    """What a whole case does to its prepared folder, in order."""
    trace = folder.parent / f"{folder.name}.trace"
    options = [
        "-f",
        "--seccomp-bpf",
        "-y",
        "-xx",
        "-s",
        "100000000",
        "-e",
        f"trace={','.join((*WRITING, 'openat'))}",
        "-o",
        str(trace),
    ]
    _run([strace(), *options, *_VICTIM, str(folder), *pragmas], check=True)
    with trace.open() as lines:
        calls = [call for line in lines if (call := _parsed(line, str(folder)))]
    trace.unlink()
    return calls


def untroubled(folder: Path) -> None:
    """The whole case, recorded in its prepared folder."""
    _run([*_VICTIM, str(folder)], check=True)


@dataclass(frozen=True, slots=True)
class Ran:
    """What came of a process: its exit status, negative for a signal, and what it wrote."""

    status: int
    said: str
    errors: str
    met: bool  # by the fault: a call that is never made proves nothing


def with_fault(folder: Path, fault: str, met: Mapping[str, str]) -> Ran:
    """The whole case, calls on the database's files being met by a fault (`error=EIO`...): which one of each name.

    The process is a copy of one that has loaded everything, and begins once it is traced.
    """
    files = [str(folder / f"coaxial.sqlite{end}") for end in ("", "-wal", "-shm")]
    of_them = [part for file in files for part in ("-P", file)]
    inject = ["-e", f"trace={','.join(met)}"]
    inject += [part for name, when in met.items() for part in ("-e", f"inject={name}:{fault}:when={when}")]
    trace, said, errors = (folder.parent / f"{folder.name}.{end}" for end in ("faults", "said", "errors"))
    victim = _VICTIMS.Process(target=whole_case.record_once_traced, args=(folder, said, errors))
    victim.start()
    try:
        _run([strace(), "-f", *of_them, *inject, "-o", str(trace), "-p", str(victim.pid)], check=False)
        victim.join(_TIMEOUT_S)
    finally:
        victim.kill()  # one that nobody traces waits for ever
    assert victim.exitcode is not None, f"still recording after {_TIMEOUT_S} s"
    came = any(mark in trace.read_text() for mark in ("(INJECTED)", "killed by SIGKILL"))
    return Ran(victim.exitcode, said.read_text(), errors.read_text(), came)


def _run(command: Sequence[str], *, check: bool) -> "subprocess.CompletedProcess[str]":
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(command, env=environment, check=check, capture_output=True, text=True, timeout=_TIMEOUT_S)


def _parsed(line: str, folder: str) -> Call | None:
    """A call on the folder or on standard output that succeeded; strings in a trace are hexadecimal."""
    assert "unfinished" not in line, "calls of two threads are mixed: their order is not known"
    found = _CALL.match(line)
    if found is None or int(found[3]) < 0:
        return None
    name, arguments = found[1], found[2]
    if name in ("rename", "unlink", "openat"):
        return _of_names(name, arguments, folder)
    described = _DESCRIPTOR.match(arguments)
    if described is None:
        return None
    path = "stdout" if described[1] == "1" else _inside(_plain(described[2]).decode(), folder)
    return None if path is None else _of_descriptor(name, path, arguments[described.end() :])


def _of_names(name: str, arguments: str, folder: str) -> Call | None:
    if name == "openat" and "O_CREAT" not in arguments:
        return None
    names = [_plain(text).decode() for text in re.findall(r'"([^"]*)"', arguments)]
    inside = [_inside(text, folder) for text in names]
    if inside[0] is None:
        return None
    return Call(name, inside[0], to=inside[1] or "" if len(inside) > 1 else "")


def _of_descriptor(name: str, path: str, rest: str) -> Call:
    match name:
        case "pwrite64":
            data, _, numbers = rest.removeprefix(', "').partition('", ')
            return Call(name, path, _plain(data), int(numbers.split(", ")[1]))
        case "write":
            return Call(name, path, _plain(rest.removeprefix(', "').partition('", ')[0]))
        case "ftruncate":
            return Call(name, path, number=int(rest.removeprefix(", ")))
        case _:
            return Call(name, path)


def _inside(path: str, folder: str) -> str | None:
    """Relative to the folder, which is itself the empty name; None elsewhere."""
    if path == folder:
        return ""
    return path.removeprefix(f"{folder}/") if path.startswith(f"{folder}/") else None


def _plain(text: str) -> bytes:
    return bytes.fromhex(text.replace("\\x", ""))
