"""T12: what a Hellinger ball says about means, covariances, and pairs of policies."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from bridge_theory import (
    covariance_difference_sharp,
    covariance_difference_stated,
    feature_difference_deterministic,
    feature_difference_repaired,
    mean_difference_sharp,
    mean_difference_stated,
)
from bridge_theory.arithmetic.flint_balls import ball
from proofs_checks.balls import Ball, prove_positive
from proofs_checks.context import Context
from proofs_checks.exact.certify import Number, attained, value_of, within
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import squared_hellinger, total_variation
from proofs_checks.exact.model import Model, point
from proofs_checks.exact.strategies import Pair, Row, pairs, rows
from proofs_checks.outcome import Outcome, Tally, together
from proofs_checks.smt import prove, reals
from proofs_checks.symbolic import identity

Vector = tuple[Fraction, ...]
_UNIT_VECTORS = [
    (Fraction(s * a, 5), Fraction(r * b, 5)) for a, b in ((5, 0), (3, 4), (0, 0)) for s in (1, -1) for r in (1, -1)
]


@st.composite
def _laws_with_features(draw: DrawFn) -> tuple[Row, Row, list[Vector]]:
    size = draw(st.integers(1, 4))
    return draw(rows(size)), draw(rows(size)), [draw(st.sampled_from(_UNIT_VECTORS)) for _ in range(size)]


def _mean(law: Row, features: list[Vector]) -> Vector:
    return tuple(sum((p * f[i] for p, f in zip(law, features, strict=True)), Fraction(0)) for i in range(2))


def means(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """||E_P f - E_Q f|| <= 2 TV <= both formulas (B = 1), exactly in the first step."""

    def holds(instance: tuple[Row, Row, list[Vector]]) -> bool:
        p, q, features = instance
        squared = sum((a - b) ** 2 for a, b in zip(_mean(p, features), _mean(q, features), strict=True))
        laws = dict(enumerate(p)), dict(enumerate(q))
        distance = squared_hellinger(*laws)
        if squared > 4 * (share * total_variation(*laws)) ** 2:
            return False
        norm = _root_of(squared)
        return within(norm, mean_difference_sharp, B=1, R=distance) and within(
            norm, mean_difference_stated, B=1, d=2, R=distance
        )

    return on_every("means in a Hellinger ball", _laws_with_features(), holds, context.pick(quick=50, full=200))


def covariances(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """|v'(Cov_P - Cov_Q)v| <= phi(TV) along an axis, and both formulas (B = 1)."""

    def holds(instance: tuple[Row, Row, list[Vector]]) -> bool:
        p, q, features = instance
        scalars = [f[0] for f in features]
        difference = abs(_variance(p, scalars) - _variance(q, scalars))
        laws = dict(enumerate(p)), dict(enumerate(q))
        distance, t = squared_hellinger(*laws), share * total_variation(*laws)
        if difference > (4 * t * (1 - t) if 2 * t <= 1 else 1):
            return False
        return within(difference, covariance_difference_sharp, B=1, R=distance) and within(
            difference, covariance_difference_stated, B=1, d=2, R=distance
        )

    return on_every("covariances in a Hellinger ball", _laws_with_features(), holds, context.pick(quick=50, full=200))


def _variance(law: Row, values: list[Fraction]) -> Fraction:
    mean = sum((p * x for p, x in zip(law, values, strict=True)), Fraction(0))
    return sum((p * x * x for p, x in zip(law, values, strict=True)), Fraction(0)) - mean**2


def _root_of(value: Fraction | int) -> Number:
    def root() -> Ball:
        return ball(Fraction(value)).sqrt()

    return root


def covariance_maximum(*, peak: int = 4) -> Outcome:
    """t(1 - a^2) + t(1 - t)(1 + a)^2 <= peak t(1 - t) for t <= 1/2 and <= 1 beyond, 0 <= a <= 1."""
    t, a = reals("t a")
    gain = t * (1 - a * a) + t * (1 - t) * (1 + a) * (1 + a)
    box = [t >= 0, t <= 1, a >= 0, a <= 1]
    return together(
        prove("t <= 1/2", [*box, 2 * t <= 1], gain <= peak * t * (1 - t)),
        prove("t >= 1/2", [*box, 2 * t >= 1], 4 * gain <= peak),
    )


def tightness(*, shift: Fraction = Fraction(0)) -> Outcome:
    """Two points +-1 attain the mean bound; three points attain the covariance bound."""
    tally = Tally()
    for t in (Fraction(3, 5), Fraction(5, 13), Fraction(0), Fraction(1)):
        # P and Q = ((1 + t)/2, (1 - t)/2) reversed: TV = t, H^2 = 1 - sqrt(1 - t^2)
        p, q = {1: (1 + t) / 2, -1: (1 - t) / 2}, {1: (1 - t) / 2, -1: (1 + t) / 2}
        distance = squared_hellinger(p, q)
        gap = sum(x * (p[x] - q[x]) for x in p)
        tally.expect(attained(gap + shift, mean_difference_sharp, B=1, R=distance), f"mean at t = {t}")
    for t in (Fraction(7, 25), Fraction(5, 13)):
        # P = (1 - t) at 1 and t at -1, Q = 1 for sure: variances 4t(1 - t) and 0, H^2 = 1 - sqrt(1 - t); here via TV
        variance = 4 * t * (1 - t)
        u = Fraction(1) - _cosine(t)
        tally.expect(attained(variance + shift, covariance_difference_sharp, B=1, R=u), f"covariance at t = {t}")
    return tally.outcome("the sharp moment bounds are attained")


