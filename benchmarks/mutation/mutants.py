"""Every single change of a module, in the order of its lines."""

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType
from typing import Any

from benchmarks.mutation.operators import entries_left_out, replacements

ROOT = Path(__file__).parents[2]
_LEFT_AS_THEY_ARE = ("annotation", "returns", "decorator_list", "type_params")


@dataclass(frozen=True, slots=True, eq=False)
class Mutant:
    """One change: `before` becomes `after`.

    Attributes
    ----------
    key : str
        The same as long as this part of the code is, wherever it stands in the file.
    place : str
        Module and function.
    lines : tuple of int
        All of what is changed.
    in_function : bool
        It stands in the body of one; else it runs when the module is imported.
    """

    key: str
    module: str
    place: str
    lines: tuple[int, ...]
    in_function: bool
    before: str
    after: str
    _tree: ast.Module
    _parent: ast.AST
    _field: str
    _index: int | None
    _new: ast.AST

    def code(self) -> CodeType:
        """The changed module, compiled; the tree stays changed, so this is for a process of its own."""
        if self._index is None:
            setattr(self._parent, self._field, self._new)
        else:
            getattr(self._parent, self._field)[self._index] = self._new
        return compile(ast.fix_missing_locations(self._tree), str(source_of(self.module)), "exec")


def source_of(module: str) -> Path:
    """Where a module's text is."""
    path = ROOT / module.replace(".", "/")
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def mutants_of(module: str) -> list[Mutant]:
    """Every change of one module."""
    tree = ast.parse(source_of(module).read_text())
    seen: Counter[str] = Counter()
    return [_mutant(module, tree, change, seen) for place in _places(tree, ()) for change in _changes(place)]


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    """A node and what it hangs on."""

    node: ast.AST
    parent: ast.AST
    field: str
    index: int | None
    scope: tuple[ast.AST, ...]

    @property
    def in_function(self) -> bool:
        """In the body of one, or among its defaults."""
        return any(isinstance(scope, ast.FunctionDef | ast.Lambda) for scope in self.scope)


@dataclass(frozen=True, slots=True, eq=False)
class _Change:
    """`new` takes the place of its node, which changes this part of it."""

    place: _Place
    new: ast.AST
    part: ast.AST
    after: str


def _changes(place: _Place) -> Iterator[_Change]:
    for new in replacements(place.node):
        if ast.dump(new) != ast.dump(place.node):
            yield _Change(place, new, place.node, _text(new))
    if not place.in_function and place.field not in ("slice", "type"):
        for entry, rest in entries_left_out(place.node):
            yield _Change(place, rest, entry, "left out")


def _mutant(module: str, tree: ast.Module, change: _Change, seen: Counter[str]) -> Mutant:
    place, before = change.place, _text(change.part)
    node: Any = change.part if hasattr(change.part, "lineno") else place.parent
    within = f"{module}:{'.'.join(getattr(scope, 'name', 'lambda') for scope in place.scope)}"
    key = f"{within}: {before} => {change.after}"
    seen[key] += 1
    return Mutant(
        key=f"{key} #{seen[key]}" if seen[key] > 1 else key,
        module=module,
        place=within,
        lines=tuple(range(node.lineno, _last_line(node) + 1)),
        in_function=place.in_function,
        before=before,
        after=change.after,
        _tree=tree,
        _parent=place.parent,
        _field=place.field,
        _index=place.index,
        _new=ast.copy_location(change.new, node),
    )


def _text(node: ast.AST) -> str:
    """On one line: of a statement with a body, its head."""
    return ast.unparse(node).strip().splitlines()[0]


def _last_line(node: Any) -> int:
    """Of a statement with a body, its head's."""
    body = getattr(node, "body", None)
    return max(node.lineno, body[0].lineno - 1) if isinstance(body, list) and body else int(node.end_lineno)


def _places(parent: ast.AST, scope: tuple[ast.AST, ...], *, subscript: bool = False) -> Iterator[_Place]:
    """A constant subscript stays: the next place of an array is mostly none, which every test notices."""
    inner = (*scope, parent) if isinstance(parent, ast.FunctionDef | ast.ClassDef | ast.Lambda) else scope
    for field, value in ast.iter_fields(parent):
        if field in _LEFT_AS_THEY_ARE:
            continue
        within = subscript or field == "slice"
        listed = list(enumerate(value)) if isinstance(value, list) else [(None, value)]
        for index, node in listed:
            if isinstance(node, ast.AST) and not _is_left_out(node, within):
                yield _Place(node, parent, field, index, inner)
                yield from _places(node, inner, subscript=within)


def _is_left_out(node: ast.AST, subscript: bool) -> bool:
    if isinstance(node, ast.If):
        return ast.unparse(node.test) == "__name__ == '__main__'"
    return subscript and isinstance(node, ast.Constant)
