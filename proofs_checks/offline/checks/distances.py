"""Hellinger, total variation, and the square roots of densities."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import strategies as st

from proofs_checks.context import Context
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import squared_hellinger, total_variation
from proofs_checks.exact.strategies import Row, rows
from proofs_checks.exact.surd import at_most_roots, root, surd
from proofs_checks.outcome import Outcome

_PAIRS = st.integers(1, 4).flatmap(lambda size: st.tuples(rows(size), rows(size)))
_TRIPLES = st.integers(1, 3).flatmap(lambda size: st.tuples(rows(size), rows(size), rows(size)))


def total_variation_against_hellinger(*, ceiling: int = 2, floor: int = 1, context: Context = QUICK) -> Outcome:
    """TV^2 <= H^2 (ceiling - H^2) and floor H^2 <= TV, for every pair of finite laws."""

    def holds(pair: tuple[Row, Row]) -> bool:
        p, q = (dict(enumerate(row)) for row in pair)
        hellinger, variation = squared_hellinger(p, q), total_variation(p, q)
        return hellinger * (ceiling - hellinger) >= variation**2 and hellinger * floor <= variation

    return on_every("H^2 <= TV <= sqrt(H^2 (2 - H^2))", _PAIRS, holds, context.pick(quick=100, full=250))


def root_densities(*, normalisation: int = 2, context: Context = QUICK) -> Outcome:
    """H^2 = (1/2) ||sqrt p - sqrt q||_2^2."""

    def holds(pair: tuple[Row, Row]) -> bool:
        p, q = pair
        squared_norm = sum(((root(a) - root(b)) * (root(a) - root(b)) for a, b in zip(p, q, strict=True)), surd(0))
        return squared_norm == squared_hellinger(dict(enumerate(p)), dict(enumerate(q))) * normalisation

    return on_every("H^2 = ||sqrt p - sqrt q||^2 / 2", _PAIRS, holds, context.pick(quick=60, full=150))


def triangle(*, slack: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """H(p, r) <= slack (H(p, q) + H(q, r))."""

    def holds(triple: tuple[Row, Row, Row]) -> bool:
        p, q, r = (dict(enumerate(row)) for row in triple)
        return at_most_roots(
            squared_hellinger(p, r), (slack, squared_hellinger(p, q)), (slack, squared_hellinger(q, r))
        )

    return on_every("H is a metric", _TRIPLES, holds, context.pick(quick=60, full=150))
