"""T5: the sharp concentrability bound, and what the paper's weaker one follows from."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from bridge_theory import concentrability_deterministic, concentrability_sharp, concentrability_stated
from bridge_theory.arithmetic.flint_balls import ball
from bridge_theory.bound import Bound
from proofs_checks.balls import Ball, prove_positive
from proofs_checks.context import Context
from proofs_checks.exact.certify import attained, value_of, within
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import Choice, Law, occupancies, squared_hellinger
from proofs_checks.exact.model import Model
from proofs_checks.exact.strategies import Pair, choices, models, pairs
from proofs_checks.exact.surd import Surd
from proofs_checks.outcome import Outcome, Tally, together
from proofs_checks.smt import prove, reals


def two_point_inequality(*, slack: int = 0) -> Outcome:
    """sqrt d <= c sqrt d* + s sqrt(1 - d*) where sqrt(d d*) + sqrt((1 - d)(1 - d*)) >= c, c^2 + s^2 = 1, d* <= c^2.

    And for d* >= c^2: 1 <= sqrt(d*) (c + q) wherever q^2 gamma = s^2 (1 - gamma), gamma <= c^2. Angles without angles.
    """
    x, y, z, w, c, s = reals("x y z w c s")
    circle = [x * x + y * y == 1, z * z + w * w == 1, c * c + s * s == 1]
    positive = [v >= 0 for v in (x, y, z, w, c, s)]
    near = prove("d* <= (1 - R)^2", [*circle, *positive, x * z + y * w >= c, z <= c], x <= c * z + (s - slack) * w)
    q, g = reals("q g")
    edge = [c * c + s * s == 1, c > 0, s >= 0, q >= 0, g > 0, g <= c * c, q * q * g == s * s * (1 - g)]
    far = prove("d* >= (1 - R)^2", edge, c * (c + q) >= 1 + slack)
    u, v, h = reals("u v h")
    rarer = [u > 0, u <= 1, v > 0, v <= 1, h > 0, h <= u * u, u * u + v * v == 1, q >= 0, q * q * h == 1 - h]
    cotangent = prove("cot falls", rarer, v <= (q - slack) * u)
    return together(near, far, cotangent)


def weaker_forms(*, factor: Fraction = Fraction(2)) -> Outcome:
    """The sharp bound is at most 1 + sqrt(2 R)/g, which is at most 1 + factor sqrt(R)/g, for all R and g in (0, 1].

    It is (1 - R + sqrt(R (2 - R)(1 - g)/g))^2 for g <= (1 - R)^2 and 1/g beyond; with c = 1 - R and s^2 = R (2 - R).
    """
    c, s, q, r, g, root2r = reals("c s q r g root2r")
    setting = [c >= 0, s >= 0, r >= 0, g > 0, g <= 1, root2r >= 0, root2r * root2r == 2 * r, r == 1 - c]
    near = [c > 0, q >= 0, g <= c * c, q * q * g == s * s * (1 - g), c * c + s * s == 1]
    claim = prove("g <= (1 - R)^2: below 1 + sqrt(2R)/g", [*setting, *near], (c + q) * (c + q) * g <= g + root2r)
    beyond = prove("g >= (1 - R)^2: 1/g below 1 + sqrt(2R)/g", [*setting, g >= c * c], g + root2r >= 1)
    f = factor.numerator, factor.denominator
    stated = prove(
        "sqrt 2 below the factor",
        [root2r >= 0, r >= 0, root2r * root2r == 2 * r, q >= 0, q * q == r],
        root2r * f[1] <= f[0] * q,
    )
    return together(claim, beyond, stated)


def sharp_below_stated(*, factor: Fraction = Fraction(1)) -> Outcome:
    """bridge_theory's sharp formula is below factor times its stated one on a box of (R, gamma)."""

    def gap(R: Ball, gamma_min: Ball) -> Ball:
        stated = value_of(concentrability_stated, R=lambda: R, gamma_min=lambda: gamma_min)
        return stated * ball(factor) - value_of(concentrability_sharp, R=lambda: R, gamma_min=lambda: gamma_min)

    box = {"R": (Fraction(1, 1000), Fraction(99, 100)), "gamma_min": (Fraction(1, 1000), Fraction(99, 100))}
    return prove_positive("1 + 2 sqrt(R)/gamma - C(R, gamma)", gap, box, geometric=("R", "gamma_min"))


