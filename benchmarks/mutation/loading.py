"""How a changed module comes into an interpreter: instead of the file's text, or function by function."""

import gc
import importlib
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from types import CodeType, FunctionType, ModuleType

from benchmarks.mutation.forks import Outcome, Status
from benchmarks.mutation.mutants import ROOT, Mutant, source_of

Functions = dict[CodeType, list[FunctionType]]


class _ChangedLoader(SourceFileLoader):
    def __init__(self, module: str, path: str, code: CodeType) -> None:
        super().__init__(module, path)
        self._code = code

    def get_code(self, fullname: str) -> CodeType:  # noqa: ARG002  # as the import system calls it
        return self._code


class _ChangedFinder(MetaPathFinder):
    def __init__(self, mutant: Mutant) -> None:
        self._module, self._code = mutant.module, mutant.code()

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,  # noqa: ARG002  # as the import system calls it
        target: ModuleType | None = None,  # noqa: ARG002
    ) -> ModuleSpec | None:
        if fullname != self._module:
            return None
        file = str(source_of(fullname))
        return spec_from_file_location(fullname, file, loader=_ChangedLoader(fullname, file, self._code))


def load_changed(mutant: Mutant) -> Outcome | None:
    """Import the module as changed, before anything else has; the outcome, if that is already one."""
    sys.meta_path.insert(0, _ChangedFinder(mutant))
    try:
        importlib.import_module(mutant.module)
    except (TypeError, NameError, AttributeError, SyntaxError) as error:
        return Outcome(Status.STILLBORN, type(error).__name__)
    except Exception as error:  # noqa: BLE001  # whatever the rules' own checks raise where they are loaded
        return Outcome(Status.KILLED, f"its import: {type(error).__name__}")
    return None


def forget_own_modules() -> None:
    """Everything of this project is imported anew from here on, and nothing else."""
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None) or ""
        if file.startswith(f"{ROOT}/") and not name.startswith(("benchmarks", "__")):
            del sys.modules[name]


def functions_by_code() -> Functions:
    """Every function of this project that this interpreter holds."""
    found: Functions = defaultdict(list)
    for thing in gc.get_objects():
        if isinstance(thing, FunctionType) and thing.__code__.co_filename.startswith(f"{ROOT}/"):
            found[thing.__code__].append(thing)
    return found


def change_in_place(mutant: Mutant, functions: Functions) -> bool:
    """Give the functions that hold the change their new bodies; False where that cannot be."""
    file = source_of(mutant.module)
    before = list(_codes(compile(file.read_text(), str(file), "exec")))
    after = list(_codes(mutant.code()))
    if [code.co_qualname for code in before] != [code.co_qualname for code in after]:
        return False
    changed = [(old, new) for old, new in zip(before[1:], after[1:], strict=True) if old != new]
    held = [(function, new) for old, new in changed for function in functions.get(old, [])]
    if not held or any(len(function.__closure__ or ()) != len(new.co_freevars) for function, new in held):
        return False
    for function, new in held:
        function.__code__ = new
    return True


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)
