"""T7: the clone's error is the mass of trajectories that meet a state without data, and how large that is."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import product
from math import comb
from operator import itemgetter

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from bridge_theory import missing_mass_expected, missing_mass_observed, policy_error_repaired, policy_error_sharp
from proofs_checks.context import Context
from proofs_checks.exact.certify import attained, within
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import History, marginal, probability_of_hitting, squared_hellinger, total_variation
from proofs_checks.exact.model import Model
from proofs_checks.exact.strategies import Pair, actions_of, models, pairs
from proofs_checks.outcome import Outcome, Tally

States = frozenset[int]


@st.composite
def _experts(draw: DrawFn) -> tuple[Model, tuple[int, ...], int]:
    model = draw(models(max_states=4, max_actions=1))
    return model, draw(actions_of(model)), draw(st.integers(1, 4))


def visited_law(model: Model, expert: tuple[int, ...]) -> dict[States, Fraction]:
    """The law of the set of states that a trajectory visits."""
    return marginal(model.law(expert), visited)


def visited(history: History) -> States:
    """The states of one trajectory."""
    return frozenset(history[::2])


def union_law(single: Mapping[States, Fraction], n: int) -> dict[States, Fraction]:
    """The law of the set of states that n independent trajectories visit."""
    law: dict[States, Fraction] = {frozenset(): Fraction(1)}
    for _ in range(n):
        wider: dict[States, Fraction] = {}
        for seen, p in law.items():
            for new, q in single.items():
                wider[seen | new] = wider.get(seen | new, Fraction(0)) + p * q
        law = wider
    return law


def missing_mass(single: Mapping[States, Fraction], seen: States) -> Fraction:
    """The probability that a fresh trajectory leaves the states that were seen."""
    return sum((p for states, p in single.items() if not states <= seen), Fraction(0))


def error_is_disagreement(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """H^2 = TV = P*(hit D) for two deterministic policies under one kernel."""

    def holds(pair: Pair) -> bool:
        model = pair.model
        expert, clone = model.law(pair.expert), model.law(pair.clone)
        differ = {s for s in range(model.n_states) if pair.expert[s] != pair.clone[s]}
        hit = share * probability_of_hitting(expert, differ, model.horizon)
        return squared_hellinger(expert, clone) == hit == total_variation(expert, clone)

    return on_every("H^2 = TV = P(hit D)", pairs(), holds, context.pick(quick=60, full=200))


def expectation(*, dropped: int = 0, context: Context = QUICK) -> Outcome:
    """E M <= sum_s q_s (1 - q_s)^n <= the formula with S states."""

    def holds(instance: tuple[Model, tuple[int, ...], int]) -> bool:
        model, expert, n = instance
        single = visited_law(model, expert)
        mean = sum((p * missing_mass(single, seen) for seen, p in union_law(single, n).items()), Fraction(0))
        reach = [sum((p for states, p in single.items() if s in states), Fraction(0)) for s in range(model.n_states)]
        union = sum((q * (1 - q) ** (n + dropped) for q in reach), Fraction(0))
        return mean <= union and within(union, missing_mass_expected, S=model.n_states, n=n)

    return on_every("expected missing mass", _experts(), holds, context.pick(quick=60, full=200))


def expectation_is_attained(*, shift: Fraction = Fraction(0)) -> Outcome:
    """First state uniform over n + 1 states, horizon 1: E M equals the formula."""
    tally = Tally()
    for n in (1, 2, 3, 4):
        size = n + 1
        single = {frozenset({s}): Fraction(1, size) for s in range(size)}
        mean = sum((p * missing_mass(single, seen) for seen, p in union_law(single, n).items()), Fraction(0))
        tally.expect(attained(mean + shift, missing_mass_expected, S=size, n=n), f"n = {n}")
    return tally.outcome("the expected missing mass is attained")


def tail(*, base: int = 2, context: Context = QUICK) -> Outcome:
    """P(M >= m) <= (base^S - 1)(1 - m)^n at every value m > 0 that M takes."""

    def holds(instance: tuple[Model, tuple[int, ...], int]) -> bool:
        model, expert, n = instance
        single = visited_law(model, expert)
        law = [(missing_mass(single, seen), p) for seen, p in union_law(single, n).items()]
        subsets = base**model.n_states - 1
        return all(
            sum((p for mass, p in law if mass >= value), Fraction(0)) <= subsets * (1 - value) ** n
            for value in {mass for mass, _ in law if mass}
        )

    return on_every("tail of the missing mass", _experts(), holds, context.pick(quick=60, full=200))


def observed_tail(*, scale: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """With k states unseen, P(S C(S, k) (1 - M)^n <= z) <= z at every attained z: the data-dependent bound."""

    def holds(instance: tuple[Model, tuple[int, ...], int]) -> bool:
        model, expert, n = instance
        single, size = visited_law(model, expert), model.n_states
        law = []
        for seen, p in union_law(single, n).items():
            unseen = size - len(seen)
            if unseen:
                law.append((scale * size * comb(size, unseen) * (1 - missing_mass(single, seen)) ** n, p))
        return all(sum((p for z, p in law if z <= value), Fraction(0)) <= value for value, _ in law if value < 1)

    return on_every("data-dependent tail", _experts(), holds, context.pick(quick=60, full=200))


def good_turing(*, left_out: int = 1, context: Context = QUICK) -> Outcome:
    """E[(1/n) #{i : tau_i meets a state that no other meets}] = E M_{n-1} >= E M_n, by enumeration of the samples."""

    def holds(instance: tuple[Model, tuple[int, ...], int]) -> bool:
        model, expert, n = instance
        single = visited_law(model, expert)
        samples = _samples(single, n)
        unique = sum((p * Fraction(_unlike_any_other(sample), n) for sample, p in samples), Fraction(0))
        means = [
            sum((p * missing_mass(single, seen) for seen, p in union_law(single, k).items()), Fraction(0))
            for k in (n - left_out, n)
        ]
        return unique == means[0] >= means[1]

    cases = _experts().filter(lambda instance: instance[2] <= 3)
    return on_every("Good-Turing identity", cases, holds, context.pick(quick=40, full=150))


def _samples(single: Mapping[States, Fraction], n: int) -> list[tuple[tuple[States, ...], Fraction]]:
    samples: list[tuple[tuple[States, ...], Fraction]] = [((), Fraction(1))]
    for _ in range(n):
        samples = [((*sample, states), p * q) for sample, p in samples for states, q in single.items()]
    return samples


def _unlike_any_other(sample: tuple[States, ...]) -> int:
    others = [frozenset().union(*(s for j, s in enumerate(sample) if j != i)) for i in range(len(sample))]
    return sum(not mine <= rest for mine, rest in zip(sample, others, strict=True))


def exact_recovery(*, states_too_many: int = 0, context: Context = QUICK) -> Outcome:
    """P(some reachable state is unseen) <= S (1 - gamma_min)^n, gamma_min the rarest positive step-wise visitation."""

    def holds(instance: tuple[Model, tuple[int, ...], int]) -> bool:
        model, expert, n = instance
        single = visited_law(model, expert)
        reachable = frozenset().union(*single)
        law = model.law(expert)
        steps = [marginal(law, itemgetter(2 * t)) for t in range(model.horizon)]
        rarest = min(p for step in steps for p in step.values())
        failure = sum((p for seen, p in union_law(single, n).items() if seen != reachable), Fraction(0))
        return failure <= (model.n_states - states_too_many) * (1 - rarest) ** n

    cases = _experts()
    return on_every("exact recovery", cases, holds, context.pick(quick=60, full=200))


def formulas_invert_the_tail(*, states_too_many: int = 0) -> Outcome:
    """(2^S - 1)(1 - R)^n = delta at the sharp formula, S C(S, k)(1 - R)^n = delta at the observed one."""
    tally = Tally()
    for size, n, stay in product((1, 2, 5), (1, 3, 20), (Fraction(1, 2), Fraction(9, 10), Fraction(1, 100))):
        states, loss = size - states_too_many, stay**n
        if 0 < (2**states - 1) * loss < 1:
            values = {"S": size, "n": n, "delta": (2**states - 1) * loss}
            tally.expect(attained(1 - stay, policy_error_sharp, **values), f"sharp at {values}")
            tally.expect(within(1 - stay, policy_error_repaired, **values), f"repaired at {values}")
        for unseen in range(1, size + 1):
            delta = states * comb(size, unseen) * loss
            if 0 < delta < 1:
                values = {"S": size, "n": n, "unvisited": unseen, "delta": delta}
                tally.expect(attained(1 - stay, missing_mass_observed, **values), f"observed at {values}")
    return tally.outcome("the formulas invert the tails")
