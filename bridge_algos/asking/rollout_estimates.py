"""Features of candidates estimated from rollouts, with bounds on the errors of all their differences.

Everything here is about differences: features are known up to a vector that all candidates share. Half of the failure
probability is split over the K (K - 1) / 2 pairs of candidates and the bounds on each, so that the recommended one, and
the pairs that are looked at, may be chosen from the same rollouts and from any answers.

A session about policies of a simulator of your own, whose delta is shared by features and answers:

>>> from bridge_algos.asking.elicitation import Ball, Elicitation
>>> def rollout(policy, seed):  # features of one episode after a reset with that seed, clipped to [0, 1]
...     return np.clip(policy + 0.1 * np.random.default_rng(seed).normal(size=2), 0, 1)
>>> policies = np.array([[0.2, 0.5], [0.6, 0.4], [0.5, 0.9], [0.3, 0.6]])
>>> samples = np.array([[rollout(policy, seed) for seed in range(2000)] for policy in policies])
>>> estimate = paired_estimate(samples, reach=2**0.5, delta=0.01)
>>> rng, truth = np.random.default_rng(0), np.array([3.0, 1.0])
>>> session = Elicitation(estimate.features, Ball(7.0), samples[:, :50].reshape(-1, 2), 0.04, "0.5nats", rng,
...                       fresh=True, errors=estimate.errors, offline=("2,000 seeds stand for all", estimate.delta))
>>> while not session.done:
...     question = session.ask()
...     session.tell(question, int(rng.random() < 1 / (1 + np.exp(-question.difference @ truth))))
>>> session.certified, round(session.certificate.failure_probability, 9)
(True, 0.05)
>>> bool(np.max(policies @ truth) - policies[session.recommended] @ truth <= 0.5)
True
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import log

import numpy as np

from bridge_algos.asking.feature_errors import EVENTS, FeatureErrors, along_and_across, long_axes
from bridge_algos.asking.rollout_bounds import chance_bound, norm_radius
from bridge_algos.asking.rollout_tree import Tree, followed_sums, relative_features
from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.policies import digits
from bridge_theory.errors import InputError

PILOT_SHARE = 0.1
"""Of given samples, those that axes are taken from."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """K candidates with estimated features.

    Args:
        features: (K, d), up to a vector that all share.
        errors: maps the index i of a candidate to the errors of the K differences to it. With probability
            ``1 - delta`` they hold for all i at once, for every policy that a candidate stands for.
        delta: failure probability.
    """

    features: FloatArray
    errors: Callable[[int], FeatureErrors]
    delta: float


def paired_estimate(samples: FloatArray, reach: float, delta: float) -> Estimate:
    """From rollouts of each of K given policies, best with common random numbers.

    Args:
        samples: (K, n, d) features of n rollouts of each policy; n was fixed beforehand. The n columns (K, d) are
            independent of each other. Rollouts of one column may depend on each other in any way: the closer they are,
            as after a reset with the same seed, the smaller the errors.
        reach: sure bound on the norm of the difference of two rollouts' features; clip features where there is none,
            the clipped ones are then what the teacher is said to judge.
        delta: failure probability.

    Raises:
        InputError: for another shape, a delta outside (0, 1), or features that differ by more than ``reach``.

    >>> rng = np.random.default_rng(0)
    >>> shared, own = rng.random((1, 4000, 3)), rng.random((5, 4000, 3))
    >>> estimate = paired_estimate(0.9 * shared + 0.1 * own, np.sqrt(3), 0.01)
    >>> estimate.errors(0).radii.round(3)
    array([0.   , 0.019, 0.019, 0.019, 0.018])
    """
    samples = np.asarray(samples, dtype=np.float64)
    if samples.ndim != 3 or samples.shape[1] < 2 or 0 in samples.shape or not np.isfinite(samples).all():
        raise InputError(f"samples must be finite numbers of shape (K, n, d) with n at least 2, got {samples.shape}.")
    if not 0 < delta < 1:
        raise InputError(f"delta must lie strictly between 0 and 1, got {delta}.")
    furthest = float(np.linalg.norm(samples - samples[0], axis=2).max())
    if not furthest * (1 - 1e-9) <= reach < np.inf:
        raise InputError(f"reach must bound all distances in a column, of which one is {furthest:.6g}, got {reach}.")
    cut = max(1, int(PILOT_SHARE * samples.shape[1]))
    pilot, own = samples[:, :cut], samples[:, cut:]
    n, log_chance = own.shape[1], pair_log_chance(len(samples), delta)

    def errors(recommended: int) -> FeatureErrors:
        y = own - own[recommended]
        trace = np.vecdot(y, y).mean(axis=1)
        radii = norm_radius(trace, trace, reach, log_chance, n)
        radii[recommended] = 0.0
        before = pilot - pilot[recommended]
        moments = (lambda j: before[j].T @ before[j] / cut), (lambda j: y[j].T @ y[j] / n)
        return FeatureErrors(radii, _closely(moments, recommended, reach, log_chance, n, 0.0))

    return Estimate(own.mean(axis=1), errors, delta)


def coupled_estimate(
    tree: Tree, pilot: Tree, n_actions: int, reach: float, delta: float, merges: bool = False
) -> Estimate:
    """Of every policy that agrees with the demonstrations, from branching rollouts whose number was fixed beforehand.

    The half of delta that is not for pairs is for the visits to merged states, if there are any, by Clopper and
    Pearson.

    Args:
        tree, pilot: n seeds, and others from which axes are taken; both open in the same states.
        n_actions: A.
        reach: bound on the norm of the difference of two trajectories' features.
        delta: failure probability.
        merges: whether candidates stand for policies that act otherwise in merged states.
    """
    chosen = candidate_actions(tree, n_actions)
    merged = reach * chance_bound(tree.merged_visits, tree.n, delta / 2) if merges else 0.0
    n, log_chance = tree.n, pair_log_chance(len(chosen), delta)

    def errors(recommended: int) -> FeatureErrors:
        y = relative_features(tree, chosen[recommended])
        trace = followed_sums(tree, n_actions, np.vecdot(y, y)) / n
        radii = norm_radius(trace, trace, reach, log_chance, n) + merged
        radii[recommended] = merged
        moments = pair_moments(pilot, chosen, recommended), pair_moments(tree, chosen, recommended)
        return FeatureErrors(radii, _closely(moments, recommended, reach, log_chance, n, merged))

    return Estimate(followed_sums(tree, n_actions, tree.features) / n, errors, delta)


Moments = Callable[[int], FloatArray]
"""Of a candidate: the mean (d, d) of y y', with y the difference of its rollouts' features to the recommended one's."""


