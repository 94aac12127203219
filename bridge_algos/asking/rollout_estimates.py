"""Features of candidates estimated from rollouts, with a sure bound on the errors of all their differences.

Everything here is about differences: features are known up to a vector that all candidates share.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import log

import numpy as np

from bridge_algos.asking.rollout_bounds import chance_bound, norm_radius
from bridge_algos.asking.rollout_tree import Tree
from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.policies import digits

MOST_SPECTRA = 256
"""Candidates whose second moments are decomposed, at most; the others are bounded by their traces."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """Candidates with estimated features.

    Args:
        policies: (K, S).
        features: (K, d), up to a vector that all share.
        error: maps the index i of a candidate to a number r(i): with probability ``1 - delta``, for all i at once,
            every policy that agrees with the demonstrations has a candidate such that the difference of its features to
            candidate i's is within r(i), in norm, of the estimated difference.
        delta: failure probability.
        episodes: trajectories simulated.
    """

    policies: IntArray
    features: FloatArray
    error: Callable[[int], float]
    delta: float
    episodes: int


def coupled_estimate(tree: Tree, recorded: IntArray, n_actions: int, reach: float, delta: float) -> Estimate:
    r"""From branching rollouts, whose number was fixed before they were made.

    Half of delta is for the visits to merged states, if there are any, by Clopper and Pearson; the other half is split
    over the K (K - 1) / 2 pairs of candidates, so that the recommended one may be chosen from the same rollouts and
    from any answers.

    Args:
        tree: n seeds.
        recorded: (S,) demonstrated actions, -1 in the other states.
        n_actions: A.
        reach: bound on the norm of the difference of two trajectories' features.
        delta: failure probability.
    """
    merges = ((recorded < 0).sum() - len(tree.open_states)) > 0
    chosen = candidate_actions(tree, n_actions)
    policies = np.repeat(np.where(recorded < 0, 0, recorded)[None], len(chosen), axis=0)
    policies[:, tree.open_states] = chosen
    merged = reach * chance_bound(tree.merged_visits, tree.n, delta / 2) if merges else 0.0
    log_chance = pair_log_chance(len(chosen), delta)
    known: dict[int, float] = {}

    def error(recommended: int) -> float:
        if recommended not in known:
            known[recommended] = widest_radius(tree, chosen[recommended], n_actions, reach, log_chance, tree.n)
        return known[recommended] + merged

    return Estimate(policies, followed_sums(tree, n_actions, tree.features) / tree.n, error, delta, tree.episodes)


def independent_estimate(
    policies: IntArray, samples: FloatArray, reach: float, delta: float, episodes: int
) -> Estimate:
    """From rollouts of each candidate on its own, for simulators whose seeds cannot be set.

    Args:
        policies: (K, S), all candidates; none is merged.
        samples: (K, n, d) independent vectors, whose expectations are the features up to a vector that all share: for
            example :func:`bridge_algos.asking.rollout_tree.suffix_features`.
        reach: bound on the norm of a vector.
        delta: failure probability, split over the candidates.
        episodes: trajectories simulated.
    """
    n = samples.shape[1]
    trace = np.vecdot(samples, samples).mean(axis=1)
    top = np.array([np.linalg.eigvalsh(rows.T @ rows / n)[-1] for rows in samples])
    radii = norm_radius(trace, top, reach, log(3 * len(policies) / delta), n)
    pair = 2 * float(radii.max()) if len(policies) > 1 else 0.0
    return Estimate(policies, samples.mean(axis=1), lambda _: pair, delta, episodes)


def pair_log_chance(candidates: int, delta: float) -> float:
    """L such that three events of chance exp(-L) for each pair of candidates have probability delta / 2 in all."""
    return log(3 * max(candidates * (candidates - 1), 1) / delta)


def candidate_actions(tree: Tree, n_actions: int) -> IntArray:
    """(A^k, k) actions of every candidate in the open states."""
    k = len(tree.open_states)
    return digits(np.arange(n_actions**k), [n_actions] * k)


def followed_sums(tree: Tree, n_actions: int, values: FloatArray) -> FloatArray:
    """(A^k, ...) for every candidate the sum of the values (m, ...) of the branches that it follows."""
    patterns, group = np.unique(tree.actions, axis=0, return_inverse=True)
    sums = np.zeros((len(patterns), *values.shape[1:]))
    np.add.at(sums, group.ravel(), values)
    k = len(tree.open_states)
    total = np.zeros((n_actions,) * k + values.shape[1:])
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


def widest_radius(tree: Tree, actions: IntArray, n_actions: int, reach: float, log_chance: float, n: int) -> float:
    """The largest error of a candidate's difference to the one with these actions.

    Args:
        n: number of seeds that the radius is for; another than the tree's only to predict.
    """
    y = relative_features(tree, actions)
    trace = followed_sums(tree, n_actions, np.vecdot(y, y)) / tree.n
    if len(trace) == 1:
        return 0.0
    crude = norm_radius(trace, trace, reach, log_chance, n)
    order = np.argsort(-crude)
    chosen = candidate_actions(tree, n_actions)
    widest = 0.0
    for j in order[:MOST_SPECTRA]:
        if crude[j] <= widest:
            return widest
        own = y[follows(tree, chosen[j])]
        top = np.linalg.eigvalsh(own.T @ own / tree.n)[-1:]
        widest = max(widest, float(norm_radius(trace[j : j + 1], top, reach, log_chance, n)[0]))
    rest = crude[order[MOST_SPECTRA:]]
    return max(widest, float(rest.max(initial=0.0)))