@st.composite
def _policies(draw: DrawFn) -> tuple[Model, Choice, Choice]:
    model = draw(models())
    return model, draw(choices(model)), draw(choices(model))


def _extremes(expert: Law, other: Law, horizon: int) -> tuple[Fraction, Fraction]:
    """The concentrability coefficient and the expert's smallest positive visitation."""
    pairs_ = list(zip(occupancies(expert, horizon), occupancies(other, horizon), strict=True))
    ratio = max(o.get(key, Fraction(0)) / p for e, o in pairs_ for key, p in e.items())
    return ratio, min(p for e, _ in pairs_ for p in e.values())


def holds_for_all_policies(
    *, formula: Bound = concentrability_sharp, share: Fraction = Fraction(1), context: Context = QUICK
) -> Outcome:
    """C <= formula(H^2, gamma) for stochastic and history-dependent policies; ``share`` shrinks the distance."""

    def holds(instance: tuple[Model, Choice, Choice]) -> bool:
        model, expert, other = instance
        laws = model.law(expert), model.law(other)
        distance: Surd = squared_hellinger(*laws) * share
        ratio, gamma = _extremes(*laws, model.horizon)
        return within(ratio, formula, R=distance, gamma_min=gamma)

    return on_every(f"C <= {formula.name}", _policies(), holds, context.pick(quick=60, full=200))


def holds_for_deterministic_policies(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """C <= 1 + R/gamma for deterministic policies."""

    def holds(pair: Pair) -> bool:
        laws = pair.model.law(pair.expert), pair.model.law(pair.clone)
        ratio, gamma = _extremes(*laws, pair.model.horizon)
        return within(ratio, concentrability_deterministic, R=squared_hellinger(*laws) * share, gamma_min=gamma)

    return on_every("C <= 1 + R/gamma", pairs(), holds, context.pick(quick=60, full=200))


def attained_by_two_actions(*, shift: Fraction = Fraction(0)) -> Outcome:
    """One step, two actions with rational roots: the ratio equals the sharp bound."""
    tally = Tally()
    for k, j in ((7, 15), (1, 3), (5, 12), (3, 20)):  # rational points on the circle, angle of d* below that of d
        rare, likely = (Fraction(2 * m * 25, m * m + 625) for m in (min(k, j), max(k, j)))
        rest_rare, rest_likely = (Fraction(625 - m * m, m * m + 625) for m in (min(k, j), max(k, j)))
        distance = 1 - rare * likely - rest_rare * rest_likely
        ratio = (likely / rare) ** 2 + shift
        tally.expect(attained(ratio, concentrability_sharp, R=distance, gamma_min=rare**2), f"gamma = {rare**2}")
    exact = attained(Fraction(225, 49) + shift, concentrability_sharp, R=Fraction(8, 125), gamma_min=Fraction(49, 625))
    tally.expect(exact, "225/49 at R = 8/125, gamma = 49/625")
    return tally.outcome("one-step pairs attain the sharp bound")


def deterministic_is_attained(*, moved: Fraction = Fraction(1, 4)) -> Outcome:
    """C = 1 + R/gamma: half the start reaches X with probability gamma; the clone sends another quarter there."""
    tally = Tally()
    none, one, start = Fraction(0), Fraction(1), (Fraction(3, 4), Fraction(1, 4), Fraction(0), Fraction(0))
    for gamma in (Fraction(1, 10), Fraction(1, 5), Fraction(1, 4)):
        split = gamma / start[0]
        to_x, to_z = (none, none, one, none), (none, none, none, one)
        kernel = (((none, none, split, 1 - split),) * 2, (to_z, to_x), (to_x,) * 2, (to_z,) * 2)
        model = Model(start, kernel, 2)
        expert, clone = model.law((0, 0, 0, 0)), model.law((0, 1, 0, 0))
        ratio, rarest = _extremes(expert, clone, 2)
        tally.expect(rarest == gamma and squared_hellinger(expert, clone) == Fraction(1, 4), "the instance is another")
        tally.expect(attained(ratio, concentrability_deterministic, R=moved, gamma_min=rarest), f"gamma = {gamma}")
    return tally.outcome("C = 1 + R/gamma is attained")
