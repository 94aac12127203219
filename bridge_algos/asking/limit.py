r"""How few questions could do: a yardstick for every way of asking (companion G9). An estimate.

With the correct answers :math:`I` (candidates within eps of the best under the true weights) and :math:`Alt(\pi)` the
weights under which :math:`\pi` is not within eps of the best,

.. math:: D = \max_{\pi \in I} \max_{design} \inf_{w \in Alt(\pi)} \sum_x design(x)\,
          KL(\sigma(\langle x, w^*\rangle) \| \sigma(\langle x, w\rangle)),

designs being mixtures of the questions of one pool. A method that is wrong with probability at most delta needs about
:math:`kl(1 - \delta, \delta) / D` questions from this pool on average, exactly at least so many where one answer alone
is correct (Degenne and Koolen's bound holds in the limit of small delta otherwise). The numbers are floats: D is
bracketed by a double-oracle method, a linear program over questions against a convex program for each contender.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, log

import numpy as np
from scipy.optimize import linprog
from scipy.special import expit

from bridge_algos.asking.answers import log_sigmoid
from bridge_algos.asking.candidates import deviations
from bridge_algos.asking.interior import CutBall, inner_points, minimise
from bridge_algos.asking.rules import extremes
from bridge_algos.asking.tabular import Problem
from bridge_algos.mdp import FloatArray, IntArray
from bridge_theory.errors import InputError

CONTENDERS = 256
"""Contenders that a true answer is compared with, at most: those that a normal approximation says are hardest."""

FARTHEST = 200
"""Items of a larger pool whose pairs are the questions: D over all pairs can only be larger, the yardstick smaller."""

PRECISION, ROUNDS = 0.02, 60
"""How close the ends of the bracket of D come, relatively, and how many designs are tried at most."""

STRENGTHS = np.geomspace(10.0, 1e6, 11)
"""Of the inner programs; they leave an error of about twenty over the last, in nats."""

NEW_POINTS, FIRST_QUESTIONS = 8, 200
"""Most confusing weights added for each design, and questions of the first design."""


@dataclass(frozen=True)
class Limit:
    """The yardstick of a problem; an estimate.

    Args:
        rate: D in nats per question, from above: the other end would give a larger yardstick.
        reached: what the best design found reaches, from below up to the precision of the inner programs.
        questions: kl(1 - delta, delta) / rate; 0 where no weights make the answer wrong.
        correct: how many candidates are correct answers.
        candidate: index of the correct answer that is easiest to show.
    """

    rate: float
    reached: float
    questions: float
    correct: int
    candidate: int


@dataclass(frozen=True, eq=False)
class Setting:
    """What D is computed for.

    Args:
        features: (N, d) of the candidates.
        truth: (d,) the true weights.
        weight_bound: W.
        nats: eps.
        questions: (M, d) feature differences of the pool's questions.
        cones: rows (B, k, d) that B candidates must make nonnegative if they are the best; None for the ball alone.
    """

    features: FloatArray
    truth: FloatArray
    weight_bound: float
    nats: float
    questions: FloatArray
    cones: Callable[[IntArray], FloatArray] | None = None


def tabular_limit(problem: Problem, nats: float, delta: float) -> Limit:
    """The yardstick of a tabular problem, over all pairs of the session's own pool, or of FARTHEST items of it.

    The cones hold each contender against the policies that differ from it in one state; where another policy would be
    the best, this leaves more weights in, which makes D smaller and the yardstick larger.

    >>> from bridge_algos.asking.tabular import build_problem
    >>> from bridge_algos.asking.utility import simulated_utility
    >>> from bridge_algos.envs.registry import make_mdp
    >>> mdp = make_mdp("starmdp")
    >>> utility = simulated_utility(mdp, "state_action_counts", utility_range=5)
    >>> problem = build_problem(mdp, utility, 2, np.random.default_rng(0), pool=60)
    >>> found = tabular_limit(problem, nats=0.5, delta=0.05)
    >>> bool(found.reached <= found.rate <= 1.03 * found.reached)
    True
    """
    candidates, utility = problem.candidates, problem.utility

    def cones(index: IntArray) -> FloatArray:
        return candidates.features[index][:, None] - deviations(
            problem.mdp, utility.embedding, candidates.policies[index]
        )

    questions = all_pairs(farthest(utility.embedding.of_trajectories(problem.pool)))
    rows = cones if candidates.complete else None
    setting = Setting(candidates.features, utility.weights, utility.weight_bound, nats, questions, rows)
    return limit(setting, delta)


def farthest(items: FloatArray) -> FloatArray:
    """The distinct items (M, d), or where there are more than FARTHEST those that lie farthest in random directions.

    Questions that tell much compare items that are far apart.
    """
    items = np.unique(items, axis=0)
    if len(items) <= FARTHEST:
        return items
    directions = np.random.default_rng(0).normal(size=(items.shape[1], FARTHEST // 2))
    return np.asarray(items[extremes(items, directions, 2)])


def all_pairs(items: FloatArray) -> FloatArray:
    """(M, d) the differences of all pairs of distinct items, each pair once."""
    items = np.unique(items, axis=0)
    first, second = np.triu_indices(len(items), 1)
    return np.asarray(np.unique(items[first] - items[second], axis=0))


def limit(setting: Setting, delta: float) -> Limit:
    """The yardstick of a setting.

    Raises:
        InputError: when delta does not lie between 0 and 1/2, or eps is not positive.
    """
    if not 0 < delta < 0.5:
        raise InputError(f"the yardstick needs a delta strictly between 0 and 1/2, got {delta}.")
    if not setting.nats > 0:
        raise InputError(f"the yardstick needs a gap above 0 nats, got {setting.nats}.")
    utilities = setting.features @ setting.truth
    correct = np.flatnonzero(utilities >= utilities.max() - setting.nats)
    rate, reached, chosen = 0.0, 0.0, int(utilities.argmax())
    for candidate in correct[np.argsort(-utilities[correct])]:
        high, low = information_rate(setting, int(candidate), at_least=reached)
        if low > reached:
            reached, chosen = low, int(candidate)
        rate = max(rate, high)
        if reached == inf:
            break
    bits = (1 - 2 * delta) * log((1 - delta) / delta)
    return Limit(rate, reached, bits / rate if rate else inf, len(correct), chosen)


def information_rate(setting: Setting, candidate: int, at_least: float = 0.0) -> tuple[float, float]:
    """Both ends of the bracket of max over designs of inf over Alt(candidate), in nats per question.

    Args:
        at_least: stop when the value is known not to exceed this.
    """
    alternatives, starts = _alternatives(setting, candidate)
    if not len(starts):
        return inf, inf
    support = np.unique(np.linspace(0, len(setting.questions) - 1, FIRST_QUESTIONS).astype(np.int64))
    design = np.full(len(support), 1 / len(support))
    table = np.zeros((0, len(setting.questions)))
    low, high = 0.0, inf
    for _ in range(ROUNDS):
        points, values = _confusing(setting, alternatives, starts, support, design)
        low = max(low, float(values.min()))
        worst = np.argsort(values)[:NEW_POINTS]
        table = np.concatenate([table, divergences(setting.truth, points[worst], setting.questions)])
        support, design, value = best_design(table)
        high = min(high, value)
        if high - low <= PRECISION * high or high <= at_least:
            break
    return high, low


def divergences(truth: FloatArray, weights: FloatArray, questions: FloatArray) -> FloatArray:
    r"""(B, M) the divergences :math:`KL(\sigma(\langle x, w^*\rangle) \| \sigma(\langle x, w\rangle))` in nats.

    >>> divergences(np.array([0.0]), np.array([[0.0], [2.0]]), np.array([[1.0]])).round(3)
    array([[0.   ],
           [0.434]])
    """
    z, true = weights @ questions.T, questions @ truth
    p = expit(true)
    same = p * log_sigmoid(true) + (1 - p) * log_sigmoid(-true)
    return np.asarray(np.maximum(same - p * log_sigmoid(z) - (1 - p) * log_sigmoid(-z), 0.0))


def best_design(table: FloatArray) -> tuple[IntArray, FloatArray, float]:
    """The mixture of columns whose smallest row is largest: its columns, their shares, and an upper bound on its value.

    A linear program over few columns, to which those that its mixture of rows favours are added.

    >>> best_design(np.array([[1.0, 0.0, 0.2], [0.0, 1.0, 0.2]]))
    (array([0, 1]), array([0.5, 0.5]), 0.5)
    """
    columns = np.unique(table.argmax(axis=1))
    high = inf
    for _ in range(200):
        n_rows, n_columns = len(table), len(columns)
        found = linprog(
            np.append(np.zeros(n_columns), -1.0),
            A_ub=np.hstack([-table[:, columns], np.ones((n_rows, 1))]),
            b_ub=np.zeros(n_rows),
            A_eq=np.append(np.ones(n_columns), 0.0)[None],
            b_eq=[1.0],
            method="highs",
        )
        rows = np.maximum(-found.ineqlin.marginals, 0)
        gains = rows @ table / rows.sum()
        high = min(high, float(gains.max()))
        if high <= -found.fun * (1 + 1e-6) + 1e-12:
            break
        columns = np.unique(np.append(columns, np.argpartition(-gains, min(20, len(gains)) - 1)[:20]))
    shares = np.maximum(found.x[:-1], 0)
    used = shares > 0
    return columns[used], shares[used] / shares.sum(), high


def _alternatives(setting: Setting, candidate: int) -> tuple[CutBall, FloatArray]:
    """For each contender the weights under which it is the best and beats the candidate by eps; and a point inside."""
    v = setting.features - setting.features[candidate]
    contenders = np.flatnonzero(np.linalg.norm(v, axis=1) * setting.weight_bound > setting.nats)
    if not len(contenders):
        return CutBall(v[:0, None], v[:0, :1], setting.weight_bound, v.shape[1]), v[:0]
    if len(contenders) > CONTENDERS:
        p = expit(setting.questions @ setting.truth)
        information = (setting.questions.T * (p * (1 - p) / len(p))) @ setting.questions
        covariance = np.linalg.pinv(information, rcond=1e-9, hermitian=True)
        away = np.maximum(setting.nats - v[contenders] @ setting.truth, 0) ** 2
        hardness = away / np.einsum("bd,de,be->b", v[contenders], covariance, v[contenders])
        contenders = contenders[np.argsort(hardness)[:CONTENDERS]]
    rows = v[contenders, None]
    if setting.cones is not None:
        rows = np.concatenate([rows, setting.cones(contenders)], axis=1)
    norms = np.linalg.norm(rows, axis=2)
    real = norms > 1e-9
    rows = np.where(real, 1 / np.where(real, norms, 1.0), 0.0)[..., None] * rows
    offsets = np.where(real, 0.0, -1.0)  # a rival of the same features asks nothing
    offsets[:, 0] = setting.nats / norms[:, 0]
    sets = CutBall(rows, offsets, setting.weight_bound, rows.shape[2])
    found, points = inner_points(sets)
    return sets[found], points


def _confusing(
    setting: Setting, alternatives: CutBall, starts: FloatArray, support: IntArray, design: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """For each contender the weights (B, d) that a design tells least from the true ones, and how well it does (B,)."""
    x = setting.questions[support]
    chances = expit(x @ setting.truth)
    outer = (x[:, :, None] * x[:, None, :]).reshape(len(x), x.shape[1] ** 2)
    size = x.shape[1]

    def told(w: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        p = expit(w @ x.T)
        curvature = ((p * (1 - p) * design) @ outer).reshape(len(w), size, size)
        return divergences(setting.truth, w, x) @ design, ((p - chances) * design) @ x, curvature

    points = minimise(told, alternatives, starts, STRENGTHS)
    return points, divergences(setting.truth, points, x) @ design
