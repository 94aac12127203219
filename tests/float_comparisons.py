"""Sees every comparison that a check makes: the modules of the checks run with each comparison routed through here."""

from __future__ import annotations

import ast
import contextlib
import importlib
import inspect
import operator
import pkgutil
from collections.abc import Callable, Iterator
from itertools import pairwise
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

PACKAGES = (
    "proofs_checks.offline.checks", "proofs_checks.online.checks", "proofs_checks.apparatus", "proofs_checks.exact",
    "proofs_checks.evaluators", "proofs_checks.counterexample", "proofs_checks.symbolic", "proofs_checks.smt",
)  # fmt: skip
_OPERATORS: dict[type[ast.cmpop], str] = {
    ast.Lt: "lt", ast.LtE: "le", ast.Gt: "gt", ast.GtE: "ge", ast.Eq: "eq", ast.NotEq: "ne",
}  # fmt: skip
_NAME = "__compared__"


@contextlib.contextmanager
def noted() -> Iterator[set[str]]:
    """While open, the set fills with the places where a floating-point number is compared."""
    places: set[str] = set()

    def compared(place: str, names: tuple[str, ...], *values: Any) -> Any:
        if any(map(is_float, values)):
            places.add(place)
        answer: Any = True
        for name, (left, right) in zip(names, pairwise(values), strict=True):
            answer = getattr(operator, name)(left, right)
            if len(names) > 1 and not answer:
                break
        return answer

    changed: list[tuple[FunctionType, CodeType]] = []
    for module in _modules():
        changed += _routed(module, compared)
    try:
        yield places
    finally:
        for function, code in changed:
            function.__code__ = code


def is_float(value: Any) -> bool:
    """A floating-point number of Python or NumPy, an array of them, or a list or tuple that holds one."""
    if isinstance(value, list | tuple):
        return any(map(is_float, value))
    return isinstance(value, float | np.floating) or (isinstance(value, np.ndarray) and value.dtype.kind == "f")


def _modules() -> Iterator[ModuleType]:
    for name in PACKAGES:
        module = importlib.import_module(name)
        yield module
        for part in pkgutil.iter_modules(getattr(module, "__path__", [])):
            yield importlib.import_module(f"{name}.{part.name}")


def _routed(module: ModuleType, compared: Callable[..., Any]) -> list[tuple[FunctionType, CodeType]]:
    """Give every function and method of the module the code of the routed source; return what to put back."""
    path = str(module.__file__)
    with open(path, encoding="utf-8") as file:
        tree = _Route(module.__name__).visit(ast.parse(file.read()))
    fresh = {(code.co_qualname, code.co_firstlineno): code for code in _codes(compile(tree, path, "exec"))}
    vars(module)[_NAME] = compared
    changed = []
    for function in _functions(module):
        old = function.__code__
        new = fresh.get((old.co_qualname, old.co_firstlineno))
        if new is not None and old.co_freevars == new.co_freevars:
            function.__code__ = new
            changed.append((function, old))
    return changed


class _Route(ast.NodeTransformer):
    def __init__(self, module: str) -> None:
        self.module = module

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        self.generic_visit(node)
        if not all(type(op) in _OPERATORS for op in node.ops):
            return node
        names = ast.Tuple([ast.Constant(_OPERATORS[type(op)]) for op in node.ops], ast.Load())
        place = ast.Constant(f"{self.module}:{node.lineno}")
        call = ast.Call(ast.Name(_NAME, ast.Load()), [place, names, node.left, *node.comparators], [])
        return ast.fix_missing_locations(ast.copy_location(call, node))


def _codes(code: CodeType) -> Iterator[CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _codes(constant)


def _functions(module: ModuleType) -> Iterator[FunctionType]:
    for value in vars(module).values():
        if isinstance(value, type) and value.__module__ == module.__name__:
            yield from (part for part in map(_unwrapped, vars(value).values()) if isinstance(part, FunctionType))
        elif isinstance(part := _unwrapped(value), FunctionType) and part.__module__ == module.__name__:
            yield part


def _unwrapped(value: Any) -> Any:
    value = getattr(value, "fget", getattr(value, "func", value))
    return inspect.unwrap(value) if callable(value) else value
