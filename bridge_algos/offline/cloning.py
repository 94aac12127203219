r"""Log-loss behavioural cloning in closed form (eq:loglossbc_estimator).

The log-loss :math:`\sum_{i,h} \log \pi(a_h^i | s_h^i)` separates over states, so the maximiser over a tabular class is
read off the counts. Over deterministic policies the likelihood is 1 or 0 when the data are consistent with a
deterministic policy, every policy that agrees with the data on visited states is a maximiser, and what happens on
unvisited states is a tie, broken as documented.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from bridge_algos.given import checked
from bridge_algos.shapes import PairCounts, PairTable, Policy
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError

TieBreak = Literal["random", "first"]


@checked
def action_counts(demonstrations: Trajectories, n_states: int, n_actions: int) -> PairCounts:
    """How often each action was taken in each state, (S, A), over all H recorded pairs."""
    demonstrations.checked(n_states, n_actions)
    counts = np.zeros((n_states, n_actions), dtype=np.int64)
    np.add.at(counts, (demonstrations.states, demonstrations.actions), 1)
    return counts


@checked
def clone_deterministic(
    counts: PairCounts, rng: np.random.Generator | None = None, tie_break: TieBreak = "random"
) -> Policy:
    """The deterministic stationary clone (S,): the most frequent action of each state.

    With noisy demonstrations no deterministic policy has positive likelihood; the majority action is the one that
    minimises the number of contradicted pairs, and maximises the likelihood of every policy class that mixes a
    deterministic policy with uniform noise.

    Args:
        counts: (S, A) from :func:`action_counts`.
        rng: needed for ``tie_break="random"``.
        tie_break: ``"random"`` draws uniformly among the most frequent actions (all actions in an unvisited state), so
            that the order of actions carries no luck; ``"first"`` takes the lowest index.
    """
    if tie_break == "first":
        return np.asarray(counts.argmax(axis=1))
    if rng is None:
        raise InputError("tie_break='random' needs a numpy Generator; pass rng=numpy.random.default_rng(seed).")
    best = counts == counts.max(axis=1, keepdims=True)
    return np.asarray(np.where(best, rng.random(counts.shape), -1.0).argmax(axis=1))


@checked
def clone_stochastic(counts: PairCounts) -> PairTable:
    """The stochastic stationary clone (S, A): action frequencies, uniform in unvisited states.

    >>> clone_stochastic(np.array([[3, 1], [0, 0]]))
    array([[0.75, 0.25],
           [0.5 , 0.5 ]])
    """
    totals = counts.sum(axis=1, keepdims=True)
    return np.asarray(np.where(totals > 0, counts / np.maximum(totals, 1), 1.0 / counts.shape[1]))


@checked
def add_action_noise(
    demonstrations: Trajectories, probability: float, n_actions: int, rng: np.random.Generator
) -> Trajectories:
    """Demonstrations in which each recorded action is replaced by a uniform random one with the given probability.

    The states stay as they were: the record is corrupted, not the behaviour (paper, offline ablation).
    """
    if not 0 <= probability <= 1:
        raise InputError(f"the noise probability is {probability}, expected a number in [0, 1].")
    demonstrations.checked(np.iinfo(np.int64).max, n_actions)
    replaced = rng.random(demonstrations.actions.shape) < probability
    noise = rng.integers(n_actions, size=demonstrations.actions.shape)
    return Trajectories(demonstrations.states, np.where(replaced, noise, demonstrations.actions))
