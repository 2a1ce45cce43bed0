"""What a single change of the code may be: another comparison, another constant, a statement left out, and so on.

Prose is not code: strings stay as they are, and so do annotations, decorators and docstrings.
"""

import ast
from collections.abc import Iterator, Sequence
from typing import TypeVar

_Node = TypeVar("_Node")

_COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),  # the edge, and the opposite
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
_ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
    ast.BitOr: ast.BitAnd,
    ast.BitAnd: ast.BitOr,
    ast.BitXor: ast.BitOr,
}


def replacements(node: ast.AST) -> Iterator[ast.AST]:
    """Everything that may stand in the place of a node."""
    match node:
        case ast.Compare():
            yield from _comparisons(node)
        case ast.BoolOp(op, values):
            yield ast.BoolOp(ast.Or() if isinstance(op, ast.And) else ast.And(), values)
        case ast.UnaryOp(ast.Not() | ast.USub(), operand):
            yield operand
        case ast.BinOp(left, ast.MatMult(), right):
            yield ast.BinOp(right, ast.MatMult(), left)
        case ast.BinOp(left, op, right):
            yield ast.BinOp(left, _ARITHMETIC[type(op)](), right)
        case ast.Constant(value):
            yield from (ast.Constant(other) for other in _constants(value))
        case ast.IfExp(test, body, orelse):
            yield from (ast.IfExp(ast.Constant(always), body, orelse) for always in _ways(test))
        case ast.comprehension(target, iterated, [_, *_]):
            yield ast.comprehension(target, iterated, [], node.is_async)
        case ast.ExceptHandler(_, name, body):
            yield ast.ExceptHandler(ast.Tuple([], ast.Load()), name, body)  # catches nothing
        case ast.stmt():
            yield from _statements(node)


def entries_left_out(node: ast.AST) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Each entry of a table, and the table without it."""
    match node:
        case ast.Tuple(elts, ast.Load()) | ast.List(elts, ast.Load()):
            for place, entry in enumerate(elts):
                yield entry, type(node)(_without(elts, place), ast.Load())
        case ast.Set([_, _, *_] as elts):
            for place, entry in enumerate(elts):
                yield entry, ast.Set(_without(elts, place))
        case ast.Dict(keys, values):
            for place, key in enumerate(keys):
                yield key or values[place], ast.Dict(_without(keys, place), _without(values, place))


def _without(items: Sequence[_Node], place: int) -> list[_Node]:
    return [*items[:place], *items[place + 1 :]]


def _comparisons(node: ast.Compare) -> Iterator[ast.Compare]:
    for place, op in enumerate(node.ops):
        for other in _COMPARISONS[type(op)]:
            yield ast.Compare(node.left, [*node.ops[:place], other(), *node.ops[place + 1 :]], node.comparators)


def _constants(value: object) -> tuple[bool | int | float, ...]:
    """True for false, the next whole number, twice the size."""
    match value:
        case bool():
            return (not value,)
        case int():
            return (value + 1,)
        case float():
            return (2.0 * value or 1.0,)
        case _:
            return ()


def _ways(test: ast.expr) -> tuple[bool, ...]:
    return () if isinstance(test, ast.Constant) else (True, False)


def _statements(node: ast.stmt) -> Iterator[ast.stmt]:
    match node:
        case ast.If(test, body, orelse):
            yield from (ast.If(ast.Constant(always), body, orelse) for always in _ways(test))
        case ast.While(test, body, orelse) if _ways(test):
            yield ast.While(ast.Constant(False), body, orelse)
        case ast.Return(value) if value is not None and not _is_none(value):
            yield ast.Return(ast.Constant(None))
        case ast.Raise(ast.Call(_, arguments, keywords), cause):
            yield ast.Raise(ast.Call(ast.Name("Exception", ast.Load()), arguments, keywords), cause)
            yield ast.Pass()
        case ast.Raise() | ast.Continue() | ast.Break() | ast.AugAssign():
            yield ast.Pass()
        case ast.Expr(ast.Call() | ast.Yield() | ast.YieldFrom() | ast.Await()):
            yield ast.Pass()
        case ast.Assign(targets) if not all(isinstance(target, ast.Name) for target in targets):
            yield ast.Pass()


def _is_none(value: ast.expr) -> bool:
    return isinstance(value, ast.Constant) and value.value is None
