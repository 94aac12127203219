"""The inverse: the smallest (or largest) value of a parameter at which a bound meets a target, with certificates."""

from __future__ import annotations

from itertools import pairwise

from bridge_theory.bound import Bound
from bridge_theory.errors import InputError
from bridge_theory.monotone import Monotone
from bridge_theory.parameters import Exact, Given, Parameter, Stored, parameter, show, to_exact
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
    exact = _others(name, bound, setting, fixed)
    _check_where(name, bound, direction, exact)
    if row.array:
        raise InputError(f"{name} is an array; solve_for takes a parameter that is one number")
    grid = integer_grid(row.domain) if row.domain.integer else float_grid(row.domain)
    search = _Search(bound, row, goal, exact, grid)
    return search.smallest() if direction.direction == "falls" else search.largest()


class _Search:
    """Bisection over the indices of a grid, remembering every evaluated point."""

    def __init__(self, bound: Bound, row: Parameter, goal: Exact, exact: dict[str, Stored], grid: Grid) -> None:
        self._bound, self._row, self._goal, self._exact, self._grid = bound, row, goal, exact, grid
        self._probes: dict[int, Probe] = {}

    def smallest(self) -> Solution:
        """The smallest index that meets the target; the meeting indices reach up to the end of the window."""
        first, last = self._window()
        if self._meets(first):
            return self._edge(first)
        step, failing = 1, first
        while not self._meets(meeting := min(first + step, last)):
            if meeting == last:
                return self._never(last)
            failing, step = meeting, step * 2
        return self._bisect(failing, meeting, edge=first)

    def largest(self) -> Solution:
        """The largest index that meets the target; the meeting indices start at the beginning of the window."""
        first, last = self._window()
        if not self._meets(first):
            return self._never(first)
        step, meeting = 1, first
        while self._meets(failing := min(first + step, last)):
            if failing == last:
                return self._edge(last)
            meeting, step = failing, step * 2
        return self._bisect(failing, meeting, edge=last)

    def _window(self) -> tuple[int, int]:
        """The first and last index at which the statement's conditions hold; they hold on an interval."""
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
        fails = self._probe(failing)
        return Solution(
            bound=self._bound,
            name=self._row.name,
            target=self._goal,
            others=self._exact,
            status="found",
            value=self._grid.number(meeting),
            meets=self._probe(meeting).enclosure,
            beyond=self._grid.number(failing),
            fails=fails.enclosure if fails.verdict == "fails" else None,
            excluded=self._excluded(failing, edge),
            reason=self._reason(failing, fails),
        )

    def _excluded(self, failing: int, edge: int) -> bool:
        low, high = sorted((self._grid.number(failing), self._grid.number(edge)))
        return excluded_by_boxes(
            self._bound, self._row.name, self._exact, self._goal, low, high, integer=self._row.domain.integer
        )

    def _reason(self, failing: int, fails: Probe) -> str:
        beyond = f"{self._row.name} = {show(self._grid.number(failing))}"
        if fails.verdict == "undecided":
            return f"at {beyond} the bound and the target agree to the highest precision"
        return f"at {beyond} the bound exceeds the target"

    def _edge(self, index: int) -> Solution:
        self._check_direction()
        value = self._grid.number(index)
        reason = f"every {self._row.name} that is searched meets the target, even {self._row.name} = {show(value)}"
        return self._without_failure("always", value, self._probe(index), reason)

    def _never(self, index: int) -> Solution:
        self._check_direction()
        probe, best = self._probe(index), show(self._grid.number(index))
        if probe.verdict != "fails":
            reason = f"the bound cannot be told from the target even at {self._row.name} = {best}"
        else:
            reason = f"at the most favourable {self._row.name} = {best} the bound is still {probe.enclosure.lower:.6g}"
        return self._without_failure("never", None, probe, reason)

    def _without_failure(self, status: str, value: Exact | None, probe: Probe, reason: str) -> Solution:
        always = status == "always"
        return Solution(
            bound=self._bound,
            name=self._row.name,
            target=self._goal,
            others=self._exact,
            status="always" if always else "never",
            value=value,
            meets=probe.enclosure if always else None,
            beyond=None,
            fails=None if always else probe.enclosure,
            excluded=False,
            reason=reason,
        )

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


def _others(name: str, bound: Bound, setting: Setting | None, fixed: dict[str, Given]) -> dict[str, Stored]:
    known = (setting or Setting()).replace(**fixed).completed(bound.spends)
    missing = [other for other in bound.parameters if other != name and other not in known]
    if missing:
        raise InputError(f"solving {bound.name} for {name} needs {', '.join(missing)}")
    return {other: known[other] for other in bound.parameters if other != name}


def _check_where(name: str, bound: Bound, direction: Monotone, exact: dict[str, Stored]) -> None:
    if not direction.holds(exact):
        raise InputError(
            f"{bound.name} is not known to be monotone in {name} at these values: {direction.because} only there"
        )
