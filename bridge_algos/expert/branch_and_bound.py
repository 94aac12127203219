r"""Branch and bound over stationary deterministic policies, for the expected return of a finite horizon.

A node allows some actions in each state. Its *relaxation* lets the policy depend on time: backward induction within the
allowed actions, an upper bound on all stationary policies of the node. Three uses of it prune:

- *probing*: the relaxation with state s restricted to the single action a bounds all policies of the node with
  pi(s) = a. When it does not exceed the best return known, a is struck from s for the whole node; when no action of
  some state is left, so is the node. All probes of a node are one batch of backward inductions.
- *bounding*: every policy takes some action in s, so that min over s of max over a of the probes bounds the node.
- *rounding*: the relaxed policy's occupancies and action values give a stationary policy, in each state the action that
  loses least along the relaxed policy's way; its exact return is a lower bound.

The node with the largest bound is treated first and split at the state whose probes promise the smallest subtrees.
"""

from __future__ import annotations

import heapq
from itertools import count

import numpy as np

from bridge_algos.evaluation import expected_next_value, expected_return, rounding_allowance
from bridge_algos.expert.choices import BoolArray, relevant_actions
from bridge_algos.expert.stationary_optimum import StationaryOptimum
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_theory.errors import InputError

DEFAULT_WORK = 2 * 10**10
"""Multiplications in all relaxed problems together; a few seconds on one core."""
BATCH_ENTRIES = 2**21
"""Action values of a batch of relaxed problems that are held at once (16 MiB)."""


def branch_and_bound(mdp: TabularMDP, node_limit: int | None = None) -> StationaryOptimum:
    """The best stationary deterministic policy, with a certified upper bound; deterministic and independent of time.

    Args:
        node_limit: largest number of relaxed problems to solve, at least 1; by default as many as DEFAULT_WORK affords.
            When it is reached, the result is the best policy found and the largest bound of what is left.

    Raises:
        InputError: for a node limit below 1.

    >>> kernel = [[[1, 0], [0, 1]], [[0, 1], [0, 1]]]
    >>> mdp = TabularMDP(kernel, [1, 0], horizon=3, reward=[0, 1], axes="state-action", reward_on="arrival")
    >>> best = branch_and_bound(mdp)
    >>> best.policy, best.value, best.optimal
    (array([1, 0]), 3.0, True)
    """
    if node_limit is None:
        node_limit = max(1, DEFAULT_WORK // (mdp.horizon * mdp.n_states**2 * mdp.n_actions))
    if node_limit < 1:
        raise InputError(f"node_limit is {node_limit}, expected a whole number of at least 1.")
    allowance = rounding_allowance(mdp)
    root = relevant_actions(mdp)
    bound, best = _round(mdp, root)
    value = expected_return(mdp, best)
    solved, order = 1, count()
    queue = [(-bound, next(order), root)]
    # A computed bound and a computed return err by at most the allowance each.
    while queue and -queue[0][0] > value + 2 * allowance:
        negated, _, allowed = heapq.heappop(queue)
        undecided = allowed & (allowed.sum(axis=1, keepdims=True) > 1)
        cost = 1 + int(undecided.sum())
        if solved + cost > node_limit:
            heapq.heappush(queue, (negated, next(order), allowed))
            break
        solved += cost
        best, value = _better(mdp, best, value, _round(mdp, allowed)[1])
        probes = np.where(allowed, -negated, -np.inf)
        probes[undecided] = np.minimum(probes[undecided], _probe(mdp, allowed, undecided))
        node_bound = float(probes.max(axis=1).min())
        left = probes > value + 2 * allowance
        if node_bound <= value + 2 * allowance:
            continue
        if not (choices := np.flatnonzero(left.sum(axis=1) > 1)).size:
            # One policy is left and probes bound it from above only: its return settles the node.
            best, value = _better(mdp, best, value, np.argmax(left, axis=1))
            continue
        state = choices[_expected_size(probes[choices] - value, left[choices]).argmin()]
        for action in np.flatnonzero(left[state]):
            child = left.copy()
            child[state] = np.arange(mdp.n_actions) == action
            heapq.heappush(queue, (-min(node_bound, float(probes[state, action])), next(order), child))
    remaining = -queue[0][0] if queue else -np.inf
    return StationaryOptimum(
        policy=best,
        value=value,
        upper=max(value + 2 * allowance, remaining) + allowance,
        tolerance=4 * allowance,
        method="branch and bound",
        evaluations=solved,
    )


def _better(mdp: TabularMDP, best: IntArray, value: float, candidate: IntArray) -> tuple[IntArray, float]:
    """The best policy known and its return, after looking at a candidate."""
    found = expected_return(mdp, candidate)
    return (candidate, found) if found > value else (best, value)


def _round(mdp: TabularMDP, allowed: BoolArray) -> tuple[float, IntArray]:
    """The relaxation's value, and the stationary policy that loses least along the relaxed policy's way."""
    losses_by_step = np.empty((mdp.horizon, *allowed.shape))
    actions = np.empty((mdp.horizon, mdp.n_states), dtype=np.int64)
    values = np.zeros(mdp.n_states)
    for h in reversed(range(mdp.horizon)):
        q = mdp.expected_reward + expected_next_value(mdp, values)
        admissible = np.where(allowed, q, -np.inf)
        actions[h], values = admissible.argmax(axis=-1), admissible.max(axis=-1)
        losses_by_step[h] = values[:, None] - q
    visits = np.empty((mdp.horizon, mdp.n_states))
    arriving = mdp.initial
    for h in range(mdp.horizon):
        visits[h] = arriving
        arriving = arriving @ mdp.transitions[np.arange(mdp.n_states), actions[h]]
    # In states that the relaxed policy does not visit all steps weigh the same.
    weights = np.where(visits.sum(axis=0) > 0, visits, 1.0)
    losses = np.where(allowed, (weights[..., None] * losses_by_step).sum(axis=0), np.inf)
    ties = losses <= losses.min(axis=-1, keepdims=True) + rounding_allowance(mdp)
    return float(mdp.initial @ values), np.argmax(ties, axis=-1)


def _probe(mdp: TabularMDP, allowed: BoolArray, undecided: BoolArray) -> FloatArray:
    """Relaxed values of a node with one state restricted to one action, for each undecided pair in reading order."""
    pairs = np.argwhere(undecided)
    bounds = np.empty(len(pairs))
    block = max(1, BATCH_ENTRIES // allowed.size)
    for start in range(0, len(pairs), block):
        states, actions = pairs[start : start + block].T
        probe = np.arange(len(states))
        reward = np.tile(np.where(allowed, mdp.expected_reward, -np.inf), (len(states), 1, 1))
        reward[probe, states] = -np.inf
        reward[probe, states, actions] = mdp.expected_reward[states, actions]
        values = np.zeros((len(states), mdp.n_states))
        for _ in range(mdp.horizon):
            values = (reward + expected_next_value(mdp, values)).max(axis=-1)
        bounds[start : start + block] = values @ mdp.initial
    return bounds


def _expected_size(excess: FloatArray, left: BoolArray) -> FloatArray:
    """(n,) guess at the subtrees' size when a state is split: it grows quickly with a child's excess over the best."""
    relative = np.where(left, excess, 0) / excess.max()
    return np.asarray((relative**3).sum(axis=1))
