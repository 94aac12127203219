r"""What a simulated teacher judges: a utility :math:`\langle \phi, w^* \rangle` of a declared range in nats.

The range is best minus worst expected utility over all policies, history-dependent ones included, by dynamic
programming. w* is the shortest of the weights that give these preferences: what all trajectories have in common cannot
be asked about.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from bridge_algos.embeddings import Embedding, expected_features, make_embedding
from bridge_algos.expert.dynamic_programming import backward_induction
from bridge_algos.expert.stationary import best_stationary
from bridge_algos.expert.stationary_optimum import StationaryOptimum
from bridge_algos.mdp import FloatArray, TabularMDP
from bridge_algos.policies import random_policies
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError

ADDITIVE = ("state_action_counts", "state_counts", "identity_short")
"""Embeddings that sum one feature vector a step, so that utilities are expected returns."""

FIT_POLICIES, FIT_SEED = 2000, 0
"""The random policies whose returns the weights are fitted to, where rewards are not linear in the embedding."""


@dataclass(frozen=True, eq=False)
class Utility:
    """A simulated teacher's utility.

    Args:
        embedding: phi.
        weights: (d,) w*.
        weight_bound: W.
        utility_range: in nats, over all policies.
        best: the best stationary deterministic policy for this utility, which demonstrates.
        error: largest difference between utility and scaled return over the fitted policies, relative to the range; 0
            where rewards are linear in the embedding.
    """

    embedding: Embedding
    weights: FloatArray
    weight_bound: float
    utility_range: float
    best: StationaryOptimum
    error: float


def simulated_utility(
    mdp: TabularMDP, embedding: str, utility_range: float | None = None, weight_norm: float | None = None
) -> Utility:
    """The utility of a simulated teacher whose reward is that of the MDP.

    Args:
        embedding: a name of ADDITIVE.
        utility_range: in nats; then W = 2 ||w*||.
        weight_norm: instead of a range: ||w*|| of the weights proportional to the reward, which is then also W.

    Raises:
        InputError: for another embedding, a range that is not positive, or an MDP whose reward is constant.

    >>> from bridge_algos.envs.registry import make_mdp
    >>> utility = simulated_utility(make_mdp("starmdp"), "state_action_counts", utility_range=5)
    >>> round(utility.utility_range, 9), utility.error, round(utility.weight_bound, 2)
    (5.0, 0.0, 2.83)
    """
    if embedding not in ADDITIVE:
        raise InputError(f"the embedding of asking must be one of {', '.join(ADDITIVE)}, got {embedding!r}.")
    phi = make_embedding(embedding, mdp.n_states, mdp.n_actions, mdp.horizon)
    per_step = step_features(embedding, mdp)
    raw, error = _fitted(mdp, phi, per_step)
    spread = _range(mdp, per_step @ raw)
    if not spread > 1e-12:
        raise InputError(f"every policy of {mdp.name!r} has the same utility, so that there is nothing to ask.")
    if utility_range is not None:
        if not 0 < utility_range < np.inf:
            raise InputError(f"the range of utilities must be a positive number of nats, got {utility_range}.")
        scale = utility_range / spread
    else:
        assert weight_norm is not None
        scale = weight_norm / float(np.linalg.norm(raw))
    weights = scale * _shortest(raw, per_step)
    weight_bound = 2 * float(np.linalg.norm(weights)) if weight_norm is None else weight_norm
    best = best_stationary(_with_reward(mdp, per_step @ weights))
    return Utility(phi, weights, weight_bound, scale * spread, best, error / spread)


def step_features(embedding: str, mdp: TabularMDP) -> FloatArray:
    """(S, A, d) features of one step with an additive embedding."""
    n_states, n_actions = mdp.n_states, mdp.n_actions
    pairs = np.arange(n_states * n_actions)[:, None]
    steps = Trajectories(pairs // n_actions, pairs % n_actions)
    one = make_embedding(embedding, n_states, n_actions, 1).of_trajectories(steps)
    return np.asarray(one.reshape(n_states, n_actions, -1))


def _fitted(mdp: TabularMDP, embedding: Embedding, per_step: FloatArray) -> tuple[FloatArray, float]:
    """Weights whose utilities are the expected returns, or nearest to them by least squares; and the largest error."""
    rewards = mdp.expected_reward
    flat = per_step.reshape(-1, per_step.shape[2])
    exact = np.linalg.lstsq(flat, rewards.ravel(), rcond=None)[0]
    if np.abs(flat @ exact - rewards.ravel()).max() < 1e-9 * max(1.0, float(np.abs(rewards).max())):
        return np.asarray(exact), 0.0
    rng = np.random.default_rng(FIT_SEED)
    policies = random_policies(FIT_POLICIES, mdp.n_states, mdp.n_actions, rng)
    features, returns = expected_features(mdp.dynamics, policies, embedding, rewards, mdp.horizon)
    raw = np.linalg.lstsq(features - features.mean(axis=0), returns - returns.mean(), rcond=None)[0]
    errors = features @ raw - returns
    return np.asarray(raw), float(np.abs(errors - errors.mean()).max())


def _shortest(weights: FloatArray, per_step: FloatArray) -> FloatArray:
    """The weights without their part along directions in which all trajectories agree."""
    flat = per_step.reshape(-1, per_step.shape[2])
    differences = flat - flat.mean(axis=0)  # trajectories have equally many steps, so that constants cancel
    _, sizes, directions = np.linalg.svd(differences, full_matrices=False)
    span = directions[sizes > 1e-9 * sizes[0]]
    return np.asarray(span.T @ (span @ weights))


def _with_reward(mdp: TabularMDP, rewards: FloatArray) -> TabularMDP:
    return dataclasses.replace(mdp, reward=rewards, reward_on="")


def _range(mdp: TabularMDP, rewards: FloatArray) -> float:
    best, worst = (backward_induction(_with_reward(mdp, sign * rewards))[1][0] @ mdp.initial for sign in (1, -1))
    return float(best + worst)