def _cosine(sine: Fraction) -> Fraction:
    return {Fraction(7, 25): Fraction(24, 25), Fraction(5, 13): Fraction(12, 13)}[sine]


def mean_bounds_compared(*, factor: int = 4) -> Outcome:
    """stated^2 - sharp^2 = 4 B^2 R^2 for d = 1: the stated mean bound follows from the sharp one."""
    import sympy

    stated, sharp = mean_difference_stated.expression(d=1), mean_difference_sharp.expression()
    b, r = (next(x for x in sharp.free_symbols if str(x) == name) for name in "BR")
    return identity("stated^2 - sharp^2", sympy.expand(stated**2 - sharp**2), factor * b**2 * r**2)


def covariance_bounds_compared(*, factor: int = 6) -> Outcome:
    """4 t (1 - t) up to t = 1/2 and 1 beyond is at most factor sqrt(2 R), t^2 = R (2 - R), for all R in [0, 1] (Z3)."""
    t, r, root2r = reals("t R root2r")
    setting = [r >= 0, r <= 1, t >= 0, t * t == r * (2 - r), root2r >= 0, root2r * root2r == 2 * r]
    return together(
        prove("t <= 1/2", [*setting, 2 * t <= 1], 4 * t * (1 - t) <= factor * root2r),
        prove("t >= 1/2", [*setting, 2 * t >= 1], factor * root2r >= 1),
    )


def covariance_formulas_compared(*, factor: int = 1) -> Outcome:
    """The formulas of bridge_theory in this order on a box of R (d = 1), by balls."""

    def gap(R: Ball) -> Ball:
        stated = value_of(covariance_difference_stated, B=1, d=1, R=lambda: R)
        return stated - value_of(covariance_difference_sharp, B=1, R=lambda: R) * factor

    box = {"R": (Fraction(1, 10**4), Fraction(1))}
    return prove_positive("stated minus sharp", gap, box, geometric=("R",))


def _features(law: Mapping[tuple[int, ...], Fraction], weights: Mapping[tuple[int, ...], Fraction]) -> Fraction:
    return sum((p * weights.get(h, Fraction(0)) for h, p in law.items()), Fraction(0))


def two_policies(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """Two policies within r of the clone: the worst feature (B = 1) differs by 2 TV, below both formulas."""

    def holds(pair: Pair) -> bool:
        model = pair.model
        centre, one = model.law(pair.expert), model.law(pair.clone)
        other = model.law(tuple(model.n_actions - 1 - a for a in pair.clone))
        worst = {h: Fraction(1 if one.get(h, 0) > other.get(h, 0) else -1) for h in {*one, *other}}
        gap = _features(one, worst) - _features(other, worst)
        squared = max(squared_hellinger(centre, law).rational() for law in (one, other)) * share
        radius = _root_of(squared)
        return all(
            within(gap, formula, B=1, radius=radius)
            for formula in (feature_difference_deterministic, feature_difference_repaired)
        )

    return on_every("two deterministic policies in a ball", pairs(), holds, context.pick(quick=60, full=200))


def pairs_attain(*, shift: Fraction = Fraction(0)) -> Outcome:
    """Disjoint disagreements of probability r^2 each give 4 B r^2, laws on an arc 2 B sin(2 arccos(1 - r^2))."""
    tally = Tally()
    for square in (Fraction(1, 10), Fraction(1, 4), Fraction(1, 2)):
        start = (square, square, 1 - 2 * square)
        kernel = tuple((tuple(point(s, 3)),) * 2 for s in range(3))
        model = Model(start, kernel, 1)
        laws = [model.law(policy) for policy in ((0, 0, 0), (1, 0, 0), (0, 1, 0))]
        inside = all(squared_hellinger(laws[0], law) == square for law in laws[1:])
        gap = 2 * total_variation(laws[1], laws[2])
        tally.expect(inside and gap == 4 * square, f"the instance at r^2 = {square} is another")
        radius = _root_of(square)
        tally.expect(attained(gap + shift, feature_difference_deterministic, B=1, radius=radius), f"r^2 = {square}")
    for cosine, sine in ((Fraction(12, 13), Fraction(5, 13)), (Fraction(4, 5), Fraction(3, 5))):
        # laws (sin^2, cos^2) at angles a - w, a, a + w with a = 45 degrees: TV of the outer two is sin(2w)
        gap = 2 * 2 * sine * cosine
        radius = _root_of(1 - cosine)
        tally.expect(attained(gap + shift, feature_difference_repaired, B=1, radius=radius), f"cos = {cosine}")
    return tally.outcome("pairs of policies attain the feature bounds")
