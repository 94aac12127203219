"""The value of a bound at a setting: what it is, what dominates it, whether it says anything, and in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Any

from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.flint_balls import rational
from bridge_theory.arithmetic.protocol import Value
from bridge_theory.bound import Bound, call_with
from bridge_theory.defaults import Filled, filled_in_words
from bridge_theory.enclosure import Enclosure, ball_arguments, enclose
from bridge_theory.parameters import Exact, Stored, parameter, show
from bridge_theory.terms import Terms


@dataclass(frozen=True, eq=False)
class BoundValue:
    """A bound evaluated at validated exact parameters; everything numeric in it is certified.

    Made by ``Bound.value``; ``filled`` are the parameters that the setting did not hold. Errors: none beyond those of
    ``Bound.value``.

    >>> from bridge_theory import offline_radius
    >>> value = offline_radius.value(S=5, A=4, H=8, n=2, delta="0.05", gamma_min="0.1")
    >>> value.vacuous, value.dominant, round(value.enclosure.middle, 1)
    (True, 'transfer', 1261.0)
    """

    bound: Bound
    parameters: Mapping[str, Stored]
    filled: tuple[Filled, ...] = ()

    @cached_property
    def enclosure(self) -> Enclosure:
        """Certified lower and upper float64 ends of the value."""
        return enclose(self._computed)

    @cached_property
    def terms(self) -> dict[str, Enclosure]:
        """Certified enclosure of each named term; empty if the formula names none."""
        outcome = self._outcome()
        if not isinstance(outcome, Terms):
            return {}
        return {name: enclose(self._term(name)) for name in outcome.parts}

    @cached_property
    def shares(self) -> dict[str, float]:
        """Each term's fraction of the sum (display only); empty unless the terms are added and the sum is known."""
        whole = self.enclosure.middle
        if not self._adds or not isfinite(whole) or whole == 0:
            return {}
        return {name: term.middle / whole for name, term in self.terms.items()}

    @property
    def dominant(self) -> str | None:
        """The term that decides the value: the largest of a sum, the smallest of a minimum; None if not known."""
        if not self.terms or not all(isfinite(term.middle) for term in self.terms.values()):
            return None
        pick = max if self._adds else min
        return pick(self.terms, key=lambda name: self.terms[name].middle)

    @cached_property
    def trivial(self) -> Enclosure | None:
        """The value at which the statement becomes empty, or None where there is no such value."""
        trivial = self.bound.trivial
        return None if trivial is None else enclose(lambda: self._computed_trivial(trivial))

    @cached_property
    def vacuous(self) -> bool | None:
        """Whether the bound is no better than the trivial value, certified also where both are beyond float64.

        None where there is no trivial value, or where the two are not known well enough to be compared.
        """
        trivial = self.bound.trivial
        if trivial is None or self.trivial is None:
            return None
        excess = enclose(lambda: self._computed() - self._computed_trivial(trivial))
        if excess.lower >= 0 or excess.upper < 0:
            return excess.lower >= 0
        return True if self.enclosure.narrow and self.trivial.narrow else None  # they agree to the highest precision

    @cached_property
    def failure(self) -> Enclosure:
        """The total probability with which this statement's own events may fail; 0 for a deterministic statement."""
        total = self.bound.failure
        if total is not None:
            return enclose(lambda: call_with(total, BALLS, ball_arguments(self.parameters)))
        return enclose(self._spent)

    @property
    def certified(self) -> bool:
        """Whether the statement's events are proved to fail with a probability below 1; otherwise it says nothing."""
        return self.failure.upper < 1

    @property
    def words(self) -> str:
        """The statement in words: its probability, its value, its assumptions, and what was filled in for it."""
        statement = self.bound.words.format(value=self.enclosure.at_most, at_least=self.enclosure.at_least)
        chance = f"with probability at least {self.failure.complement_at_least}, " if self.failure.upper > 0 else ""
        if not self.certified:
            total = self.failure.at_most
            chance = f"nothing is certified, for its events may fail with a total probability of {total}: "
        claim = self._whose + chance + statement
        provided = f", provided {'; '.join(self.bound.assumptions)}" if self.bound.assumptions else ""
        empty = " This is no better than the trivial value." if self.vacuous else ""
        return claim[0].upper() + claim[1:] + provided + "." + filled_in_words(self.filled) + empty

    @property
    def shown(self) -> str:
        """Six digits on the side on which the statement stays true: up for an upper bound, down for a lower one."""
        return self.safe_side(self.enclosure)

    def safe_side(self, enclosure: Enclosure) -> str:
        """Six digits of the value or of one of its terms, rounded to the side of the statement."""
        return enclosure.at_least if self.bound.from_below else enclosure.at_most

    def __str__(self) -> str:
        return f"{self.bound.name} = {self.enclosure}"

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={show(value)}" for name, value in self.parameters.items())
        return f"<{self.bound.name}({shown}) in {self.enclosure}>"

    def _repr_html_(self) -> str:
        from bridge_theory.display import value_html

        return value_html(self)

    def _repr_latex_(self) -> str:
        shown = ", ".join(f"{parameter(name).latex} = {show(value)}" for name, value in self.parameters.items())
        return rf"${self.bound.symbol} \in [{self.enclosure.lower!r}, {self.enclosure.upper!r}] \quad ({shown})$"

    @property
    def _whose(self) -> str:
        """Who says so, where it is not proved here: the paper, or the paper but for one repair."""
        if self.bound.status != "stated":
            return ""
        source = self.bound.source
        return f"as the paper would state after {source}, " if source.startswith("audit ") else "as the paper states, "

    def _computed(self) -> Value:
        return self.bound(BALLS, **ball_arguments(self.parameters))

    def _computed_trivial(self, trivial: Exact | Callable[..., Value]) -> Value:
        return call_with(trivial, BALLS, ball_arguments(self.parameters)) if callable(trivial) else rational(trivial)

    def _spent(self) -> Value:
        arguments = ball_arguments(self.parameters)
        return sum((arguments[name] for name in self.bound.spends), start=rational(0))

    @property
    def _adds(self) -> bool:
        outcome = self._outcome()
        return isinstance(outcome, Terms) and outcome.combine == "sum"

    def _outcome(self) -> Any:
        return self.bound.function(BALLS, **ball_arguments(self.parameters))

    def _term(self, name: str) -> Callable[[], Value]:
        return lambda: self._outcome().parts[name]
