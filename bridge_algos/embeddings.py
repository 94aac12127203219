r"""Trajectory embeddings :math:`\phi(\tau)` and their exact expectations :math:`\phi^P(\pi) = E[\phi(\tau)]`.

The paper's four tabular embeddings (table "Discrete embedding definitions and properties"), with one-hot states and
actions over the H pairs of a trajectory:

=================  =====================================  ============  ============
name               definition                             d             B
=================  =====================================  ============  ============
identity_long      (s_1, a_1, ..., s_H, a_H)              H (S + A)     sqrt(2 H)
identity_short     sum_h (s_h, a_h)                       S + A         sqrt(2) H
state_counts       sum_h s_h                              S             H
final_state        s_H                                    S             1
=================  =====================================  ============  ============

and ``state_action_counts``, sum_h e_(s_h, a_h), with d = S A and B = H, in which every expected reward r(s, a) is
linear, so that the Bradley-Terry model of the theory holds exactly; so it does for the return itself
(:func:`return_embedding`), with d = 1.

All are linear in the per-step occupancy, so their expectations are computed. A function of the whole trajectory can
only be sampled; its estimate carries its Monte-Carlo error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt

import numpy as np

from bridge_algos.given import checked
from bridge_algos.mdp import Dynamics, FloatArray, IntArray, TabularMDP
from bridge_algos.occupancy import blocks, state_occupancies
from bridge_algos.shapes import Features, Occupancies, PairTable, PerPolicy, Policies, PolicyStates
from bridge_algos.trajectories import Trajectories, sample_paths
from bridge_theory.errors import InputError


@dataclass(frozen=True, eq=False)
class Embedding:
    r"""An embedding that is linear in the per-step occupancy: :math:`\phi(\tau) = \sum_h weights_h(s_h, a_h)`.

    Args:
        name: how tables call it.
        dimension: d.
        bound: B with ||phi(tau)||_2 <= B for every trajectory.
        expectation: maps state occupancies (N, H, S) and the deterministic policies (N, S) to features (N, d).
        of_trajectories: maps trajectories to features (n, d).
    """

    name: str
    dimension: int
    bound: float
    expectation: Callable[[FloatArray, IntArray], FloatArray]
    of_trajectories: Callable[[Trajectories], FloatArray]


@dataclass(frozen=True, eq=False)
class SampledEmbedding:
    """An arbitrary function of the trajectory; its expectation is estimated from ``rollouts`` trajectories a policy."""

    name: str
    dimension: int
    bound: float
    of_trajectories: Callable[[Trajectories], FloatArray]


@checked
def make_embedding(name: str, n_states: int, n_actions: int, horizon: int) -> Embedding:
    """A built-in embedding for S states, A actions and horizon H.

    >>> make_embedding("state_counts", 5, 4, 8).bound
    8.0
    """
    states, actions = np.eye(n_states), np.eye(n_actions)
    of_pair = np.concatenate([np.repeat(states, n_actions, axis=0), np.tile(actions, (n_states, 1))], axis=1)

    def counts(t: Trajectories) -> FloatArray:
        return np.ones(t.horizon) @ states[t.states]

    def action_totals(per_state: PolicyStates, policies: Policies) -> FloatArray:
        rows = n_actions * np.arange(len(policies))[:, None]
        totals = np.bincount((rows + policies).ravel(), per_state.ravel(), len(policies) * n_actions)
        return np.asarray(totals.reshape(len(policies), n_actions), dtype=np.float64)

    def short(occupancy: Occupancies, policies: Policies) -> Features:
        visits = occupancy.sum(axis=1)
        return np.concatenate([visits, action_totals(visits, policies)], axis=1)

    def short_of(t: Trajectories) -> FloatArray:
        return np.asarray(np.ones(t.horizon) @ of_pair[t.states * n_actions + t.actions])

    def long(occupancy: Occupancies, policies: Policies) -> Features:
        per_step = np.einsum("nhs,nsa->nha", occupancy, actions[policies])
        return np.concatenate([occupancy, per_step], axis=2).reshape(len(policies), -1)

    def long_of(t: Trajectories) -> FloatArray:
        return np.concatenate([states[t.states], actions[t.actions]], axis=2).reshape(len(t), -1)

    def pairs(occupancy: Occupancies, policies: Policies) -> Features:
        visits = occupancy.sum(axis=1)
        return np.asarray((visits[:, :, None] * actions[policies]).reshape(len(policies), -1))

    def pairs_of(t: Trajectories) -> FloatArray:
        result = np.zeros((len(t), n_states * n_actions))
        np.add.at(result, (np.arange(len(t))[:, None], t.states * n_actions + t.actions), 1)
        return result

    known = {
        "identity_long": Embedding(
            "identity_long",
            horizon * (n_states + n_actions),
            sqrt(2 * horizon),
            expectation=long,
            of_trajectories=long_of,
        ),
        "identity_short": Embedding(
            "identity_short", n_states + n_actions, sqrt(2) * horizon, expectation=short, of_trajectories=short_of
        ),
        "state_counts": Embedding(
            "state_counts", n_states, float(horizon), lambda occupancy, _: occupancy.sum(axis=1), of_trajectories=counts
        ),
        "final_state": Embedding(
            "final_state", n_states, 1.0, lambda occupancy, _: occupancy[:, -1], lambda t: states[t.states[:, -1]]
        ),
        "state_action_counts": Embedding(
            "state_action_counts", n_states * n_actions, float(horizon), expectation=pairs, of_trajectories=pairs_of
        ),
    }
    if name not in known:
        raise InputError(f"unknown embedding {name!r}; expected one of {', '.join(known)}.")
    return known[name]


@checked
def linear_embedding(name: str, weights: FloatArray, bound: float | None = None) -> Embedding:
    r"""A user's embedding :math:`\phi(\tau) = \sum_h weights[h, s_h, a_h]`, exact like the built-in ones.

    Args:
        weights: (H, S, A, d).
        bound: B; by default the certified bound sum_h max_{s,a} ||weights[h, s, a]||_2.

    Raises:
        InputError: for another shape, entries that are not finite, or a bound that is not positive.
    """
    if weights.ndim != 4 or not np.isfinite(weights).all():
        raise InputError(f"weights has shape {weights.shape}, expected finite numbers of shape (H, S, A, d).")
    horizon, n_states, n_actions, dimension = weights.shape
    default = float(np.linalg.norm(weights, axis=3).max(axis=(1, 2)).sum())
    if bound is not None and not bound > 0:
        raise InputError(f"the bound of embedding {name!r} is {bound}, expected a positive number.")
    steps, every_state = np.arange(horizon), np.arange(n_states)

    def expectation(occupancy: Occupancies, policies: Policies) -> Features:
        chosen = weights[:, every_state, policies].swapaxes(0, 1)
        return np.asarray(np.einsum("nhs,nhsd->nd", occupancy, chosen))

    def of_trajectories(t: Trajectories) -> FloatArray:
        t.checked(n_states, n_actions, horizon)
        return np.asarray(weights[steps, t.states, t.actions].sum(axis=1))

    return Embedding(name, dimension, default if bound is None else bound, expectation, of_trajectories)


def return_embedding(mdp: TabularMDP) -> Embedding:
    r"""The return itself as the only feature, :math:`\phi(\tau) = \sum_h r(s_h, a_h)` with expected rewards r; d = 1.

    B = H max|r|. The smallest embedding in which the Bradley-Terry model of the theory holds exactly.

    Raises:
        InputError: when every expected reward is zero.

    >>> from bridge_algos.envs.counterexamples import two_actions
    >>> embedding = return_embedding(two_actions())
    >>> embedding.dimension, embedding.bound
    (1, 0.5)
    """
    weights = np.broadcast_to(mdp.expected_reward[None, :, :, None], (mdp.horizon, mdp.n_states, mdp.n_actions, 1))
    return linear_embedding("return", weights, bound=mdp.horizon * float(np.abs(mdp.expected_reward).max()))


def expected_features(
    dynamics: Dynamics, policies: Policies, embedding: Embedding, step_costs: PairTable | None = None, steps: int = 0
) -> tuple[Features, PerPolicy]:
    r"""Exact features :math:`\phi^P(\pi)` and expected step costs of many deterministic policies, in one pass.

    Args:
        policies: (N, S) integers.
        step_costs: (S, A) cost of a pair, for example a bonus; None for no cost.
        steps: over how many first steps the costs are summed.

    Returns:
        Features (N, d) and expected costs :math:`E \sum_{h \le steps} c(s_h, a_h)` (N,).
    """
    features = np.empty((len(policies), embedding.dimension))
    costs = np.zeros(len(policies))
    every_state = np.arange(dynamics.n_states)
    for where, block in blocks(policies, dynamics.n_states, dynamics.n_actions):
        occupancy = state_occupancies(dynamics, block)
        features[where] = embedding.expectation(occupancy, block)
        if step_costs is not None and steps:
            visits = occupancy[:, :steps].sum(axis=1)
            costs[where] = np.vecdot(visits, step_costs[every_state, block])
    return features, costs


@dataclass(frozen=True, eq=False)
class SampledFeatures:
    """Monte-Carlo features (N, d) with standard errors (N, d), and the mean step costs (N,) of the same rollouts."""

    means: Features
    standard_errors: Features
    costs: PerPolicy


@checked
def sampled_features(
    dynamics: Dynamics,
    policies: Policies,
    embedding: Embedding | SampledEmbedding,
    rollouts: int,
    rng: np.random.Generator,
    step_costs: PairTable | None = None,
    steps: int = 0,
) -> SampledFeatures:
    """Features and step costs of policies (N, S), estimated from ``rollouts`` trajectories each.

    The paper's way (100 rollouts a policy); kept to measure what exactness buys, and for embeddings that are not
    linear in the occupancy.
    """
    if rollouts < 2:
        raise InputError(f"rollouts is {rollouts}, expected at least 2, so that a standard error exists.")
    means, errors = (np.empty((len(policies), embedding.dimension)) for _ in range(2))
    costs = np.zeros(len(policies))
    for i, policy in enumerate(policies):
        states, actions, _ = sample_paths(dynamics, policy, rollouts, rng)
        sample = embedding.of_trajectories(Trajectories(states, actions))
        means[i], errors[i] = sample.mean(axis=0), sample.std(axis=0, ddof=1) / sqrt(rollouts)
        if step_costs is not None:
            costs[i] = step_costs[states[:, :steps], actions[:, :steps]].sum() / rollouts
    return SampledFeatures(means, errors, costs)
