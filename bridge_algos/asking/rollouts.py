"""Asking without a model of the environment: what is needed of it is a simulator (companion G7, coupled).

The version space of the demonstrations needs no dynamics, and features of trajectories that were shown are exact. So
the likelihood set is exact, and only the features of policies are estimated: their errors are added to every bound.

Three simulations, each fresh and of a number fixed before it is made: a pilot, which fixes what to merge and how many
seeds are needed; the rollouts that features are estimated from; and the pool of questions. The failure probability is
split in two: a fifth for the features, the rest for the answers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.asking.candidates import Candidates, distinct_rows, recorded_actions
from bridge_algos.asking.elicitation import Ball, Elicitation
from bridge_algos.asking.gap import Rivals
from bridge_algos.asking.goal import goal
from bridge_algos.asking.rollout_estimates import (
    Estimate,
    candidate_actions,
    coupled_estimate,
    pair_log_chance,
    widest_radius,
)
from bridge_algos.asking.rollout_tree import Simulator, Tree, branch, tabular_simulator
from bridge_algos.asking.tabular import POOL, Problem
from bridge_algos.asking.utility import Utility, step_features
from bridge_algos.embeddings import expected_features
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.trajectories import Trajectories, sample_each, sample_trajectories

FEATURE_SHARE = 0.2
"""Of delta, for the features."""

ERROR_SHARE = 0.5
"""Of the gap that is asked for, what errors of features shall take: seeds are chosen for it."""

MERGED_SHARE = 0.2
"""Of that error, what visits to merged states may take in the pilot."""

PILOT, MOST_SEEDS, MOST_CANDIDATES = 1000, 400_000, 2**17

DRAWN = 10
"""Trajectories simulated for each one in the pool."""

BASES = 4
"""Candidates, at most, against which the pilot measures differences."""


@dataclass(frozen=True, eq=False)
class Rollouts:
    """A session about a simulator.

    Args:
        problem: as of known dynamics, with estimated features; only what simulates a teacher looks at its dynamics.
        session: to ask and tell.
        estimate: features and their errors.
        seeds: that the features are estimated from.
        episodes: trajectories simulated in all: pilot, features, pool.
    """

    problem: Problem
    session: Elicitation
    estimate: Estimate
    seeds: int
    episodes: int

    def true_gap(self) -> float:
        """Nats by which the best candidate's utility exceeds the recommended one's, from the dynamics."""
        utility = self.problem.utility
        recommended = self.problem.candidates.policies[self.session.recommended]
        policies = np.concatenate([recommended[None], self.estimate.policies])
        utilities = expected_features(self.problem.mdp.dynamics, policies, utility.embedding)[0] @ utility.weights
        return float(utilities.max() - utilities[0])


def estimate_features(
    simulator: Simulator,
    recorded: IntArray,
    per_step: FloatArray,
    reach: float,
    wanted: float,
    delta: float,
    rng: np.random.Generator,
) -> tuple[Estimate, Tree, int]:
    """Features of every policy that agrees with the demonstrations, to an error near ``wanted``.

    Args:
        recorded: (S,) demonstrated actions, -1 in the other states.
        per_step: (S, A, d) features of one step.
        reach: bound on the norm of the difference of two trajectories' features.
        wanted: norm of the error; reached only within MOST_SEEDS seeds. The error that holds is the estimate's.
        delta: failure probability.

    Returns:
        The estimate, the rollouts that it comes from, and the episodes of pilot and rollouts together.
    """
    first = branch(simulator, recorded, np.zeros(0, dtype=np.int64), per_step, PILOT, rng)
    merged = rarely_visited(first, simulator.n_actions, MERGED_SHARE * wanted / reach)
    pilot = branch(simulator, recorded, merged, per_step, PILOT, rng)
    left = wanted * (1 - MERGED_SHARE) if len(merged) else wanted
    n = seeds_needed(pilot, simulator.n_actions, reach, left, delta, rng)
    tree = branch(simulator, recorded, merged, per_step, n, rng)
    estimate = coupled_estimate(tree, recorded, simulator.n_actions, reach, delta)
    return estimate, tree, first.episodes + pilot.episodes + tree.episodes


def rarely_visited(pilot: Tree, n_actions: int, allowed: float) -> IntArray:
    """Open states, the rarest first, whose visits together have at most the allowed chance in the pilot.

    More are merged where the candidates would otherwise be more than MOST_CANDIDATES.
    """
    visits = np.array([len(np.unique(pilot.seeds[column >= 0])) for column in pilot.actions.T]) / pilot.n
    order = np.argsort(visits, kind="stable")
    rare = int((np.cumsum(visits[order]) <= allowed).sum())
    while n_actions ** (len(order) - rare) > MOST_CANDIDATES:
        rare += 1
    return np.asarray(np.sort(pilot.open_states[order[:rare]]))


def seeds_needed(
    pilot: Tree, n_actions: int, reach: float, wanted: float, delta: float, rng: np.random.Generator
) -> int:
    """Seeds with which the pilot predicts an error of at most ``wanted``, at most MOST_SEEDS."""
    chosen = candidate_actions(pilot, n_actions)
    log_chance = pair_log_chance(len(chosen), delta)
    bases = rng.choice(len(chosen), size=min(BASES, len(chosen)), replace=False)

    def predicted(n: int) -> float:
        return max(widest_radius(pilot, chosen[i], n_actions, reach, log_chance, n) for i in bases)

    grid = np.unique(np.geomspace(PILOT, MOST_SEEDS, 60).astype(np.int64))
    low, high = 0, len(grid) - 1
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if predicted(int(grid[middle])) <= wanted else (middle + 1, high)
    return int(grid[low])


def neighbours(estimate: Estimate, tree: Tree, n_actions: int, index: IntArray) -> Rivals:
    """Rivals of candidates: the estimated features of those that differ in one open state.

    Args:
        index: (N,) number, among all candidates, of each one that the session compares.
    """
    k = len(tree.open_states)
    chosen = candidate_actions(tree, n_actions)
    worth = n_actions ** np.arange(k - 1, -1, -1)

    def rivals(contenders: IntArray) -> FloatArray:
        own = index[contenders]
        others = (chosen[own][:, :, None] + np.arange(1, n_actions)) % n_actions
        shifted = own[:, None, None] + (others - chosen[own][:, :, None]) * worth[:, None]
        return estimate.features[shifted.reshape(len(own), -1)]

    return rivals


def simulated_session(
    mdp: TabularMDP,
    utility: Utility,
    n_demonstrations: int,
    rng: np.random.Generator,
    until: str,
    delta: float,
    asking: str,
    demonstrations: Trajectories | None = None,
    pool: int = POOL,
) -> Rollouts:
    """A session about an MDP that can only be simulated; arguments as of :func:`tabular.build_problem` and a session's.

    Failure probability of its certificates: delta, of which FEATURE_SHARE is for the features.
    """
    if demonstrations is None and n_demonstrations:
        demonstrations = sample_trajectories(mdp, utility.best.policy, n_demonstrations, rng)
    recorded = recorded_actions(demonstrations, mdp.n_states)
    simulator, per_step = tabular_simulator(mdp.dynamics), step_features(utility.embedding.name, mdp)
    reach = np.sqrt(2) * utility.embedding.bound  # features are nonnegative
    wanted = ERROR_SHARE * goal(until, utility.utility_range).nats / utility.weight_bound
    estimate, tree, episodes = estimate_features(
        simulator, recorded, per_step, reach, wanted, FEATURE_SHARE * delta, rng
    )
    index = distinct_rows(estimate.features)
    policies, features = estimate.policies[index], estimate.features[index]
    owners = rng.integers(len(index), size=DRAWN * pool)
    drawn = sample_each(mdp, policies[owners], 1, rng)
    picked = varied(drawn, mdp.n_actions, pool)
    shown, owners = Trajectories(drawn.states[picked], drawn.actions[picked]), owners[picked]
    candidates = Candidates(policies, features, mdp.n_actions ** int((recorded < 0).sum()), complete=True)
    problem = Problem(mdp, utility, demonstrations, candidates, shown, owners)
    session = Elicitation(
        features,
        Ball(utility.weight_bound),
        utility.embedding.of_trajectories(shown),
        (1 - FEATURE_SHARE) * delta,
        until,
        rng,
        utility_range=utility.utility_range,
        rivals=neighbours(estimate, tree, mdp.n_actions, index),
        owners=owners,
        asking=asking,
        fresh=True,
        offline=(in_words(tree), estimate.delta),
        errors=lambda i: utility.weight_bound * estimate.error(int(index[i])),
    )
    return Rollouts(problem, session, estimate, tree.n, episodes + DRAWN * pool)


def varied(drawn: Trajectories, n_actions: int, size: int) -> IntArray:
    """Indices of ``size`` trajectories, of which the first half is shared out among state-action pairs, rarest first.

    A session can only learn about what its pool shows, and demonstrations leave open what is seldom visited.

    >>> varied(Trajectories(np.array([[0], [0], [0], [1]]), np.zeros((4, 1), dtype=int)), 1, 2)
    array([3, 0])
    """
    pairs = drawn.states * n_actions + drawn.actions
    visited, counts = np.unique(pairs, return_counts=True)
    quota = max(1, size // (2 * len(visited)))
    shown = [np.flatnonzero((pairs == pair).any(axis=1))[:quota] for pair in visited[np.argsort(counts)]]
    order = np.concatenate([*shown, np.arange(len(drawn))])
    _, first = np.unique(order, return_index=True)
    return np.asarray(order[np.sort(first)][:size])


def in_words(tree: Tree) -> str:
    """What the candidates and their features rest on."""
    return (
        "the demonstrator is stationary, deterministic and best for the teacher's utility, so that the best one "
        f"agrees with every demonstration (audit T8); the simulator behaves as the environment, its {tree.n:,} seeds "
        "are independent, and equal random numbers give equal states"
    )
