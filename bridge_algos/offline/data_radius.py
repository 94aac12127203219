r"""Radii that the demonstrations themselves certify for the ball around a deterministic clone.

Both hold for a deterministic stationary expert whose actions were recorded without noise, and for the ball as
:class:`bridge_algos.offline.policy_set.PolicySet` has it: pooled counts as kernel, any rows where there is no data.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

import bridge_theory as theory
from bridge_algos.given import checked
from bridge_algos.hellinger import disagreement_probability
from bridge_algos.mdp import Dynamics, FloatArray
from bridge_algos.offline.step_counts import StepCounts
from bridge_algos.offline.transitions import EmptyRow
from bridge_algos.shapes import Policy
from bridge_theory.arithmetic.flint_balls import Ball, ball
from bridge_theory.enclosure import Enclosure, enclose


def unsettled_states(counts: StepCounts, clone: Policy) -> np.ndarray:
    """Where the data leave open whether the expert does as the clone does, (S,) booleans: the set U of audit T8(B).

    The states without a recorded action, and those with one that is not the clone's.
    """
    pairs = counts.pairs
    agreeing = pairs[np.arange(len(pairs)), clone]
    return np.asarray((agreeing == 0) | (agreeing < pairs.sum(axis=1)))


@checked
def leaving_mass(counts: StepCounts, initial: FloatArray, clone: Policy, empty_row: EmptyRow) -> Enclosure:
    r"""Certified ends of :math:`\rho^2=\hat P^{BC}(\text{meet an unsettled state})` under the exact count estimate.

    Source: audit T8(B). The rows are the quotients :math:`N(s,a,s')/N(s,a)` as rationals, not their nearest floats;
    ``initial`` is taken as the exact numbers its floats are, over their sum. Returns ends in [0, 1], zero exactly
    where the mass is.
    """
    n_states, leaves = len(clone), unsettled_states(counts, clone)
    start = [Fraction(float(p)) for p in initial]
    law = [(s, p / sum(start)) for s, p in enumerate(start) if p]
    rows = {s: _exact_row(counts.pooled[s, clone[s]].tolist(), s, empty_row) for s in range(n_states) if not leaves[s]}

    def mass() -> Ball:
        present, met = {s: ball(p) for s, p in law}, ball(0)
        for step in range(len(counts.visits)):
            met += sum((p for s, p in present.items() if leaves[s]), start=ball(0))
            if step + 1 == len(counts.visits):
                break
            arriving: dict[int, Ball] = {}
            for s, p in present.items():
                for target, chance in rows.get(s, ()):
                    arriving[target] = arriving.get(target, ball(0)) + p * ball(chance)
            present = arriving
        return met

    found = enclose(mass)
    return replace(found, upper=min(1.0, found.upper))  # a sum of rounded thirds may exceed 1


def _exact_row(counts: list[int], state: int, empty_row: EmptyRow) -> list[tuple[int, Fraction]]:
    """The positive entries of one row of :func:`bridge_algos.offline.transitions.estimate_transitions`, exactly."""
    if not any(counts):
        counts = [1] * len(counts) if empty_row == "uniform" else [int(s == state) for s in range(len(counts))]
    return [(s, Fraction(count, sum(counts))) for s, count in enumerate(counts) if count]


@checked
def leaving_radius(counts: StepCounts, estimate: Dynamics, clone: Policy) -> float:
    r"""Statement: :math:`H(\hat P^{\pi^*},\hat P^{BC})\le\rho`, surely, with
    :math:`\rho^2=\hat P^{BC}(\text{meet an unsettled state})`, see :func:`unsettled_states`.

    Source: audit T8(B), ``theory.offline_radius_mass``. Assumptions: deterministic expert whose action is among those
    recorded in every state with records. Returns a Hellinger distance in [0, 1], an estimate to rounding that is zero
    only where the mass is; :func:`leaving_mass` has certified ends.
    """
    unsettled = unsettled_states(counts, clone).astype(np.float64)[None]
    mass = float(disagreement_probability(estimate, clone, unsettled)[0])
    return float(theory.offline_radius_mass.estimate(mass=mass))


@checked
def data_dependent_radius(counts: StepCounts, estimate: Dynamics, clone: Policy, delta: float) -> float:
    r"""Statement: :math:`H(\hat P^{\pi^*},\hat P^{BC})\le\sin\min(\pi/2,\arcsin\sqrt{R_1}+\arccos(1-R_2))` with
    probability at least :math:`1-\delta`.

    Source: audit T9 (angle) with :math:`R_1` from T7(c), the number of states without data, and :math:`R_2` from T10
    and T3 with exits: the KL budget of the counts times the largest ratio of expected to observed uses of a pair, and
    the estimated chance of meeting a pair that has no data, both computed by following the clone until it meets one.
    Each takes :math:`\delta/2`. Assumptions: deterministic stationary expert, no noise, stationary kernel. Returns a
    Hellinger distance in [0, 1], an estimate to rounding; 1 says nothing.
    """
    n_states = estimate.n_states
    unvisited = int((counts.pairs.sum(axis=1) == 0).sum())
    n = int(counts.visits[0].sum())
    policy_error = theory.missing_mass_observed.estimate(S=n_states, n=n, unvisited=unvisited, delta=delta / 2)
    return float(
        theory.confidence_set_radius_angle.estimate(
            R1=policy_error, R2=transition_error_from_counts(counts, estimate, clone, delta / 2)
        )
    )


@checked
def transition_error_from_counts(counts: StepCounts, estimate: Dynamics, clone: Policy, delta: float) -> float:
    r"""Statement: :math:`H^2(\hat P^{\pi^*},P_*^{\pi^*})\le R_2` with probability at least :math:`1-\delta`.

    Source and assumptions: as for :func:`data_dependent_radius`. Returns a squared Hellinger distance in [0, 1], an
    estimate to rounding.
    """
    used = counts.pooled.sum(axis=2)
    uses = used[np.arange(estimate.n_states), clone]
    expected, leaving = _uses_before_leaving(estimate, clone, uses > 0)
    if leaving >= 1:
        return 1.0
    ratio = float(np.max(expected[uses > 0] / uses[uses > 0], initial=0.0))
    budget = theory.transition_kl_budget.estimate(
        S=estimate.n_states, counts=used[used > 0].tolist() or [0], delta=delta
    )
    return float(theory.hellinger_from_kl_with_exits.estimate(kl=float(budget) * ratio, exit_mass=leaving))


def _uses_before_leaving(estimate: Dynamics, clone: Policy, known: np.ndarray) -> tuple[np.ndarray, float]:
    """Expected uses of each state's pair in the H - 1 transitions, and the chance to meet a state that is not known."""
    kernel = estimate.transitions[np.arange(estimate.n_states), clone]
    expected, leaving, present = np.zeros(estimate.n_states), 0.0, estimate.initial
    for _ in range(estimate.horizon - 1):
        leaving += float(present[~known].sum())
        expected += np.where(known, present, 0.0)
        present = np.where(known, present, 0.0) @ kernel
    return expected, min(leaving, 1.0)