def _closely(
    moments: tuple[Moments, Moments], recommended: int, reach: float, log_chance: float, n: int, merged: float
) -> Callable[[IntArray], tuple[FloatArray, FloatArray]]:
    """Axes and rests of candidates, remembered; from the moments in the pilot and in the n rollouts."""
    known: dict[int, tuple[FloatArray, float]] = {}

    def one(j: int) -> tuple[FloatArray, float]:
        if j not in known:
            axes, rest = along_and_across(long_axes(moments[0](j)), moments[1](j), reach, log_chance, n)
            known[j] = (0 * axes, merged) if j == recommended else (axes, rest + merged)
        return known[j]

    def closely(index: IntArray) -> tuple[FloatArray, FloatArray]:
        found = [one(j) for j in index.tolist()]
        return np.stack([axes for axes, _ in found]), np.array([rest for _, rest in found])

    return closely


def pair_moments(tree: Tree, chosen: IntArray, recommended: int) -> Moments:
    """Moments of candidates with these actions (K, k) in the open states, summed once for each pattern of branches."""
    y = relative_features(tree, chosen[recommended])
    patterns, group = np.unique(tree.actions, axis=0, return_inverse=True)
    order = np.argsort(group.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(group.ravel(), minlength=len(patterns)))[:-1]
    sums = np.array([rows.T @ rows for rows in np.split(y[order], ends)])

    def moments(j: int) -> FloatArray:
        return np.asarray(sums[((patterns == chosen[j]) | (patterns < 0)).all(axis=1)].sum(axis=0) / tree.n)

    return moments


def pair_log_chance(candidates: int, delta: float) -> float:
    """L such that EVENTS events of chance exp(-L) for each pair of candidates have probability delta / 2 in all."""
    return log(EVENTS * max(candidates * (candidates - 1), 1) / delta)


def candidate_actions(tree: Tree, n_actions: int) -> IntArray:
    """(A^k, k) actions of every candidate in the open states."""
    k = len(tree.open_states)
    return digits(np.arange(n_actions**k), [n_actions] * k)


def candidate_policies(tree: Tree, recorded: IntArray, n_actions: int) -> IntArray:
    """(A^k, S) every candidate; action 0 in merged states."""
    chosen = candidate_actions(tree, n_actions)
    policies = np.repeat(np.where(recorded < 0, 0, recorded)[None], len(chosen), axis=0)
    policies[:, tree.open_states] = chosen
    return policies


def told_apart(trees: tuple[Tree, ...], n_actions: int, rng: np.random.Generator) -> IntArray:
    """One candidate for each set of those whose features are equal in every rollout of the trees.

    Each is hashed: random weights of the rollouts, in 64-bit arithmetic; another set shares a hash with chance 2^-60.
    """
    keys: list[IntArray] = []
    for tree in trees:
        weights = rng.integers(-(2**63), 2**63 - 1, size=tree.n) | 1
        scaled = np.round(tree.features * 2**20).astype(np.int64)
        hashed = (weights[tree.seeds][:, None] * scaled) @ (rng.integers(-(2**63), 2**63 - 1, scaled.shape[1]) | 1)
        with np.errstate(over="ignore"):
            keys.append(followed_sums(tree, n_actions, hashed))
    return np.sort(np.unique(np.stack(keys, axis=1), axis=0, return_index=True)[1])
