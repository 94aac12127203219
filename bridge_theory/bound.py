"""``Bound``: a formula that can be certified, and the decorators that make bounds and rates of ordinary functions."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bridge_theory.arithmetic import Value
from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.conditions import Condition
from bridge_theory.enclosure import Enclosure, ball_arguments, enclose
from bridge_theory.errors import InputError
from bridge_theory.formula import Formula, Group, Status
from bridge_theory.monotone import Monotone
from bridge_theory.parameters import Exact, Given, parameter
from bridge_theory.setting import Setting

if TYPE_CHECKING:
    from bridge_theory.value import BoundValue


@dataclass(frozen=True, eq=False, repr=False)
class Bound(Formula):
    """A formula with a certified value.

    ``trivial`` is the value beyond which the statement says nothing (a number, or a function of ``m`` and some of the
    parameters); ``spends`` are the failure probabilities it uses up, ``failure`` their total where that is not their
    sum; ``words`` is the statement with ``{value}`` in it, or ``{at_least}`` where it bounds from below.
    """

    trivial: Exact | Callable[..., Value] | None = None
    spends: tuple[str, ...] = ()
    failure: Callable[..., Value] | None = None
    words: str = ""

    @property
    def from_below(self) -> bool:
        """Whether the statement bounds its quantity from below."""
        return "{at_least}" in self.words

    def enclosure(self, **values: Given) -> Enclosure:
        """Two floats that provably enclose the exact value at these exact parameters; precision rises by itself.

        Errors: ``InputError`` for unknown, missing or out-of-domain parameters, ``UndefinedInPaperError`` where the
        paper's text has no value.
        """
        exact = self.exact_arguments(values)
        return enclose(lambda: self(BALLS, **ball_arguments(exact)))

    def value(self, setting: Setting | None = None, **values: Given) -> BoundValue:
        """Enclosure, terms, trivial value, failure probability and the statement in words, at a setting.

        Parameters of the setting that this bound does not take are ignored; some that it lacks are filled in, see
        ``bridge_theory.defaults``, and the words say so. Errors: ``InputError`` naming the missing parameters.
        """
        from bridge_theory.defaults import completed, missing
        from bridge_theory.value import BoundValue

        given = (setting or Setting()).replace(**values)
        lacking = missing(self, given)
        if lacking:
            raise InputError(f"{self.name} needs {', '.join(lacking)}; add them to the setting")
        exact, filled = completed(self, given)
        self.check_conditions(exact)
        return BoundValue(self, {name: exact[name] for name in self.parameters}, filled)

    def _repr_html_(self) -> str:
        from bridge_theory.display import bound_html

        return bound_html(self)

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"


@dataclass(frozen=True, eq=False, repr=False)
class Rate(Formula):
    r"""An :math:`\tilde O` statement: its leading expression with unit constants, for scaling only.

    It has an estimate and an expression; it has no certified value, because its constants are not stated.
    """

    def enclosure(self, **values: Given) -> Enclosure:
        """Always refused: the paper states no constants for a rate."""
        raise InputError(
            f"{self.name} is a rate without stated constants; it has an estimate for scaling, no certified value"
        )

    def _repr_latex_(self) -> str:
        from bridge_theory.symbolic import latex_of

        return rf"${self.symbol} = \tilde O\left({latex_of(self.expression())}\right)$"


def call_with(function: Callable[..., Value], m: Any, values: Mapping[str, Any]) -> Value:
    """Call ``function(m, **those of the values it names)``."""
    names = list(inspect.signature(function).parameters)[1:]
    return function(m, **{name: values[name] for name in names})


def bound(
    *,
    title: str,
    symbol: str,
    source: str,
    group: Group,
    status: Status,
    words: str,
    trivial: Exact | Callable[..., Value] | None = None,
    spends: tuple[str, ...] = (),
    failure: Callable[..., Value] | None = None,
    assumptions: tuple[str, ...] = (),
    conditions: tuple[Condition, ...] = (),
    monotone: Mapping[str, Monotone] | None = None,
) -> Callable[[Callable[..., Value]], Bound]:
    """Make a ``Bound`` of a function ``f(m, *, S, A, ...)``; see ``bridge_theory.core`` for how to write one.

    Errors: ``InputError`` if a parameter of the function is not in the table.
    """

    def decorate(function: Callable[..., Value]) -> Bound:
        for name in spends:
            parameter(name)
        return Bound(
            function, title, symbol, source, group, status, assumptions, conditions, monotone or {},
            trivial, spends, failure, words,
        )  # fmt: skip

    return decorate


def rate(
    *,
    title: str,
    symbol: str,
    source: str,
    group: Group,
    status: Status = "stated",
    assumptions: tuple[str, ...] = (),
    conditions: tuple[Condition, ...] = (),
) -> Callable[[Callable[..., Value]], Rate]:
    """Make a ``Rate`` of a function ``f(m, *, S, A, ...)`` that returns the leading expression with unit constants."""

    def decorate(function: Callable[..., Value]) -> Rate:
        return Rate(function, title, symbol, source, group, status, assumptions, conditions)

    return decorate
