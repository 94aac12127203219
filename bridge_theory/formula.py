"""A formula of the paper with its meaning attached: what ``Bound`` and ``Rate`` have in common."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np

from bridge_theory.arithmetic import Value
from bridge_theory.arithmetic.coq_terms import CoqTerms
from bridge_theory.conditions import Condition
from bridge_theory.errors import InputError
from bridge_theory.estimation import certainly_holds, estimated, exact_points
from bridge_theory.monotone import Monotone
from bridge_theory.parameters import Given, Stored, parameter
from bridge_theory.terms import combined

Status = Literal["stated", "repaired", "sharp"]
Group = Literal["offline", "online", "regret", "answers"]


@dataclass(frozen=True, eq=False, repr=False)
class Formula:
    """An ordinary function over an arithmetic plus what a reader needs to know about it."""

    function: Callable[..., Value]
    title: str
    symbol: str
    source: str
    group: Group
    status: Status
    assumptions: tuple[str, ...] = ()
    conditions: tuple[Condition, ...] = ()
    monotone: Mapping[str, Monotone] = field(default_factory=dict)

    def __post_init__(self) -> None:
        # carry the function's identity, so that help() and doctest see the formula's own docstring
        for attribute in ("__module__", "__name__", "__qualname__", "__doc__"):
            self.__dict__[attribute] = getattr(self.function, attribute)
        self.__dict__["__wrapped__"] = self.function
        unknown = set(self.monotone) - set(self.parameters)
        if unknown:
            raise TypeError(f"{self.name} declares a direction in {sorted(unknown)}, which it does not take")

    @property
    def name(self) -> str:
        """The name under which the package exports this formula."""
        return str(self.function.__name__)

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters, in the order of the formula; each is a row of ``bridge_theory.parameters``."""
        names = tuple(inspect.signature(self.function).parameters)[1:]
        return tuple(parameter(name).name for name in names)

    def __call__(self, m: Any, **values: Value) -> Value:
        """Evaluate over the arithmetic ``m``: for writing one formula in terms of another."""
        if isinstance(m, CoqTerms):  # a definition refers to the other one by its name
            return m.applied(self, values)
        return combined(m, self.function(m, **values))

    def estimate(self, **values: object) -> Any:
        """The value in float64, broadcasting over array arguments; no certificate, but right to ten digits.

        Returns a float64 scalar or array: infinite where the value is beyond float64, nan where it is not known.
        Errors: ``InputError`` for unknown, missing or out-of-domain parameters.
        """
        self._check_names(values)
        floats = {name: parameter(name).floats(value) for name, value in values.items()}
        unclear = [condition for condition in self.conditions if not certainly_holds(condition, values, floats)]
        conditioned = dict.fromkeys(name for condition in unclear for name in condition.parameters)
        if unclear:
            self.check_conditions(exact_points({name: values[name] for name in conditioned}, floats), unclear)
        outcome = estimated(self, values, floats)
        return np.float64(outcome) if np.ndim(outcome) == 0 else np.asarray(outcome)

    def expression(self, **values: Given) -> Any:
        """The SymPy expression, with any of the parameters replaced by exact numbers.

        Errors: ``InputError`` for unknown or out-of-domain parameters.
        """
        from bridge_theory.arithmetic.symbols import SYMBOLS
        from bridge_theory.symbolic import symbol_for

        unknown = set(values) - set(self.parameters)
        if unknown:
            raise InputError(self._names_message(unknown, set()))
        exact = {name: parameter(name).exact(value) for name, value in values.items()}
        if len(exact) == len(self.parameters):
            self.check_conditions(exact)
        arguments = {
            name: symbol_for(name) if name not in exact else _sympy_number(SYMBOLS.number, exact[name])
            for name in self.parameters
        }
        return self(SYMBOLS, **arguments)

    def latex(self) -> str:
        """``symbol = expression`` in LaTeX, without dollar signs."""
        from bridge_theory.symbolic import latex_of

        return f"{self.symbol} = {latex_of(self.expression())}"

    def exact_arguments(self, values: Mapping[str, Given]) -> dict[str, Stored]:
        """All parameters as validated exact numbers; the formula's conditions hold."""
        self._check_names(values)
        exact = {name: parameter(name).exact(values[name]) for name in self.parameters}
        self.check_conditions(exact)
        return exact

    def _check_names(self, values: Mapping[str, object]) -> None:
        unknown, missing = set(values) - set(self.parameters), set(self.parameters) - set(values)
        if unknown or missing:
            raise InputError(self._names_message(unknown, missing))

    def _names_message(self, unknown: set[str], missing: set[str]) -> str:
        parts = [f"does not take {', '.join(sorted(unknown))}"] if unknown else []
        parts += [f"needs {', '.join(name for name in self.parameters if name in missing)}"] if missing else []
        return f"{self.name} {' and '.join(parts)}; its parameters are {', '.join(self.parameters)}"

    def check_conditions(self, values: Mapping[str, object], conditions: Iterable[Condition] | None = None) -> None:
        """Raise the error of the first condition, of all or of those given, that some point violates."""
        for condition in self.conditions if conditions is None else conditions:
            condition.check(self.name, values)

    def __repr__(self) -> str:
        kind = type(self).__name__.lower()
        return f"<{self.status} {kind} {self.name}({', '.join(self.parameters)}) from {self.source}>"


def _sympy_number(number: Callable[..., Value], value: Stored) -> Value:
    return value if isinstance(value, tuple) else number(value)
