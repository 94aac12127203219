"""From row errors to trajectory errors and back: T1 to T4, and the three steps of the paper's technical lemma."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from bridge_theory import (
    row_error_at_step,
    row_error_summed,
    trajectory_error_one_sided,
    trajectory_error_symmetrised,
)
from proofs_checks.context import Context
from proofs_checks.exact.certify import attained, within
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import (
    History,
    Law,
    marginal,
    occupancies,
    row_hellinger,
    squared_hellinger,
    stationary_kernel,
    stationary_policy,
    trajectory_law,
)
from proofs_checks.exact.model import Model, point
from proofs_checks.exact.strategies import Row, pairs, rows, square_rows
from proofs_checks.exact.surd import Surd, root, surd
from proofs_checks.outcome import Outcome, Tally


@st.composite
def two_kernels(draw: DrawFn, square: bool = False) -> tuple[Model, Model, list[Row]]:
    """A model, its estimate, and one policy; ``square`` makes every root rational (two states)."""
    if square:
        kernels = [tuple(tuple(draw(square_rows()) for _ in range(2)) for _ in range(2)) for _ in range(2)]
        model = Model(draw(rows(2)), kernels[0], draw(st.integers(1, 3)))
        estimate = model.under(kernels[1])
    else:
        pair = draw(pairs())
        model, estimate = pair.model, pair.estimate
    return model, estimate, [draw(rows(model.n_actions)) for _ in range(model.n_states)]


def _laws(instance: tuple[Model, Model, list[Row]], *, steps: int, arrival: bool) -> tuple[Law, Law]:
    model, estimate, table = instance
    policy = stationary_policy(table)
    true, estimated = (
        trajectory_law(m.initial, policy, stationary_kernel(m.kernel), steps, arrival=arrival)
        for m in (model, estimate)
    )
    return true, estimated


def identity(*, weight: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """T1: H^2 = sum_t sum_{s,a} g_t h with g_t <= sqrt(d d-hat), T = H transitions."""

    def holds(instance: tuple[Model, Model, list[Row]]) -> bool:
        model, estimate, _ = instance
        total = surd(0)
        for t in range(1, model.horizon + 1):
            true, estimated = _laws(instance, steps=t, arrival=False)
            overlap: dict[tuple[int, ...], Surd] = {}
            for history, mass in true.items():
                if history in estimated:
                    key = history[-2:]
                    overlap[key] = overlap.get(key, surd(0)) + root(mass * estimated[history])
            d, d_hat = (marginal(law, lambda h: h[-2:]) for law in (true, estimated))
            for (s, a), g in overlap.items():
                if g * g > d[s, a] * d_hat[s, a]:
                    return False
                total += g * row_hellinger(model.kernel[s][a], estimate.kernel[s][a]) * weight
        return total == squared_hellinger(*_laws(instance, steps=model.horizon, arrival=True))

    return on_every(
        "T1: sum of overlaps times row errors = H^2", two_kernels(), holds, context.pick(quick=40, full=130)
    )


def _tables(instance: tuple[Model, Model, list[Row]]) -> tuple[tuple[Fraction, ...], ...]:
    """Occupancies under both kernels and row errors, one entry per (step, state, action); roots must be rational."""
    model, estimate, _ = instance
    true, estimated = (occupancies(law, model.horizon) for law in _laws(instance, steps=model.horizon, arrival=False))
    cells = [
        (
            true[t].get((s, a), Fraction(0)),
            estimated[t].get((s, a), Fraction(0)),
            row_hellinger(model.kernel[s][a], estimate.kernel[s][a]).rational(),
        )
        for t in range(model.horizon)
        for s in range(model.n_states)
        for a in range(model.n_actions)
    ]
    return tuple(zip(*cells, strict=True))


def symmetrised_bound(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """T1: H^2 <= (1/2) sum_t sum (d-hat_t + d_t) h, by the formula of bridge_theory."""

    def holds(instance: tuple[Model, Model, list[Row]]) -> bool:
        d, d_hat, h = _tables(instance)
        truth = squared_hellinger(*_laws(instance, steps=instance[0].horizon, arrival=True))
        d = tuple(share * x for x in d)
        return within(truth, trajectory_error_symmetrised, occupancy=d, occupancy_hat=d_hat, row_errors=h)

    return on_every("T1 bound", two_kernels(square=True), holds, context.pick(quick=60, full=200))


def one_sided_bound(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """T2: H^2 <= 2.97 sum_t E[h] under either kernel, by the formula of bridge_theory."""

    def holds(instance: tuple[Model, Model, list[Row]]) -> bool:
        d, d_hat, h = _tables(instance)
        truth = squared_hellinger(*_laws(instance, steps=instance[0].horizon, arrival=True))
        return all(
            within(truth, trajectory_error_one_sided, occupancy=tuple(share * x for x in each), row_errors=h)
            for each in (d, d_hat)
        )

    return on_every("T2 bound", two_kernels(square=True), holds, context.pick(quick=60, full=200))


def two_step_ratio(*, constant: Fraction = Fraction(3)) -> Outcome:
    """H^2 <= constant * sum where one step leaves with probability p against q and the next parts for good."""
    tally = Tally()
    for finer in (1, 10, 100, 1000):
        (p_go, p_stay), (q_go, q_stay) = (circle(Fraction(k, 100 * finer)) for k in (12, 29))
        overlap = p_stay * q_stay
        row_error = 1 - overlap - p_go * q_go
        tally.expect(1 - overlap <= constant * (row_error + p_go**2), f"constant {constant} fails at p = {p_go**2}")
    return tally.outcome(f"two-step chains stay within {constant} times the sum")


def circle(t: Fraction) -> tuple[Fraction, Fraction]:
    """A rational point (sine, cosine) of the unit circle."""
    return 2 * t / (1 + t**2), (1 - t**2) / (1 + t**2)


def parting_chain(steps: int) -> tuple[Fraction, Fraction]:
    """H^2 and sum_t E_P[h_t] of the T-step chain that P leaves at rate 1 - y^2 and Q never, until both must part.

    State 0 is the chain, 1 and 2 are where P and Q end. With k steps to go y = (k - 1) / k, so y = 0 at the last.
    """

    def stay(history: History) -> Fraction:
        return Fraction(steps - len(history) // 2, steps - len(history) // 2 + 1)

    def p(history: History) -> Row:
        y = stay(history) ** 2
        return (y, 1 - y, Fraction(0)) if history[-2] == 0 else tuple(point(history[-2], 3))

    def q(history: History) -> Row:
        if history[-2]:
            return tuple(point(history[-2], 3))
        return tuple(point(0 if stay(history) else 2, 3))

    start, only = tuple(point(0, 3)), stationary_policy([(Fraction(1),)] * 3)
    laws = [trajectory_law(start, only, kernel, steps, arrival=True) for kernel in (p, q)]
    total = surd(0)
    for t in range(1, steps + 1):
        for history, mass in trajectory_law(start, only, p, t).items():
            total += row_hellinger(p(history), q(history)) * mass
    return squared_hellinger(*laws).rational(), total.rational()


def long_chains(*, constant: Fraction = Fraction(3)) -> Outcome:
    """On T-step chains H^2 / sum = 2T/(T + 1) exactly: no constant below 2 serves every horizon."""
    tally = Tally()
    for steps in (1, 2, 3, 5, 8, 13):
        distance, total = parting_chain(steps)
        tally.expect(distance * (steps + 1) == total * 2 * steps, f"the ratio at T = {steps} is not 2T/(T + 1)")
        tally.expect(distance <= constant * total, f"constant {constant} fails at T = {steps}")
    return tally.outcome("chains of ratio 2T/(T + 1)")


def row_errors_from_trajectories(*, ceiling: int = 2, context: Context = QUICK) -> Outcome:
    """T4: E_{d_t} h_t <= u (2 - u) at each step, and their sum <= u (1 + (T - 1)(2 - u))."""

    def holds(instance: tuple[Model, Model, list[Row]]) -> bool:
        model, estimate, _ = instance
        true, estimated = _laws(instance, steps=model.horizon, arrival=True)
        u = squared_hellinger(true, estimated)
        errors = [
            sum((row_hellinger(model.kernel[s][a], estimate.kernel[s][a]) * p for (s, a), p in d.items()), surd(0))
            for d in occupancies(true, model.horizon)
        ]
        each = all(error <= u * (ceiling - u) for error in errors)
        return each and sum(errors, surd(0)) <= u * (1 + (ceiling - u) * (model.horizon - 1))

    return on_every("T4", two_kernels(), holds, context.pick(quick=40, full=130))


def row_errors_are_attained(*, extra_steps: int = 0) -> Outcome:
    """T4 is attained: s_0 -> bad with probability p under one kernel and 0 under the other, disjoint rows in bad."""
    tally = Tally()
    for keep, steps in ((Fraction(3, 4), 2), (Fraction(1, 2), 3), (Fraction(12, 13), 5), (Fraction(0), 2)):
        u, leave = 1 - keep, 1 - keep**2
        tally.expect(attained(leave, row_error_at_step, R=u), f"one step is not attained at u = {u}")
        total = u + (steps - 1 + extra_steps) * leave
        tally.expect(attained(total, row_error_summed, R=u, H=steps), f"the sum is not attained at u = {u}")
    return tally.outcome("T4 with equality")
