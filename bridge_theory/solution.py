"""The answer of ``solve_for``: a value, its two certificates, and what they mean in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

from bridge_theory.bound import Bound
from bridge_theory.defaults import Filled, filled_in_words
from bridge_theory.enclosure import Enclosure
from bridge_theory.monotone import Monotone
from bridge_theory.parameters import Exact, Stored, parameter, show

if TYPE_CHECKING:
    from bridge_theory.value import BoundValue


@dataclass(frozen=True, eq=False)
class Solution:
    """Where a bound meets a target.

    ``filled`` are those of the ``others`` that were not given. ``searched`` holds the first and the last value at which
    the bound applies, among those that are searched: nothing is said of larger ones where the parameter has no end.
    ``status`` is ``found``, ``always`` (every searched value meets the target; ``value`` is the least favourable one),
    ``never`` or ``undecided``: the highest precision does not tell whether ``beyond`` meets the target. An undecided
    answer may still have a ``value`` that does, but perhaps not the last one. ``meets`` encloses the bound at
    ``value``; ``fails`` encloses it at ``beyond``, the neighbour (or, of ``never``, the most favourable value) that
    exceeds the target (None where undecided). ``excluded`` says whether all searched values beyond were ruled out by
    interval arithmetic alone; otherwise they are by the declared monotonicity.
    """

    bound: Bound
    name: str
    target: Exact
    others: Mapping[str, Stored]
    filled: tuple[Filled, ...]
    searched: tuple[Exact, Exact]
    status: Literal["found", "always", "never", "undecided"]
    value: Exact | None
    meets: Enclosure | None
    beyond: Exact | None
    fails: Enclosure | None
    excluded: bool
    reason: str

    @cached_property
    def at_value(self) -> BoundValue | None:
        """The bound at ``value``, with its own failure probability; None where there is no value."""
        from bridge_theory.value import BoundValue

        if self.value is None:
            return None
        exact = {**self.others, self.name: self.value}
        return BoundValue(self.bound, {name: exact[name] for name in self.bound.parameters}, self.filled)

    @property
    def words(self) -> str:
        """The answer, whether the bound certifies anything there, and what was filled in."""
        empty = ""
        if self.at_value is not None and not self.at_value.certified:
            total = self.at_value.failure.at_most
            empty = f" Nothing is certified there: the bound's events may fail with a total probability of {total}."
        return self._answer + empty + filled_in_words(self.filled)

    @property
    def _answer(self) -> str:
        goal = f"{self.bound.name} <= {show(self.target)}"
        if self.status == "never":
            return f"No {self._every} achieves {goal}: {self.reason}."
        if self.status == "always":
            return f"{goal} holds for every {self._every}: {self.reason}."
        if self.value is None:
            return f"No {self.name} is certified to achieve {goal}: {self.reason}."
        side = "smallest" if self._falls else "largest"
        if self.status == "undecided":
            meets = f"{self.name} = {show(self.value)} achieves {goal}"
            return f"{meets} but is not certified to be the {side}: {self.reason}."
        others = "all smaller ones" if self._falls else f"all larger ones up to {show(self.searched[1])}"
        why = (
            f"interval arithmetic rules out {others}"
            if self.excluded
            else f"by monotonicity: {self._direction.because}"
        )
        return f"{self.name} = {show(self.value)} is the {side} with {goal}: {self.reason} ({why})."

    @property
    def _direction(self) -> Monotone:
        return self.bound.monotone[self.name]

    @property
    def _falls(self) -> bool:
        return self._direction.direction == "falls"

    @property
    def _every(self) -> str:
        """All values that an answer at one end of the search speaks for, by the declared direction."""
        first, last = map(show, self.searched)
        upward = self._falls == (self.status == "always")
        reach = f"{self.name} from {first} on" if upward else f"{self.name} up to {last}"
        return f"{reach} at which it applies" if self.bound.conditions else reach

    def __str__(self) -> str:
        return self.words

    def _repr_html_(self) -> str:
        from bridge_theory.display import solution_html

        return solution_html(self)

    def _repr_latex_(self) -> str:
        symbol = parameter(self.name).latex
        if self.status == "undecided" and self.value is None:
            return rf"${self.bound.symbol} \le {show(self.target)} \text{{ is undecided for every }} {symbol}$"
        if self.value is None:
            ends = rf"\le {show(self.searched[1])}" if self._falls else rf"\ge {show(self.searched[0])}"
            return rf"${self.bound.symbol} > {show(self.target)} \text{{ for every }} {symbol} {ends}$"
        return rf"${symbol} = {show(self.value)} \;\Rightarrow\; {self.bound.symbol} \le {show(self.target)}$"
