"""What is changed, and which tests should notice."""

from dataclasses import dataclass
from functools import cache
from hashlib import sha256

from benchmarks.mutation.mutants import ROOT, source_of


@dataclass(frozen=True, slots=True)
class Package:
    """Modules and their tests; what keeps real time is not among these."""

    name: str
    what: str
    modules: tuple[str, ...]
    tests: str
    left_out: tuple[str, ...] = ()  # how their names begin

    @property
    def options(self) -> list[str]:
        """Of pytest, to find the tests; time says nothing where the processors are shared."""
        deselected = [f"--deselect={name}" for name in self.left_out]
        return [self.tests, "-qq", "-m", "not real_time", "-o", "timeout=0", "-p", "no:cacheprovider", *deselected]


def _modules(folder: str) -> tuple[str, ...]:
    files = sorted((ROOT / folder).glob("*.py"))
    return tuple(f"{folder.replace('/', '.')}.{file.stem}" for file in files if not file.stem.startswith("__"))


PACKAGES = {
    package.name: package
    for package in (
        # Left out are the search of every reachable case, which takes half a minute, and what compares the table with
        # its own page, which any change of the table fails: what they alone would find counts as not found.
        Package(
            "workflow",
            "the rules",
            tuple(module for module in _modules("workflow") if module != "workflow.diagram"),
            "tests/workflow",
            ("tests/workflow/test_reachable.py", "tests/workflow/test_diagram.py"),
        ),
        Package(
            "diagram", "the picture and the page of the rules", ("workflow.diagram",), "tests/workflow/test_diagram.py"
        ),
        Package("guard", "the guard", _modules("robot/guard"), "tests/robot"),
        Package(
            "path",
            "the checks of a path, before anybody approves it",
            tuple(
                f"robot.{name}" for name in ("caps", "line", "path", "path_checks", "path_limits", "safety", "sweep")
            ),
            "tests/robot",
        ),
    )
}


@cache
def digest_of_module(module: str) -> str:
    """Another one where its text is another; that of a module which changes amid a run stays what it was."""
    return sha256(source_of(module).read_bytes()).hexdigest()[:12]


def digest_of_tests(package: Package) -> str:
    """Another one where any of its tests is another."""
    place = ROOT / package.tests
    whole = sha256()
    for file in sorted(place.glob("*.py")) if place.is_dir() else [place]:
        whole.update(file.read_bytes())
    return whole.hexdigest()[:12]
