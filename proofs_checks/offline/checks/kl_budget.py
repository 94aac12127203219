"""T3, T10 and T13: KL divergences of trajectory laws, and the budget that counts certify for them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import comb, factorial, prod
from operator import itemgetter

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from bridge_theory import (
    hellinger_from_kl,
    hellinger_from_kl_with_exits,
    offline_radius_stochastic,
    policy_kl_budget,
    trajectory_kl,
    transition_error_counts,
    transition_kl_budget,
)
from bridge_theory.arithmetic.flint_balls import Ball, ball
from proofs_checks.context import Context
from proofs_checks.exact.certify import at_most, attained, value_of, within
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import (
    History,
    Law,
    kl_divergence,
    marginal,
    occupancies,
    row_kl,
    squared_hellinger,
    stationary_kernel,
    stationary_policy,
    trajectory_law,
)
from proofs_checks.exact.model import Model
from proofs_checks.exact.strategies import Row, Study, count_rows, rows, studies
from proofs_checks.offline.checks.maximum_likelihood import samples
from proofs_checks.outcome import Outcome, Tally

_FEW = (0, 1, 2, 3, 1000)


@st.composite
def _absolutely_continuous(draw: DrawFn) -> tuple[Model, Model, list[Row]]:
    """A true model whose rows are positive, an estimate, and one policy."""
    size, actions = draw(st.integers(1, 3)), draw(st.integers(1, 2))
    true, estimated = (
        tuple(tuple(draw(rows(size, weights)) for _ in range(actions)) for _ in range(size))
        for weights in ((1, 2, 1000), _FEW)
    )
    model = Model(draw(rows(size, _FEW)), true, draw(st.integers(1, 3)))
    return model, model.under(estimated), [draw(rows(actions, _FEW)) for _ in range(size)]


def _laws(instance: tuple[Model, Model, list[Row]]) -> tuple[Law, Law]:
    model, estimate, table = instance
    policy = stationary_policy(table)
    true, estimated = (
        trajectory_law(m.initial, policy, stationary_kernel(m.kernel), m.horizon, arrival=True)
        for m in (model, estimate)
    )
    return true, estimated


def _summed_row_kl(instance: tuple[Model, Model, list[Row]], estimated: Law) -> Ball:
    model, estimate, _ = instance
    return sum(
        (
            ball(p) * row_kl(estimate.kernel[s][a], model.kernel[s][a])
            for d in occupancies(estimated, model.horizon)
            for (s, a), p in d.items()
        ),
        start=ball(0),
    )


def chain_rule(*, weight: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """KL(P-hat^pi || P*^pi) = sum_t E_{P-hat} KL of the rows, to 360 digits; H^2 <= 1 - exp(-KL/2)."""

    def holds(instance: tuple[Model, Model, list[Row]]) -> bool:
        true, estimated = _laws(instance)

        def total() -> Ball:
            return kl_divergence(estimated, true)

        def summed() -> Ball:
            return ball(weight) * _summed_row_kl(instance, estimated)

        equal = at_most(total, summed) and at_most(summed, total)
        return equal and within(squared_hellinger(estimated, true), hellinger_from_kl, kl=summed)

    return on_every("KL chain rule", _absolutely_continuous(), holds, context.pick(quick=25, full=150))


def half_is_needed(*, half: Fraction = Fraction(1, 2)) -> Outcome:
    """1 - exp(-KL/2) is attained: P = Q given an event of probability q, H^2 = 1 - sqrt q, KL = log(1/q)."""
    tally = Tally()
    for keep in (Fraction(1, 2), Fraction(3, 5), Fraction(1, 10)):
        q = keep**2

        def kl(q: Fraction = q) -> Ball:
            return -ball(q).log() * ball(2 * half)

        tally.expect(attained(1 - keep, hellinger_from_kl, kl=kl), f"q = {q}")
    return tally.outcome("H^2 = 1 - exp(-KL/2) is attained")


@st.composite
def _with_exits(draw: DrawFn) -> tuple[tuple[Model, Model, list[Row]], frozenset[tuple[int, int]]]:
    model, estimate, table = draw(_absolutely_continuous())
    cells = [(s, a) for s in range(model.n_states) for a in range(model.n_actions)]
    exits = frozenset(draw(st.lists(st.sampled_from(cells), max_size=2)))
    # beyond an exit the truth may be anything, also disjoint from the estimate
    kernel = tuple(
        tuple(
            draw(rows(model.n_states, _FEW)) if (s, a) in exits else model.kernel[s][a] for a in range(model.n_actions)
        )
        for s in range(model.n_states)
    )
    return (model.under(kernel), estimate, table), exits


def exits(*, forgotten: Fraction = Fraction(0), context: Context = QUICK) -> Outcome:
    """T3 with exits: p = P-hat(use an exit), K = KL summed before it; H^2 below the formula."""

    def holds(case: tuple[tuple[Model, Model, list[Row]], frozenset[tuple[int, int]]]) -> bool:
        instance, outside = case
        model, estimate, table = instance
        true, estimated = _laws(instance)
        exit_mass = sum(
            (p for h, p in estimated.items() if _exit_step(h, outside, model.horizon) < model.horizon), Fraction(0)
        )
        if exit_mass == 1:
            return True

        def before_exit() -> Ball:
            total = ball(0)
            for t in range(model.horizon):
                law = trajectory_law(model.initial, stationary_policy(table), stationary_kernel(estimate.kernel), t + 1)
                for h, p in law.items():
                    if _exit_step(h, outside, t + 1) > t:
                        s, a = h[-2:]
                        total += ball(p) * row_kl(estimate.kernel[s][a], model.kernel[s][a])
            return total

        mass = exit_mass * (1 - forgotten)
        return within(squared_hellinger(estimated, true), hellinger_from_kl_with_exits, kl=before_exit, exit_mass=mass)

    return on_every("H^2 with exits", _with_exits(), holds, context.pick(quick=30, full=120))


def _exit_step(history: History, outside: frozenset[tuple[int, int]], steps: int) -> int:
    return next((t for t in range(steps) if history[2 * t : 2 * t + 2] in outside), steps)


def laplace_mixture(*, states: int = 0, context: Context = QUICK) -> Outcome:
    """The mixture's mass Q(x) of all samples is 1, and Q(x) C(N + S - 1, S - 1) >= prod (n_i/N)^{n_i} for each."""

    def holds(counts: tuple[int, ...]) -> bool:
        size, total = len(counts), sum(counts)
        cells = comb(total + size - 1 - states, size - 1)
        maximal = prod((Fraction(c, total) ** c for c in counts if c), start=Fraction(1))
        mass = sum(
            (factorial(total) // prod(map(factorial, c)) * _laplace(c) for c in samples(size, total)), Fraction(0)
        )
        return mass == 1 and _laplace(counts) * cells >= maximal

    cases = st.integers(2, 4).flatmap(count_rows).filter(any)
    return on_every("Laplace mixture", cases, holds, context.pick(quick=60, full=200))


def _laplace(counts: Sequence[int]) -> Fraction:
    size = len(counts)
    return Fraction(prod(map(factorial, counts)) * factorial(size - 1), factorial(sum(counts) + size - 1))


def crossing_probability(*, shrink: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """P(N KL(p-hat_N || p) exceeds the budget for some N <= 40) <= delta: exact dynamic programme over counts."""
    tally = Tally()
    last = context.pick(quick=40, full=120)
    for p, delta in (
        (Fraction(1, 2), Fraction(1, 2)),
        (Fraction(1, 10), Fraction(1, 2)),
        (Fraction(1, 100), Fraction(9, 10)),
    ):
        alive, crossed = {0: Fraction(1)}, Fraction(0)
        for n in range(1, last + 1):
            reached: dict[int, Fraction] = {}
            for heads, mass in alive.items():
                for step, chance in ((1, p), (0, 1 - p)):
                    reached[heads + step] = reached.get(heads + step, Fraction(0)) + mass * chance
            alive = {}
            for heads, mass in reached.items():
                if _exceeds(heads, n, p, delta, shrink):
                    crossed += mass
                else:
                    alive[heads] = mass
        tally.expect(crossed <= delta, f"crossed with probability {float(crossed):.3g} > {delta} for p = {p}")
    return tally.outcome(f"exact crossing probabilities up to N = {last}")


def _exceeds(heads: int, n: int, p: Fraction, delta: Fraction, shrink: Fraction) -> bool:
    empirical = (Fraction(heads, n), Fraction(n - heads, n))

    def weighted() -> Ball:
        return n * row_kl(empirical, (p, 1 - p))

    def budget() -> Ball:
        return ball(shrink) * value_of(transition_kl_budget, S=2, counts=(n,), delta=delta)

    return not at_most(weighted, budget)


def visits_equal_counts(*, offset: int = 0, context: Context = QUICK) -> Outcome:
    """The step-wise count estimate with the expert reproduces the empirical frequencies: m-hat_h(s) = N_h(s)/n."""

    def holds(study: Study) -> bool:
        law, n = empirical_law(study), len(study.demonstrations)
        for t in range(study.model.horizon):
            states = marginal(law, itemgetter(2 * t))
            counts = {s: sum(h[2 * t] == s for h in study.demonstrations) for s in range(study.model.n_states)}
            if states != {s: Fraction(c + offset, n) for s, c in counts.items() if c}:
                return False
        return True

    return on_every("visits under the step-wise estimate", studies(), holds, context.pick(quick=50, full=150))


def empirical_law(study: Study) -> Law:
    """The law under step-wise count estimates of kernel and policy and the empirical first state."""
    demonstrations, size = study.demonstrations, study.model.n_states

    def frequencies(prefixes: list[tuple[int, ...]], width: int) -> Row:
        counts = [sum(p == (k,) for p in prefixes) for k in range(width)]
        total = sum(counts)
        return tuple(Fraction(c, total) for c in counts)

    def policy(history: History) -> Row:
        t = len(history) // 2
        return frequencies(
            [h[2 * t + 1 : 2 * t + 2] for h in demonstrations if h[2 * t] == history[-1]], study.model.n_actions
        )

    def kernel(history: History) -> Row:
        t = len(history) // 2
        return frequencies([h[2 * t : 2 * t + 1] for h in demonstrations if h[2 * t - 2 : 2 * t] == history[-2:]], size)

    first = frequencies([h[:1] for h in demonstrations], size)
    return trajectory_law(first, policy, kernel, study.model.horizon)


def policy_divergence(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """KL(P-hat^{pi-hat} || P-hat^pi) = (1/n) sum N_h(s) KL(pi-hat_h(s) || pi_h(s)) under step-wise estimates."""

    def holds(instance: tuple[Study, list[Row]]) -> bool:
        study, expert = instance
        clone, n = empirical_law(study), len(study.demonstrations)
        other = {h: p * _policy_ratio(study, expert, h) for h, p in clone.items()}

        def cells() -> Ball:
            total = ball(0)
            for t in range(study.model.horizon):
                for s in range(study.model.n_states):
                    actions = [h[2 * t + 1] for h in study.demonstrations if h[2 * t] == s]
                    if actions:
                        counts = [actions.count(a) for a in range(study.model.n_actions)]
                        row = tuple(Fraction(c, len(actions)) for c in counts)
                        total += len(actions) * row_kl(row, expert[s])
            return ball(share) * total / n

        def divergence() -> Ball:
            return kl_divergence(clone, other)

        return at_most(cells, divergence) and at_most(divergence, cells)

    cases = studies(max_states=3, max_actions=2, max_horizon=3, noisy=True).flatmap(
        lambda s: st.tuples(st.just(s), st.tuples(*[rows(s.model.n_actions, (1, 2, 1000))] * s.model.n_states))
    )
    return on_every("policy divergence under the step-wise estimate", cases, holds, context.pick(quick=40, full=120))


def _policy_ratio(study: Study, expert: Sequence[Row], history: History) -> Fraction:
    """pi(a|s) over the frequency of a in s at each step, along one trajectory."""
    ratio = Fraction(1)
    for t in range(study.model.horizon):
        s, a = history[2 * t : 2 * t + 2]
        seen = [h[2 * t + 1] for h in study.demonstrations if h[2 * t] == s]
        ratio *= expert[s][a] / Fraction(seen.count(a), len(seen))
    return ratio


def policy_budget_formula(*, actions: int = 0) -> Outcome:
    """B_pi and the radius, from binomials computed in integers."""
    tally = Tally()
    for visits, delta in (((5, 0, 3), Fraction(1, 4)), ((1,), Fraction(1, 2)), ((20, 20, 7), Fraction(1, 100))):
        for n_actions in (2, 4):
            product_ = prod(comb(v + n_actions - 1 + actions, n_actions - 1 + actions) for v in visits if v)

            def budget(product_: int = product_, delta: Fraction = delta) -> Ball:
                return (ball(product_) / ball(delta)).log()

            same = attained(budget, policy_kl_budget, A=n_actions, visits=visits, delta=delta)
            tally.expect(same, f"the budget of {visits} for {n_actions} actions")

            def radius(b: Callable[[], Ball] = budget) -> Ball:
                return (1 - (-b() / 40).exp()).sqrt()

            same = attained(radius, offline_radius_stochastic, A=n_actions, n=20, visits=visits, delta=delta)
            tally.expect(same, f"the radius of {visits} for {n_actions} actions")

            def error(product_: int = product_, delta: Fraction = delta, extra: int = n_actions) -> Ball:
                first = comb(20 + extra - 1, extra - 1)
                return 1 - (-(ball(product_ * first) / ball(delta)).log() / 40).exp()

            same = attained(error, transition_error_counts, S=n_actions, n=20, counts=visits, delta=delta)
            tally.expect(same, f"the transition error of {visits}")

            def divergence(b: Callable[[], Ball] = budget) -> Ball:
                return b() / 4

            same = attained(divergence, trajectory_kl, S=n_actions, counts=visits, ratio=Fraction(1, 4), delta=delta)
            tally.expect(same, f"the trajectory divergence of {visits}")
    return tally.outcome("budgets from integers")
