"""The main theorem's radius: where it says something, how it scales, and that the proved radii are below it."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from itertools import product

from bridge_theory import (
    alpha_offline,
    beta_offline,
    confidence_set_radius,
    feature_difference_squared_stated,
    offline_radius,
    offline_radius_appendix,
    offline_radius_corollaries,
    offline_radius_known,
    offline_radius_repaired,
    offline_radius_repaired_angle,
    policy_error_corollary,
    policy_error_stated,
    transition_error_rate,
    transition_error_stated,
)
from bridge_theory.arithmetic.flint_balls import Ball, ball
from proofs_checks.exact.certify import Number, at_most, scaled, value_of
from proofs_checks.outcome import Outcome, Tally

_BASE: dict[str, Fraction | int] = {"S": 5, "A": 4, "H": 8, "delta": Fraction(1, 20)}


def first_useful_n(*, one: Fraction = Fraction(1)) -> Outcome:
    """Smallest n with a radius below 1 at (S, A, H, delta) = (5, 4, 8, 1/20): stated, corollaries' and proved."""
    tally = Tally()
    for formula, n, extra in (
        (offline_radius, 150158, {"gamma_min": Fraction(1, 10)}),
        (offline_radius, 364775, {"gamma_min": Fraction(1, 100)}),
        (offline_radius_corollaries, 229910, {"gamma_min": Fraction(1, 10)}),
        (offline_radius_corollaries, 556379, {"gamma_min": Fraction(1, 100)}),
        (offline_radius_repaired, 735, {"rows": 5}),
        (offline_radius_repaired, 2565, {"rows": 20}),
    ):
        values = {k: v for k, v in (_BASE | extra).items() if k in formula.parameters}
        below = at_most(partial(value_of, formula, n=n, **values), one)
        above = at_most(one, partial(value_of, formula, n=n - 1, **values))
        tally.expect(below and above, f"{formula.name} does not fall below {one} at n = {n} for {extra}")
    return tally.outcome("first informative sample sizes")


def radius_is_the_lemma(*, half: Fraction = Fraction(1, 2)) -> Outcome:
    """The theorem's radius is the lemma's at R1(delta/2), R2(delta/2), in both places where the paper states it."""
    tally = Tally()
    for n, gamma, delta in product((2, 1000), (Fraction(1, 10), Fraction(1)), (Fraction(1, 20), Fraction(1, 3))):
        values = {**_BASE, "delta": delta, "n": n, "gamma_min": gamma}

        def composed(n: int = n, gamma: Fraction = gamma, delta: Fraction = delta) -> Ball:
            share = delta * half
            return value_of(
                confidence_set_radius,
                R1=lambda: value_of(policy_error_stated, S=5, A=4, n=n, delta1=share),
                R2=lambda: value_of(transition_error_stated, S=5, A=4, H=8, n=n, delta2=share),
                H=8,
                gamma_min=gamma,
            )

        for formula in (offline_radius, offline_radius_appendix):
            tally.expect(_same(composed, partial(value_of, formula, **values)), f"{formula.name} at {values}")
    return tally.outcome("the radius of the theorem is the radius of the lemma")


def constants_and_corollaries(*, four: int = 4, six: int = 6) -> Outcome:
    """alpha = sqrt(four S log(2A/delta)), beta = sqrt(four S^2 A log(2nH/delta)); the corollaries' radius has six."""
    tally = Tally()
    for n, delta in product((3, 500), (Fraction(1, 20), Fraction(1, 2))):

        def alpha(delta: Fraction = delta) -> Ball:
            return (four * 5 * (ball(8) / ball(delta)).log()).sqrt()

        def beta(n: int = n, delta: Fraction = delta) -> Ball:
            return (four * 25 * 4 * (ball(16 * n) / ball(delta)).log()).sqrt()

        tally.expect(_same(alpha, partial(value_of, alpha_offline, S=5, A=4, delta=delta)), "alpha")
        same = _same(beta, partial(value_of, beta_offline, S=5, A=4, H=8, n=n, delta=delta))
        tally.expect(same, "beta")

        def with_six(n: int = n, delta: Fraction = delta) -> Ball:
            r1 = ball(six * 5) * (ball(8) / ball(delta)).log() / n
            r2 = ball(six * 100) * (ball(16 * n) / ball(delta)).log() / n
            return r1.sqrt() + r2.sqrt() * (1 + (8 * (1 + 2 * r1.sqrt() / ball(Fraction(1, 10)))).sqrt())

        def corollaries(n: int = n, delta: Fraction = delta) -> Ball:
            return value_of(offline_radius_corollaries, **{**_BASE, "delta": delta}, n=n, gamma_min=Fraction(1, 10))

        tally.expect(_same(with_six, corollaries), f"the corollaries' radius at n = {n}")
    return tally.outcome("constants of the radius")


