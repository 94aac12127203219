"""Transition bonuses: where the paper's has no value, and the L1 bonus of R6 with its sums (R7)."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

import bridge_theory as theory
from proofs_checks.context import Context
from proofs_checks.coverage import Coverage
from proofs_checks.outcome import Outcome, Tally, together

_SIZE: dict[str, Any] = {"S": 5, "A": 4, "H": 8, "eta": 1, "delta": Fraction(1, 20)}


def undefined_counts(*, counts: tuple[int, ...] = (0, 1)) -> Outcome:
    """6 log N / delta is not positive, so its logarithm has no real value, and the package refuses to give one."""
    import sympy

    tally = Tally()
    for N in counts:
        inner = 6 * sympy.log(sympy.Integer(N)) / sympy.Rational(1, 20)
        tally.expect(inner.is_positive is not True, f"log log N has a value at N = {N}")
        tally.expect(not _has_value((N, N)), f"the package gives a bonus at N = {N}")
        tally.expect(not _has_value((N,)), f"the package evaluates xi at N = {N}")
    for cells, wanted in (((1000, 1), False), ((2, 1000), True)):
        tally.expect(
            _has_value(cells) == wanted, f"the bonus of a policy with counts {cells} has a value: {not wanted}"
        )
    return tally.outcome(f"N in {counts}")


def _has_value(counts: tuple[int, ...]) -> bool:
    """Whether the package evaluates the bonus of a policy on these cells; for a single cell, xi itself."""
    from bridge_theory.errors import UndefinedInPaperError

    try:
        if len(counts) == 1:
            theory.xi.enclosure(N=counts[0], **_SIZE)
        else:
            theory.empirical_bonus.estimate(occupancy=(0.5, 0.5), counts=counts, **{**_SIZE, "delta": 0.05})
    except UndefinedInPaperError:
        return False
    return True


def undefined_first_round(*, first: int = 1) -> Outcome:
    """log(6 log t / delta) has no value in round 1."""
    import sympy

    tally = Tally()
    tally.expect((6 * sympy.log(sympy.Integer(first))).is_positive is not True, f"log log t has a value at t = {first}")
    return tally.outcome(f"t = {first}")


def linear_in_eta(*, factor: int = 2) -> Outcome:
    """xi(2 eta) = 2 xi(eta) at every setting: the formula of the package is a minimum, and both arguments double."""
    import sympy

    from bridge_theory.symbolic import symbol_for
    from proofs_checks.symbolic import identity

    eta, expression = symbol_for("eta"), theory.xi.expression()
    tally = Tally()
    tally.expect(expression.func is sympy.Min and len(expression.args) == 2, f"xi is no minimum of two: {expression}")
    doubled = [identity("argument", part.subs(eta, 2 * eta), factor * part) for part in expression.args]
    return together(tally.outcome("xi is a minimum"), *doubled)


def relation_of_bonuses(*, factor: int = 2) -> Outcome:
    """B_hat <= 2 B(2 H eta) + epsilon from uniformity over f = sum of xi, and the centred form with 1 + 1/H."""
    from proofs_checks.smt import prove, reals

    empirical, mean, true, epsilon, H = reals("empirical mean true epsilon H")
    common = [true >= 0, epsilon > 0, empirical <= mean + true + epsilon]
    tally = Tally()
    for value, wanted in ((Fraction(2), Fraction(factor)), (1 + Fraction(1, 4), 1 + Fraction(factor - 1, 4))):
        bound = theory.empirical_from_true_bonus if value == 2 else theory.empirical_from_true_bonus_sharp
        given: dict[str, Any] = {"true_bonus": 1, "epsilon": 1, "delta": Fraction(1, 2)}
        enclosed = bound.enclosure(**given) if value == 2 else bound.enclosure(H=4, **given)
        tally.expect(float(wanted + 1) in enclosed, f"{bound.name} is {enclosed}, not {wanted + 1}")
    return together(
        prove("as stated", [*common, mean <= true], empirical <= factor * true + epsilon),
        prove(
            "centred", [*common, H >= 1, mean * H <= true], empirical * H <= (factor - 1) * (H + 1) * true + epsilon * H
        ),
        tally.outcome("both formulas"),
    )


def hybrid_argument(context: Context, *, share: Fraction | float = Fraction(1, 2)) -> Outcome:
    """TV(P^pi, Q^pi) <= half the expected L1 errors of the rows met in steps 1 to H-1, under either kernel, exactly."""
    from hypothesis import strategies as st

    from proofs_checks.exact import strategies
    from proofs_checks.exact.every import on_every
    from proofs_checks.exact.laws import total_variation

    @st.composite
    def instances(draw: Any) -> Any:
        pair = draw(strategies.pairs())
        return pair, draw(strategies.choices(pair.model))

    def holds(instance: Any) -> bool:
        pair, policy = instance
        true, estimated = pair.model.law(policy), pair.estimate.law(policy)
        distance = total_variation(true, estimated)
        return all(distance <= share * _expected(law, pair, _row_error) for law in (true, estimated))

    return on_every("hybrid argument", instances(), holds, context.pick(quick=40, full=200))


def estimated_sum(context: Context, *, factor: Fraction | int = 1) -> Outcome:
    """Radii no smaller than the L1 errors: their sum under the estimate is at most H times the one under the truth."""
    from hypothesis import strategies as st

    from proofs_checks.exact import strategies
    from proofs_checks.exact.every import on_every

    @st.composite
    def instances(draw: Any) -> Any:
        pair = draw(strategies.pairs())
        slack = [[draw(st.fractions(0, 1, max_denominator=3)) for _ in row] for row in pair.model.kernel]
        return pair, slack

    def holds(instance: Any) -> bool:
        pair, slack = instance

        def radius(pair: Any, s: int, a: int) -> Fraction:
            return Fraction(min(Fraction(2), _row_error(pair, s, a) + slack[s][a]))

        under_truth = _expected(pair.model.law(pair.clone), pair, radius)
        under_estimate = _expected(pair.estimate.law(pair.clone), pair, radius)
        bound = theory.estimated_radius_sum.enclosure(
            H=pair.model.horizon, delta_P=Fraction(1, 2), true_bonus=under_truth
        )
        return under_estimate <= factor * Fraction(bound.upper)

    return on_every("estimated radii", instances(), holds, context.pick(quick=40, full=200))


def rows_are_covered(context: Context, *, scale: float = 1.0) -> Outcome:
    """Every estimated row is within epsilon_N of the true one for all pairs and all N <= 300 at once, delta = 1/10."""
    runs, steps, S, A, delta = context.pick(quick=200, full=1000), 300, 3, 2, Fraction(1, 10)
    rng = context.rng()
    counts = np.arange(1, steps + 1)
    radius = scale * theory.bonus_radius.estimate(S=S, A=A, delta_P=float(delta), N=counts)
    failed = np.zeros(runs, dtype=bool)
    for _ in range(S * A):
        rows = rng.dirichlet(np.full(S, 0.7), size=runs)
        drawn = (rng.random((runs, steps))[:, :, None] > rows.cumsum(axis=1)[:, None, :-1]).sum(axis=2)
        frequencies = (drawn[:, :, None] == np.arange(S)).cumsum(axis=1) / counts[:, None]
        failed |= (np.abs(frequencies - rows[:, None]).sum(axis=2) > radius).any(axis=1)
    return Coverage(delta, runs, int(failed.sum())).outcome("all rows, all counts")


def weights_sum_to_one(*, shift: int = 1) -> Outcome:
    """sum over N >= 1 of 1/(N(N+1)) = 1: the union over counts costs delta_P once."""
    import sympy

    from proofs_checks.symbolic import identity

    N, M = sympy.symbols("N M", positive=True, integer=True)
    return together(
        identity("telescoping", 1 / (N * (N + shift)), 1 / N - 1 / (N + 1)),
        identity("partial sums", sympy.Sum(1 / N - 1 / (N + 1), (N, 1, M)).doit(), 1 - 1 / (M + 1)),
    )


def batches(context: Context, *, first: int = 4, square: int = 2) -> Outcome:
    """Radii that are frozen within a round sum to at most 4m 1{N_off < m} + 2 sqrt(2L)(sqrt(N_off+N) - sqrt(N_off))."""
    from hypothesis import strategies as st

    from bridge_theory.arithmetic.flint_balls import ball
    from proofs_checks.exact.certify import at_most
    from proofs_checks.exact.every import on_every

    instances = st.tuples(
        st.integers(0, 30), st.lists(st.integers(0, 4), min_size=1, max_size=25), st.sampled_from(["1/10", "3", "50"])
    )

    def holds(instance: tuple[int, list[int], str]) -> bool:
        offline, rounds, text = instance
        size, batch, last = Fraction(text), 4, offline + sum(rounds)

        def total() -> Any:
            result, seen = ball(0), offline
            for visits in rounds:
                result += visits * (ball(2) if 4 * seen <= size else (ball(size) / seen).sqrt())
                seen += visits
            return result

        def bound() -> Any:
            early = first * batch if offline < batch else 0
            return early + 2 * ball(square * size).sqrt() * (ball(last).sqrt() - ball(offline).sqrt())

        return at_most(total, bound)

    return on_every("batches of visits", instances, holds, context.pick(quick=150, full=1000))


def drift_identity(*, power: int = 2) -> Outcome:
    """t/(n+t)^2 + t^2/((n+t)^2 n) = t/(n(n+t)), and its sum over t <= T is T/n - (H_{n+T} - H_n)."""
    import sympy

    from proofs_checks.symbolic import identity

    t, n = sympy.symbols("t n", positive=True)
    tally = Tally()
    for demonstrations, rounds in ((1, 1), (3, 7), (10, 4)):
        total = sum((Fraction(i, demonstrations * (demonstrations + i)) for i in range(1, rounds + 1)), Fraction(0))
        harmonic = sum((Fraction(1, demonstrations + i) for i in range(1, rounds + 1)), Fraction(0))
        tally.expect(total == Fraction(rounds, demonstrations) - harmonic, f"n = {demonstrations}, T = {rounds}")
    return together(
        identity("one term", t / (n + t) ** 2 + t**power / ((n + t) ** 2 * n), t / (n * (n + t))),
        tally.outcome("sums"),
    )


def three_terms(*, factor: int = 3) -> Outcome:
    """(a + b + c)^2 <= 3 (a^2 + b^2 + c^2)."""
    from proofs_checks.smt import prove, reals

    a, b, c = reals("a b c")
    return prove("three terms", [], (a + b + c) * (a + b + c) <= factor * (a * a + b * b + c * c))


def _row_error(pair: Any, s: int, a: int) -> Fraction:
    rows = zip(pair.model.kernel[s][a], pair.estimate.kernel[s][a], strict=True)
    return sum((abs(p - q) for p, q in rows), Fraction(0))


def _expected(law: Any, pair: Any, cost: Any) -> Fraction:
    """E of the summed costs of the pairs met in steps 1 to H-1."""
    steps = range(pair.model.horizon - 1)
    return sum((p * cost(pair, h[2 * k], h[2 * k + 1]) for h, p in law.items() for k in steps), Fraction(0))
