"""Of which state of the code a result is: a fingerprint of the files that its trials come to by imports."""

import ast
import subprocess
from collections.abc import Iterable, Iterator
from functools import cache
from hashlib import sha256
from pathlib import Path

ROOT = Path(__file__).parents[2]
_LIBRARIES = "requirements.lock"
_DIGITS = 10
_DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def fingerprint(modules: Iterable[str], patterns: Iterable[str] = (), root: Path = ROOT) -> str:
    """Of everything of the project that the modules import, of other files by pattern, and of the libraries' versions.

    A module that is started as a process, or found by an entry point, is imported by nobody: it must be named.
    Comments, docstrings and layout do not count: no trial runs them.
    """
    others = (file for pattern in (*patterns, _LIBRARIES) for file in root.glob(pattern))
    digest = sha256()
    for file in sorted({*imported(modules, root), *others}):
        content = _statements(file.read_bytes()) if file.suffix == ".py" else file.read_bytes()
        digest.update(f"{file.relative_to(root)}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()[:_DIGITS]


def imported(modules: Iterable[str], root: Path = ROOT) -> set[Path]:
    """The files of these modules, of what they import, and so on; also where a function imports it."""
    todo, found = [file for module in modules for file in _files(module, root)], set[Path]()
    while todo:
        file = todo.pop()
        if file not in found:
            found.add(file)
            todo += [other for name in _names(file.read_bytes()) for other in _files(name, root)]
    return found


def _files(name: str, root: Path) -> Iterator[Path]:
    """The file of a module and of the packages around it; nothing of a library's, or of a name inside a module."""
    parts = name.split(".")
    for place in (root, root / "service" / "python_client"):
        for length in range(1, len(parts) + 1):
            stem = place.joinpath(*parts[:length])
            yield from (file for file in (stem.with_suffix(".py"), stem / "__init__.py") if file.is_file())


@cache
def _names(source: bytes) -> tuple[str, ...]:
    names = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, "imports of this project are absolute"
            names += [str(node.module), *(f"{node.module}.{alias.name}" for alias in node.names)]
    return tuple(names)


@cache
def _statements(source: bytes) -> bytes:
    """A module without what is only read by people."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, _DOCUMENTED) and ast.get_docstring(node, clean=False) is not None:
            node.body = node.body[1:] or [ast.Pass()]
    return ast.unparse(tree).encode()


def commit() -> str:
    """The commit that is checked out; `+` where files differ from it, empty where there is no repository."""
    described = ["git", "describe", "--always", "--exclude=*", "--dirty=+"]
    return subprocess.run(described, cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()
