r"""Rollouts of every policy that agrees with the demonstrations, on the same random numbers.

Two such policies act alike until a state is visited in which nothing was demonstrated. So one rollout serves them all
until then, and only there it branches, once for each action; a state visited again repeats its action. Per seed this
gives the trajectories of all A^k policies from a few episodes, and the difference of two policies' features is exactly
0 unless an undemonstrated state is visited.

Features are summed from the first such visit on; what came before is common and cancels in every difference. That
remains true without common random numbers, in expectation: up to the first visit the trajectories have one law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from bridge_algos.mdp import Dynamics, FloatArray, IntArray

Number = TypeVar("Number", np.float64, np.int64)

BLOCK = 20_000
"""Seeds simulated at a time."""


@dataclass(frozen=True, eq=False)
class Simulator:
    """An environment that can be run but not read.

    Args:
        n_states, n_actions, horizon: S, A, H.
        start: maps uniform random numbers (m,) to first states (m,).
        step: maps states (m,), actions (m,) and uniform random numbers (m,) to the next states (m,). The same numbers
            must give the same states: this is what a simulator whose seed can be set offers.
    """

    n_states: int
    n_actions: int
    horizon: int
    start: Callable[[FloatArray], IntArray]
    step: Callable[[IntArray, IntArray, FloatArray], IntArray]


def tabular_simulator(dynamics: Dynamics) -> Simulator:
    """A simulator of known dynamics, which hides them."""

    def start(u: FloatArray) -> IntArray:
        return np.asarray(np.searchsorted(dynamics.cumulative_initial, u, side="right"))

    def step(states: IntArray, actions: IntArray, u: FloatArray) -> IntArray:
        return np.asarray((dynamics.cumulative[states, actions] > u[:, None]).argmax(axis=1))

    return Simulator(dynamics.n_states, dynamics.n_actions, dynamics.horizon, start, step)


@dataclass(frozen=True, eq=False)
class Tree:
    """Branching rollouts of n seeds; seeds that never branch are counted but not kept.

    Args:
        n: number of seeds.
        open_states: (k,) the states in which rollouts branch.
        seeds: (m,) the seed of each branch.
        actions: (m, k) the actions that a branch takes in the open states, -1 where it does not visit one.
        features: (m, d) summed from the first visit to an open or merged state on.
        merged_visits: seeds with a branch that visits a merged state.
        episodes: trajectories simulated, every branch counted as a whole one.
    """

    n: int
    open_states: IntArray
    seeds: IntArray
    actions: IntArray
    features: FloatArray
    merged_visits: int
    episodes: int


def branch(
    simulator: Simulator,
    recorded: IntArray,
    merged: IntArray,
    per_step: FloatArray,
    n: int,
    rng: np.random.Generator,
) -> Tree:
    """Roll out n fresh seeds.

    Args:
        recorded: (S,) demonstrated actions, -1 in the other states.
        merged: undemonstrated states in which one action, 0, stands for all; visits to them are counted.
        per_step: (S, A, d) features of one step.
        n: at least 1.

    Example (two states; nothing is demonstrated in state 1, to which a fair coin leads):

    >>> simulator = Simulator(2, 2, 2, lambda u: np.zeros(len(u), int), lambda s, a, u: (u < 0.5).astype(int))
    >>> tree = branch(simulator, np.array([0, -1]), np.array([], int), np.eye(4).reshape(2, 2, 4), 1000,
    ...               np.random.default_rng(0))
    >>> tree.episodes, len(np.unique(tree.seeds)), tree.actions[:2].tolist()
    (1534, 534, [[0], [1]])
    """
    is_merged = np.isin(np.arange(simulator.n_states), merged)
    open_states = np.flatnonzero((recorded < 0) & ~is_merged)
    fallback = np.where(recorded < 0, 0, recorded)
    parts, visits, episodes = [], 0, 0
    for begin in range(0, n, BLOCK):
        size = min(BLOCK, n - begin)
        uniforms = rng.random((simulator.horizon + 1, size))
        part = _block(simulator, open_states, fallback, is_merged, per_step, uniforms)
        episodes += len(part[0])
        visits += len(np.unique(part[0][part[3]]))
        kept = (part[1] >= 0).any(axis=1)
        parts.append((part[0][kept] + begin, part[1][kept], part[2][kept]))
    seeds, actions, features = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Tree(n, open_states, seeds, actions, features, visits, episodes)


def _block(
    simulator: Simulator,
    open_states: IntArray,
    fallback: IntArray,
    is_merged: np.ndarray,
    per_step: FloatArray,
    uniforms: FloatArray,
) -> tuple[IntArray, IntArray, FloatArray, np.ndarray]:
    """Seed, actions in open states, features, and whether a merged state was visited, of every branch."""
    n_actions, size = simulator.n_actions, uniforms.shape[1]
    place = np.full(simulator.n_states, -1)
    place[open_states] = np.arange(len(open_states))
    seeds: IntArray = np.arange(size)
    states = simulator.start(uniforms[0])
    chosen: IntArray = np.full((size, len(open_states)), -1, dtype=np.int64)
    features: FloatArray = np.zeros((size, per_step.shape[2]))
    touched = np.zeros(size, dtype=bool)
    for h in range(simulator.horizon):
        at = place[states]
        new = at >= 0
        new[new] = chosen[new, at[new]] < 0
        rows = np.repeat(np.arange(len(seeds)), np.where(new, n_actions, 1))
        if len(rows) > len(seeds):
            seeds, states, at, new = seeds[rows], states[rows], at[rows], new[rows]
            features, touched, chosen = features[rows], touched[rows], chosen[rows]
            chosen[new, at[new]] = np.tile(np.arange(n_actions), int(new.sum()) // n_actions)
        actions = fallback[states]
        inside = at >= 0
        actions[inside] = chosen[inside, at[inside]]
        touched |= is_merged[states]
        counted = touched | (chosen >= 0).any(axis=1)
        features[counted] += per_step[states[counted], actions[counted]]
        states = simulator.step(states, actions, uniforms[h + 1, seeds])
    return seeds, chosen, features, touched


def followed_sums(tree: Tree, n_actions: int, values: NDArray[Number]) -> NDArray[Number]:
    """(A^k, ...) for every candidate the sum of the values (m, ...) of the branches that it follows."""
    patterns, group = np.unique(tree.actions, axis=0, return_inverse=True)
    sums = np.zeros((len(patterns), *values.shape[1:]), dtype=values.dtype)
    np.add.at(sums, group.ravel(), values)
    k = len(tree.open_states)
    total = np.zeros((n_actions,) * k + values.shape[1:], dtype=values.dtype)
    for pattern, part in zip(patterns, sums, strict=True):
        total[tuple(slice(None) if a < 0 else int(a) for a in pattern)] += part
    return np.asarray(total.reshape(-1, *values.shape[1:]))


def relative_features(tree: Tree, actions: IntArray) -> FloatArray:
    """(m, d) features of every branch less those of the branch that one candidate (k,) follows with the same seed."""
    _, row = np.unique(tree.seeds, return_inverse=True)
    followed = follows(tree, actions)
    own = np.zeros((len(np.unique(row)), tree.features.shape[1]))
    own[row[followed]] = tree.features[followed]
    return np.asarray(tree.features - own[row])


def follows(tree: Tree, actions: IntArray) -> np.ndarray:
    """(m,) whether a candidate with these actions in the open states follows each branch."""
    return np.asarray(((tree.actions == actions) | (tree.actions < 0)).all(axis=1))