def known_dynamics(*, six: int = 6, diameter: int = 192) -> Outcome:
    """Radius^2 = six S log(A/delta)/n; ||dphi||^2 <= 8 B^2 (2 radius)^2 = 192 B^2 S log(A/delta)/n."""
    tally = Tally()
    for n, delta in product((10, 5000), (Fraction(1, 20), Fraction(1, 2))):

        def squared(n: int = n, delta: Fraction = delta) -> Ball:
            return ball(Fraction(six * 5, n)) * (ball(4) / ball(delta)).log()

        def stated(n: int = n, delta: Fraction = delta) -> Ball:
            return value_of(offline_radius_known, S=5, A=4, n=n, delta=delta) ** 2

        tally.expect(_same(squared, stated), f"the radius at n = {n}")
        same = _same(stated, partial(value_of, policy_error_corollary, S=5, A=4, n=n, delta=delta))
        tally.expect(same, "the corollary's error")

        def feature(n: int = n, delta: Fraction = delta) -> Ball:
            return value_of(feature_difference_squared_stated, B=3, S=5, A=4, n=n, delta=delta)

        def multiple(n: int = n, delta: Fraction = delta) -> Ball:
            return ball(Fraction(diameter, 6) * 9) * stated(n, delta)

        tally.expect(_same(feature, multiple), f"features at n = {n}")
    return tally.outcome("known dynamics")


def growing_scaled_radius(*, exponent: Fraction = Fraction(1, 2)) -> Outcome:
    """sqrt(n) * Radius is 373, 405, 453 at n = 10^6, 10^9, 10^12: the radius is not O(1/sqrt n)."""
    tally = Tally()
    values = [10**6, 10**9, 10**12]
    scaled = []
    for n in values:

        def product_(n: int = n) -> Ball:
            return ball(n) ** ball(exponent) * value_of(offline_radius, **_BASE, n=n, gamma_min=Fraction(1, 10))

        scaled.append(product_)
    tally.expect(
        at_most(scaled[0], scaled[1]) and at_most(scaled[1], scaled[2]), "sqrt(n) times the radius does not rise"
    )
    for low, product_, high in ((372, scaled[0], 374), (404, scaled[1], 406), (452, scaled[2], 454)):
        tally.expect(at_most(low, product_) and at_most(product_, high), f"not between {low} and {high}")
    return tally.outcome("sqrt(n) times the radius")


def proved_below_stated(*, factor: Fraction = Fraction(1)) -> Outcome:
    """Wherever the stated radius is below 1, the proved radii are below it."""
    tally = Tally()
    for gamma in (Fraction(1, 100), Fraction(1, 2)):
        for n in (4 * 10**5, 10**7):

            def stated(n: int = n, gamma: Fraction = gamma) -> Ball:
                return ball(factor) * value_of(offline_radius, **_BASE, n=n, gamma_min=gamma)

            for formula in (offline_radius_repaired, offline_radius_repaired_angle):
                proved = partial(value_of, formula, S=5, H=8, n=n, delta=Fraction(1, 20), rows=20)
                tally.expect(at_most(proved, stated), f"{formula.name} exceeds the stated radius at n = {n}")
    return tally.outcome("the proved radii")


def rate_has_unit_constant(*, constant: int = 1) -> Outcome:
    """The O-form is S^2 A log(nH/delta)/n with unit constant; four times it is R_2."""
    tally = Tally()
    for n in (10, 999):
        delta, size = Fraction(1, 10), {"S": 3, "A": 2, "H": 5, "n": n}
        four_rates = partial(scaled, Fraction(4 * constant), transition_error_rate, delta=delta, **size)
        tally.expect(_same(four_rates, partial(value_of, transition_error_stated, delta2=delta, **size)), f"n = {n}")
    return tally.outcome("O-form of the transition error")


def _same(left: Number, right: Number) -> bool:
    return at_most(left, right) and at_most(right, left)
