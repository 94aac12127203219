"""The inverse: the smallest (or largest) value of a parameter at which a bound meets a target, with certificates."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from bridge_theory.bound import Bound
from bridge_theory.defaults import Filled, completed, missing
from bridge_theory.errors import InputError
from bridge_theory.monotone import Monotone
from bridge_theory.parameters import Exact, Given, Parameter, Stored, parameter, show, to_exact
from bridge_theory.rounding import rounded_down
from bridge_theory.search import Grid, float_grid, integer_grid
from bridge_theory.setting import Setting
from bridge_theory.solution import Solution
from bridge_theory.verdict import Probe, applies, decide, excluded_by_boxes


def solve_for(name: str, bound: Bound, target: Given, *, setting: Setting | None = None, **fixed: Given) -> Solution:
    r"""Where does ``bound <= target`` begin (or end) to hold as the parameter ``name`` grows?

    Statement: if the bound falls in the parameter, the smallest value that meets the target; if it rises, the largest.
    Integers are exact; reals are float64 numbers, the returned one meets the target and its neighbour does not.
    Source: bisection over certified enclosures; the direction is the bound's declared one, checked on every evaluated
    point and, where ball arithmetic over whole intervals is sharp enough, proved by excluding all other values.
    Assumptions: those of the bound. Arguments: the parameter's name, a bound, the target as an exact number, the other
    parameters as a ``Setting`` or by name. Integers are searched up to 10^24, reals up to 10^100. Returns a
    ``Solution``. Errors: ``InputError`` if the bound has no declared direction in the parameter or others are missing.

    >>> from bridge_theory import offline_radius
    >>> solution = solve_for("n", offline_radius, 1, S=5, A=4, H=8, delta="0.05", gamma_min="0.1")
    >>> solution.value, solution.meets.upper <= 1 < solution.fails.lower, solution.excluded
    (150158, True, True)
    """
    row, direction = parameter(name), _direction(name, bound)
    goal = to_exact("target", target)
    exact, filled = _others(name, bound, setting, fixed)
    _check_where(name, bound, direction, exact)
    grid = integer_grid(row.domain) if row.domain.integer else float_grid(row.domain)
    search = _Search(bound, row, goal, exact, grid, filled)
    return search.smallest() if direction.direction == "falls" else search.largest()


class _Search:
    """Bisection over the indices of a grid, remembering every evaluated point."""

    def __init__(
        self,
        bound: Bound,
        row: Parameter,
        goal: Exact,
        exact: dict[str, Stored],
        grid: Grid,
        filled: tuple[Filled, ...],
    ) -> None:
        self._bound, self._row, self._goal, self._exact, self._grid = bound, row, goal, exact, grid
        self._filled = filled
        self._probes: dict[int, Probe] = {}
        self._searched = self._window()

    def smallest(self) -> Solution:
        """The smallest index that meets the target; the meeting indices reach up to the end of the window."""
        first, last = self._searched
        if self._meets(first):
            return self._edge(first)
        step, failing = 1, first
        while not self._meets(meeting := min(first + step, last)):
            if meeting == last:
                return self._none(last)
            failing, step = meeting, step * 2
        return self._bisect(failing, meeting, edge=first)

    def largest(self) -> Solution:
        """The largest index that meets the target; the meeting indices start at the beginning of the window."""
        first, last = self._searched
        if not self._meets(first):
            return self._none(first)
        step, meeting = 1, first
        while self._meets(failing := min(first + step, last)):
            if failing == last:
                return self._edge(last)
            meeting, step = failing, step * 2
        return self._bisect(failing, meeting, edge=last)

    def _window(self) -> tuple[int, int]:
        """A first and a last index at which the statement's conditions hold; ``_check_applies`` tests the answer."""
        first, last = self._grid.first, self._grid.last
        inside, outside, step = first, first - 1, 1
        while not self._applies(inside):
            if inside == last:
                raise InputError(f"{self._bound.name} applies at no {self._row.name} with these other parameters")
            outside, inside, step = inside, min(inside + step, last), step * 2
        start = self._boundary(inside, outside)
        if self._applies(last):
            return start, last
        inside, outside, step = start, start + 1, 1
        while self._applies(outside):
            inside, outside, step = outside, min(outside + step, last), step * 2
        return start, self._boundary(inside, outside)

    def _boundary(self, inside: int, outside: int) -> int:
        while abs(inside - outside) > 1:
            middle = (inside + outside) // 2
            inside, outside = (middle, outside) if self._applies(middle) else (inside, middle)
        return inside

    def _applies(self, index: int) -> bool:
        return applies(self._bound, {**self._exact, self._row.name: self._grid.number(index)})

    def _bisect(self, failing: int, meeting: int, *, edge: int) -> Solution:
        while abs(meeting - failing) > 1:
            middle = (meeting + failing) // 2
            if self._meets(middle):
                meeting = middle
            else:
                failing = middle
        self._check_direction()
        self._check_applies(meeting, failing)
        fails = self._probe(failing)
        found = fails.verdict == "fails"
        return self._solution(
            status="found" if found else "undecided",
            value=self._grid.number(meeting),
            meets=self._probe(meeting).enclosure,
            beyond=self._grid.number(failing),
            fails=fails.enclosure if found else None,
            excluded=found and self._excluded(failing, edge),
            reason=self._reason(failing, fails),
        )

    def _check_applies(self, *indices: int) -> None:
        """Refuse an answer in a gap of the conditions: what holds in the intervals around it is not known."""
        for index in indices:
            if not self._applies(index):
                at = f"{self._row.name} = {show(self._grid.number(index))}"
                raise InputError(
                    f"{self._bound.name} crosses the target at {at}, where its own conditions fail although they hold "
                    "on both sides; choose a target it crosses elsewhere"
                )

    def _excluded(self, failing: int, edge: int) -> bool:
        low, high = sorted((self._grid.number(failing), self._grid.number(edge)))
        return excluded_by_boxes(
            self._bound, self._row.name, self._exact, self._goal, low, high, integer=self._row.domain.integer
        )

    def _reason(self, index: int, probe: Probe) -> str:
        at = f"at {self._row.name} = {show(self._grid.number(index))}"
        if probe.verdict == "fails":
            return f"{at} the bound exceeds the target"
        if probe.enclosure.narrow:
            return f"{at} the bound and the target agree to the highest precision"
        return f"{at} the highest precision encloses the bound only in {probe.enclosure}"

    def _edge(self, index: int) -> Solution:
        self._check_direction()
        value = self._grid.number(index)
        return self._solution(
            status="always",
            value=value,
            meets=self._probe(index).enclosure,
            beyond=None,
            fails=None,
            excluded=False,
            reason=f"even {self._row.name} = {show(value)} meets the target",
        )

    def _none(self, index: int) -> Solution:
        self._check_direction()
        probe, best = self._probe(index), show(self._grid.number(index))
        fails = probe.verdict == "fails"
        still = f"at the most favourable {self._row.name} = {best} the bound still exceeds the target: it is at least "
        reason = still + rounded_down(probe.enclosure.lower) if fails else self._reason(index, probe)
        return self._solution(
            status="never" if fails else "undecided",
            value=None,
            meets=None,
            beyond=self._grid.number(index),
            fails=probe.enclosure if fails else None,
            excluded=False,
            reason=reason,
        )

    def _solution(self, **answer: Any) -> Solution:
        first, last = (self._grid.number(index) for index in self._searched)
        return Solution(self._bound, self._row.name, self._goal, self._exact, self._filled, (first, last), **answer)

    def _meets(self, index: int) -> bool:
        return self._probe(index).verdict == "meets"

    def _probe(self, index: int) -> Probe:
        if index not in self._probes:
            point = {**self._exact, self._row.name: self._grid.number(index)}
            self._probes[index] = decide(self._bound, point, self._goal)
        return self._probes[index]

    def _check_direction(self) -> None:
        """Refuse to answer if two evaluated points contradict the declared direction."""
        rises = self._bound.monotone[self._row.name].direction == "rises"
        points = sorted((index, probe.enclosure) for index, probe in self._probes.items())
        for (left, at_left), (right, at_right) in pairwise(points):
            before, after = (at_left, at_right) if rises else (at_right, at_left)
            if before.lower > after.upper:
                ends = f"{show(self._grid.number(left))} and {show(self._grid.number(right))}"
                raise InputError(
                    f"{self._bound.name} moves against its declared direction in {self._row.name} between {ends}; "
                    "this is a defect of bridge_theory, please report it"
                )


def _direction(name: str, bound: Bound) -> Monotone:
    if not isinstance(bound, Bound):
        raise InputError(f"{bound!r} is not a bound; only certified bounds can be inverted")
    if name not in bound.monotone:
        accepted = ", ".join(bound.monotone) or "none"
        raise InputError(f"{bound.name} has no known direction in {name}; it can be solved for: {accepted}")
    return bound.monotone[name]


def _others(
    name: str, bound: Bound, setting: Setting | None, fixed: dict[str, Given]
) -> tuple[dict[str, Stored], tuple[Filled, ...]]:
    given = {key: value for key, value in (setting or Setting()).replace(**fixed).items() if key != name}
    lacking = missing(bound, given, varied=name)
    if lacking:
        raise InputError(f"solving {bound.name} for {name} needs {', '.join(lacking)}")
    known, filled = completed(bound, given)
    others = {other: known[other] for other in bound.parameters if other != name}
    return others, tuple(item for item in filled if item.name != name)


def _check_where(name: str, bound: Bound, direction: Monotone, exact: dict[str, Stored]) -> None:
    if not direction.holds(exact):
        raise InputError(
            f"{bound.name} is not known to be monotone in {name} at these values: {direction.because} only there"
        )
