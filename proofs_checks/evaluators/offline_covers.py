r"""How many kernels a logarithmic cover of three states needs, given how dense covers by translates of a triangle are.

Rows of three states are the points of a triangle. An element q covers ``{p : p_i <= e^eps q_i}``, a translate of the
reversed triangle of side ``growth = e^eps - 1``. If N translates cover the triangle, they and M more that cover the
reversed triangle cover the plane, repeated over the parallelogram of both: ``(N + M) growth^2 / 2 >= density``.

A cover of several rows at once is made of products. The measure of a product is at most ``growth^2`` a row, and over
every choice of the other rows the first ones need N elements, so that all rows need ``N / growth^(2 (rows - 1))``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any

from bridge_theory.arithmetic.flint_balls import ball, working_precision
from bridge_theory.errors import InputError
from proofs_checks.counterexample import Number, evaluates
from proofs_checks.evaluators.offline_numbers import log
from proofs_checks.evaluators.online_numbers import enclosed

_PARTS = 3
"""Positions are multiples of a third of the side of a covering triangle."""

Position = tuple[int, int]
Cell = tuple[int, int, bool]
"""A small triangle of the grid by its lower left corner, and whether it points up."""


@evaluates("offline-triangle-covers")
def triangle_covers(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """A lower bound of the logarithm of the covering number of kernels, and |S| |A| (|S| - 1) log(1/eps + 1)."""
    if int(data["S"]) != 3:
        raise InputError(f"rows of {data['S']} states are no triangle; expected S = 3.")
    rows, epsilon = 3 * int(data["A"]), Fraction(data["epsilon"])
    with working_precision(128):
        growth = ball(epsilon).exp() - 1
        length = int((_PARTS / growth).ceil().unique_fmpz())
        extra = min(len(cover(length, shift)) for shift in range(_PARTS))
        one_row = 2 * ball(Fraction(data["density"])) / growth**2 - extra
        if not one_row >= 1:
            return Fraction(0), enclosed(2 * rows * log(1 / epsilon + 1))
        return enclosed(one_row.log() - 2 * (rows - 1) * growth.log()), enclosed(2 * rows * log(1 / epsilon + 1))


def cover(length: int, shift: int) -> set[Position]:
    """Corners of triangles of side 3 that cover ``{x, y >= 0, x + y <= length}``: of one lattice, no needless ones.

    Every small triangle of the grid inside is checked to lie in one of them.

    >>> sorted(cover(3, 0))
    [(0, 0)]
    >>> len(cover(4, 0))
    3
    """
    cells = list(_cells(length))
    holders = {cell: [at for at in _holders(cell) if (at[0] - at[1] - shift) % _PARTS == 0] for cell in cells}
    chosen = {at for holding in holders.values() for at in holding}
    times = Counter({cell: len(holding) for cell, holding in holders.items()})
    if not all(times[cell] for cell in cells):
        raise InputError(f"the lattice with shift {shift} leaves a gap in the triangle of side {length}.")
    held: dict[Position, list[Cell]] = {}
    for cell, holding in holders.items():
        for at in holding:
            held.setdefault(at, []).append(cell)
    for at in sorted(chosen, key=lambda corner: len(held[corner])):
        if all(times[cell] > 1 for cell in held[at]):
            times.subtract(held[at])
            chosen.remove(at)
    return chosen


def _cells(length: int) -> Iterator[Cell]:
    for i in range(length):
        for j in range(length - i):
            yield i, j, True
            if i + j + 2 <= length:
                yield i, j, False


def _holders(cell: Cell) -> Iterator[Position]:
    """The corners (a, b) of the triangles x >= a, y >= b, x + y <= a + b + 3 that contain a small triangle."""
    i, j, up = cell
    farthest = i + j + (1 if up else 2)
    for a in range(i - _PARTS, i + 1):
        yield from ((a, b) for b in range(j - _PARTS, j + 1) if farthest <= a + b + _PARTS)
