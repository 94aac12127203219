r"""Asking without a model of the environment: what is needed of it is a simulator (companion G7 and G7', coupled).

The version space of the demonstrations needs no dynamics, and features of trajectories that were shown are exact. So
the likelihood set is exact, and only the features of policies are estimated: their errors are part of every bound.

**Statement.** Let the demonstrator be a best deterministic stationary policy for the teacher's w*, whose norm is at
most W, and let answers follow :math:`\sigma(\langle x, w^* \rangle)`. With probability at least :math:`1 - \delta`, at
every number of answers at which the session may be stopped, the recommended policy is within its certified gap of the
best.

*Proof.* Three simulations, each of a size that was fixed before it was made, and fresh: given the demonstrations a
pilot fixes the merged states M, the axes u and n; given these, n independent seeds give the means; given both, the
pool.

1. Features, with :math:`\delta / 5`. Under one seed two candidates run alike until an undemonstrated state, and so the
   difference of their features is the expectation of the difference y of what each seed gives from there on,
   :math:`\|y\| \le \sqrt 2 B`. By :mod:`bridge_algos.asking.feature_errors` all EVENTS bounds on all K (K - 1) / 2
   pairs fail together with probability at most :math:`\delta / 10`; a policy that acts otherwise than its candidate in
   M differs from it by at most :math:`\sqrt 2 B` times the chance that M is visited, which is above Clopper and
   Pearson's bound with probability at most :math:`\delta / 10`. No bound depends on an answer, nor on which candidate
   is recommended, and they are about expectations alone: so they hold for whatever is asked, recommended and looked at.
2. Answers, with :math:`4 \delta / 5`. Given the three simulations, companion G1' puts w* in all likelihood sets at
   once, whatever is asked and whenever it is stopped.
3. On both events let pi be the best policy, j its candidate, i the recommended one. For w* in the set,
   :math:`U(\pi) - U(i) = \langle \phi(\pi) - \phi(i), w^* \rangle` is at most the largest value over the set, over the
   corners of the axes of (i, j), and over the rest; rows say that pi beats its rivals, each known up to its own error.
   This is what is bounded for every j. QED

Candidates whose features are equal in every rollout, pilot included, share means, axes and radii, and are kept once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.asking.candidates import Candidates, recorded_actions
from bridge_algos.asking.elicitation import Ball, Elicitation
from bridge_algos.asking.feature_errors import FeatureErrors, along_and_across, long_axes
from bridge_algos.asking.goal import goal
from bridge_algos.asking.rollout_estimates import (
    Estimate,
    candidate_actions,
    candidate_policies,
    coupled_estimate,
    pair_log_chance,
    pair_moments,
    told_apart,
)
from bridge_algos.asking.rollout_tree import Simulator, Tree, branch, followed_sums, tabular_simulator
from bridge_algos.asking.tabular import POOL, Problem
from bridge_algos.asking.utility import Utility, step_features
from bridge_algos.embeddings import expected_features
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.trajectories import Trajectories, sample_each, sample_trajectories

FEATURE_SHARE = 0.2
"""Of delta, for the features."""

ERROR_SHARE = 0.6
"""Of the gap that is asked for, what errors of features shall take: seeds are chosen for it."""

MERGED_SHARE = 0.2
"""Of that error, what visits to merged states may take in the pilot."""

PILOT, LEAST_SEEDS, MOST_SEEDS, MOST_CANDIDATES = 1000, 200, 400_000, 2**19

SHOWN, DRAWN = 400, 10
"""Trajectories in the pool, at most, and trajectories simulated for each of them: here every one costs an episode."""

BASES, TRIED = 4, 64
"""Candidates, at most, between which the pilot measures differences."""


@dataclass(frozen=True, eq=False)
class Rollouts:
    """A session about a simulator.

    Args:
        problem: as of known dynamics, with estimated features; only what simulates a teacher looks at its dynamics.
        session: to ask and tell.
        seeds: that the features are estimated from.
        episodes: trajectories simulated in all: pilot, features, pool.
    """

    problem: Problem
    session: Elicitation
    seeds: int
    episodes: int

    def true_gap(self) -> float:
        """Nats by which the best candidate's utility exceeds the recommended one's, from the dynamics."""
        utility = self.problem.utility
        recommended = self.problem.candidates.policies[self.session.recommended]
        policies = np.stack([recommended, utility.best.policy])
        utilities = expected_features(self.problem.mdp.dynamics, policies, utility.embedding)[0] @ utility.weights
        return float(utilities[1] - utilities[0])


def estimate_features(
    simulator: Simulator,
    recorded: IntArray,
    per_step: FloatArray,
    reach: float,
    wanted: tuple[float, float],
    delta: float,
    rng: np.random.Generator,
) -> tuple[Estimate, Tree, Tree, int]:
    """Features of every policy that agrees with the demonstrations.

    Args:
        recorded: (S,) demonstrated actions, -1 in the other states.
        per_step: (S, A, d) features of one step.
        reach: bound on the norm of the difference of two trajectories' features.
        wanted: the gap that is asked for and W, from which the number of seeds is chosen, at most MOST_SEEDS. The
            errors that hold are the estimate's.
        delta: failure probability.

    Returns:
        The estimate, the rollouts that it comes from, the pilot, and the episodes of all together.
    """
    first = branch(simulator, recorded, np.zeros(0, dtype=np.int64), per_step, PILOT, rng)
    merged = rarely_visited(first, simulator.n_actions, MERGED_SHARE * ERROR_SHARE * wanted[0] / (wanted[1] * reach))
    pilot = branch(simulator, recorded, merged, per_step, PILOT, rng)
    n = seeds_needed(pilot, simulator.n_actions, reach, wanted, delta, rng)
    tree = branch(simulator, recorded, merged, per_step, n, rng)
    estimate = coupled_estimate(tree, pilot, simulator.n_actions, reach, delta, merges=len(merged) > 0)
    return estimate, tree, pilot, first.episodes + pilot.episodes + tree.episodes


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
    pilot: Tree, n_actions: int, reach: float, wanted: tuple[float, float], delta: float, rng: np.random.Generator
) -> int:
    """Seeds with which the pilot predicts errors of at most ERROR_SHARE of the gap, at most MOST_SEEDS; a guess.

    Along an axis a contender is charged for weights under which it is better by the gap: others are decided sooner.
    """
    gap, weight_bound = wanted
    chosen = candidate_actions(pilot, n_actions)
    log_chance = pair_log_chance(len(chosen), delta)
    bases, others = (rng.choice(len(chosen), size=min(size, len(chosen)), replace=False) for size in (BASES, TRIED))
    means = followed_sums(pilot, n_actions, pilot.features) / pilot.n
    parts = []
    for i in bases:
        moments = pair_moments(pilot, chosen, i)
        pairs = [(moments(j), float(np.linalg.norm(means[j] - means[i]))) for j in others if j != i]
        parts += [(long_axes(both), both, mean) for both, mean in pairs]

    def predicted(n: int) -> float:
        worst = 0.0
        for axes, both, mean in parts:
            scaled, rest = along_and_across(axes, both, reach, log_chance, n)
            along = float(np.linalg.norm(scaled, axis=1).sum())
            worst = max(worst, weight_bound * rest + min(weight_bound * along, gap * along / max(mean, 1e-12)))
        return worst

    grid = np.unique(np.geomspace(LEAST_SEEDS, MOST_SEEDS, 60).astype(np.int64))
    low, high = 0, len(grid) - 1
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if predicted(int(grid[middle])) <= ERROR_SHARE * gap else (middle + 1, high)
    return int(grid[low])


def neighbours(tree: Tree, n_actions: int, own: IntArray) -> IntArray:
    """(B, k (A - 1)) the candidates that differ from each of B candidates in one open state."""
    k = len(tree.open_states)
    actions = candidate_actions(tree, n_actions)[own]
    others = (actions[:, :, None] + np.arange(1, n_actions)) % n_actions
    worth = n_actions ** np.arange(k - 1, -1, -1)
    return np.asarray((own[:, None, None] + (others - actions[:, :, None]) * worth[:, None]).reshape(len(own), -1))


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
    wanted = goal(until, utility.utility_range).nats, utility.weight_bound
    estimate, tree, pilot, episodes = estimate_features(
        simulator, recorded, per_step, reach, wanted, FEATURE_SHARE * delta, rng
    )
    index = told_apart((pilot, tree), mdp.n_actions, rng)
    policies, features = candidate_policies(tree, recorded, mdp.n_actions)[index], estimate.features[index]
    pool = min(pool, SHOWN)
    owners = rng.integers(len(index), size=DRAWN * pool)
    drawn = sample_each(mdp, policies[owners], 1, rng)
    picked = varied(drawn, mdp.n_actions, pool)
    shown, owners = Trajectories(drawn.states[picked], drawn.actions[picked]), owners[picked]
    candidates = Candidates(policies, features, mdp.n_actions ** int((recorded < 0).sum()), complete=True)
    problem = Problem(mdp, utility, demonstrations, candidates, shown, owners)

    def errors(recommended: int) -> FeatureErrors:
        every = estimate.errors(int(index[recommended]))
        return FeatureErrors(
            every.radii[index],
            lambda i: every.axes(index[i], features.shape[1]),
            lambda i: every.radii[neighbours(tree, mdp.n_actions, index[i])],
        )

    session = Elicitation(
        features,
        Ball(utility.weight_bound),
        utility.embedding.of_trajectories(shown),
        (1 - FEATURE_SHARE) * delta,
        until,
        rng,
        utility_range=utility.utility_range,
        rivals=lambda i: estimate.features[neighbours(tree, mdp.n_actions, index[i])],
        owners=owners,
        asking=asking,
        fresh=True,
        offline=(in_words(tree), estimate.delta),
        errors=errors,
    )
    return Rollouts(problem, session, tree.n, episodes + DRAWN * pool)


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
