"""Where a formula module can be mutated: each numeric constant, operator, square root, minimum and maximum, once."""

from __future__ import annotations

import ast
import copy
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from bridge_theory.catalog import FORMULAS

_SWAPPED: dict[type[ast.AST], type[ast.AST]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.LtE: ast.Gt,
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
}
_SIGNS = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**", ast.LtE: "<=", ast.Lt: "<",
    ast.GtE: ">=", ast.Gt: ">", ast.Eq: "==", ast.NotEq: "!=",
}  # fmt: skip
_RENAMED = {"min": "max", "max": "min", "least": "total"}
_VALUE_KEYWORDS = {"trivial", "failure"}
"""Of a decorator's arguments only these enter a value; titles, words and directions do not."""


Functions = tuple[tuple[int, str], ...]
"""First line and name of each enclosing function, outermost first."""


@dataclass(frozen=True)
class Site:
    """One place of one module and what is done to it; ``functions`` are the enclosing ones, outermost first."""

    module: str
    path: Path
    line: int
    column: int
    change: str
    number: int
    functions: Functions

    def __str__(self) -> str:
        return f"{self.module}:{self.line}:{self.column + 1} {self.change}"


def formula_modules() -> tuple[str, ...]:
    """The modules in which formulas are written."""
    return tuple(sorted({formula.function.__module__ for formula in FORMULAS.values()}))


def sites(module: str) -> tuple[Site, ...]:
    """All sites of one module, in the order of its text."""
    path = Path(str(sys.modules[module].__file__))
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return tuple(
        Site(module, path, node.lineno, node.col_offset, change, number, functions)
        for number, (node, change, functions) in enumerate(_walk(tree, ()))
    )


def mutated(site: Site) -> ast.Module:
    """The module's syntax tree with the one change made; positions stay as they were."""
    tree = ast.parse(site.path.read_text(encoding="utf-8"))
    node = next(node for number, (node, _, _) in enumerate(_walk(tree, ())) if number == site.number)
    _change(node)
    return tree


def _walk(node: ast.AST, functions: Functions) -> Iterator[tuple[ast.expr, str, Functions]]:
    """Every node that can be changed, with its change and the functions around it."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return  # a docstring
    if isinstance(node, ast.FunctionDef):
        arguments = [keyword for part in node.decorator_list for keyword in getattr(part, "keywords", ())]
        for keyword in arguments:
            if keyword.arg in _VALUE_KEYWORDS:
                yield from _walk(keyword.value, functions)
        first = min([node.lineno, *(part.lineno for part in node.decorator_list)])
        inside = (*functions, (first, node.name))
        for statement in node.body:
            yield from _walk(statement, inside)
        return
    if isinstance(node, ast.Lambda):
        functions = (*functions, (node.lineno, "<lambda>"))
    if isinstance(node, ast.expr) and (change := _described(node)):
        yield node, change, functions
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, ast.arguments):
            yield from _walk(child, functions)


def _described(node: ast.expr) -> str:
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
        return f"{node.value} -> {node.value + 1}"
    operator = _operator(node)
    if operator is not None and type(operator) in _SWAPPED:
        return f"{_SIGNS[type(operator)]} -> {_SIGNS[_SWAPPED[type(operator)]]}"
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return "-x -> x"
    name = _called(node)
    if name == "sqrt":
        return "sqrt(x) -> x"
    return f"{name} -> {_RENAMED[name]}" if name in _RENAMED else ""


def _change(node: ast.expr) -> None:
    if isinstance(node, ast.Constant):
        node.value = node.value + 1  # type: ignore[operator]
    elif isinstance(node, ast.BinOp):
        node.op = _SWAPPED[type(node.op)]()  # type: ignore[assignment]
    elif isinstance(node, ast.Compare):
        node.ops = [_SWAPPED[type(node.ops[0])](), *node.ops[1:]]  # type: ignore[list-item]
    elif isinstance(node, ast.UnaryOp):
        node.op = ast.UAdd()
    elif isinstance(node, ast.Call):
        name = _called(node)
        if name == "sqrt":
            # x ** 1: the same node, so that the tree keeps its shape and its positions
            node.func = ast.copy_location(ast.Name("pow", ast.Load()), node.func)
            node.args = [*node.args, ast.copy_location(ast.Constant(1), node)]
        elif isinstance(node.func, ast.Attribute):
            node.func.attr = _RENAMED[name]
        elif isinstance(node.func, ast.Name):
            node.func = copy.copy(node.func)
            node.func.id = _RENAMED[name]


def _operator(node: ast.expr) -> ast.AST | None:
    if isinstance(node, ast.BinOp):
        return node.op
    return node.ops[0] if isinstance(node, ast.Compare) else None


def _called(node: ast.expr) -> str:
    if not isinstance(node, ast.Call):
        return ""
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
