r"""Which two items of a pool to ask about. Any choice is valid (companion G8); some need fewer answers than others.

================  =====================================================================================================
``pool``          the pair that lowers most the variance v'A^-1 v of the critical difference v (G8)
``information``   the pair with the largest mutual information between answer and weights (the rule of APReL)
``paper``         the paper's: the pair of greatest width ||x||_(A^-1)
``challenger``    an item of the recommended candidate against one of the critical contender
``random``        two items at random
================  =====================================================================================================
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations
from math import log, sqrt

import numpy as np
from scipy.special import expit

from bridge_algos.asking.gap import Critical
from bridge_algos.mdp import FloatArray, IntArray
from bridge_theory.errors import InputError

SMALL = 200
"""Items up to which all pairs are scored; of a larger pool, those of a shortlist."""

TRIES = 1000
"""Pairs drawn at random before all pairs are looked through for one that may be asked."""

DIRECTIONS, EACH = 24, 6
"""A shortlist holds the items that lie farthest in so many directions, so many for each."""

GAUSS, MASSES = np.polynomial.hermite_e.hermegauss(9)


@dataclass(frozen=True, eq=False)
class State:
    """What a rule may look at.

    Args:
        items: (M, d) features of the pool, distinct.
        shown: for a candidate, which of the items its trajectories show.
        mean: (d,) of the fit.
        covariance: (d, d), the inverse of the curvature A at the fit.
        critical: where the certificate fails.
        recommended: index of the recommended candidate.
    """

    items: FloatArray
    shown: Callable[[int], IntArray]
    mean: FloatArray
    covariance: FloatArray
    critical: Critical
    recommended: int


def _squared_widths(state: State) -> FloatArray:
    """(M, M) x' A^-1 x of every pair."""
    y = state.items @ np.linalg.cholesky(state.covariance)
    norms = np.vecdot(y, y)
    return np.asarray(np.maximum(norms[:, None] + norms[None] - 2 * (y @ y.T), 0.0))


def _chances(state: State) -> FloatArray:
    z = state.items @ state.mean
    return np.asarray(expit(z[:, None] - z[None]))


def _pool(state: State) -> FloatArray:
    p = _chances(state)
    spread = p * (1 - p)
    along = state.items @ (state.covariance @ state.critical.direction)
    return np.asarray(spread * (along[:, None] - along[None]) ** 2 / (1 + spread * _squared_widths(state)))


def _information(state: State) -> FloatArray:
    z = state.items @ state.mean
    z = z[:, None] - z[None]
    width = np.sqrt(_squared_widths(state))
    mean_chance, mean_entropy = np.zeros_like(z), np.zeros_like(z)
    for node, mass in zip(GAUSS, MASSES / sqrt(2 * np.pi), strict=True):
        p = expit(z + width * node)
        mean_chance += mass * p
        mean_entropy += mass * _entropy(p)
    return np.asarray(_entropy(mean_chance) - mean_entropy)


def _entropy(p: FloatArray) -> FloatArray:
    p = np.clip(p, 1e-15, 1 - 1e-15)
    return np.asarray(-p * np.log(p) - (1 - p) * np.log1p(-p)) / log(2)


def _paper(state: State) -> FloatArray:
    return _squared_widths(state)


SCORES: dict[str, Callable[[State], FloatArray]] = {"pool": _pool, "information": _information, "paper": _paper}
"""Scores (M, M) of ordered pairs; the highest is asked."""

RULES = ("pool", "challenger", "information", "paper", "random")


def check_rule(name: str) -> str:
    """The name, when there is such a rule.

    >>> check_rule("best")
    Traceback (most recent call last):
    bridge_theory.errors.InputError: asking must be one of pool, challenger, information, paper, random, got 'best'.
    """
    if name not in RULES:
        raise InputError(f"asking must be one of {', '.join(RULES)}, got {name!r}.")
    return name


def choose(name: str, state: State, rng: np.random.Generator, asked: set[tuple[int, int]] | None) -> tuple[int, int]:
    """The items (first, second) that a rule asks about.

    Args:
        asked: pairs (smaller, larger) of items that must not be asked again; None where asking again is a fresh draw.

    Raises:
        InputError: when no pair is left.
    """
    asked = asked or set()
    pair = _scored(name, state, rng, asked) if name in SCORES else _drawn(name, state, rng, asked)
    if pair is None and len(asked) < len(state.items) * (len(state.items) - 1) // 2:
        pair = _drawn("random", state, rng, asked) or _first_left(len(state.items), asked)
    if pair is None:
        raise InputError("every pair of the pool has been asked; give a larger pool.")
    return pair


def _scored(name: str, state: State, rng: np.random.Generator, asked: set[tuple[int, int]]) -> tuple[int, int] | None:
    """The highest score among the pairs of a shortlist; None where none of them may be asked."""
    short = _shortlist(name, state, rng)
    scores = SCORES[name](replace(state, items=state.items[short]))
    np.fill_diagonal(scores, -np.inf)
    if asked:
        place = np.full(len(state.items), -1)
        place[short] = np.arange(len(short))
        pairs = place[np.array(sorted(asked))]
        pairs = pairs[(pairs >= 0).all(axis=1)]
        scores[pairs[:, 0], pairs[:, 1]] = scores[pairs[:, 1], pairs[:, 0]] = -np.inf
    first, second = divmod(int(scores.argmax()), len(short))
    return (int(short[first]), int(short[second])) if np.isfinite(scores[first, second]) else None


def _shortlist(name: str, state: State, rng: np.random.Generator) -> IntArray:
    """The items whose pairs are scored: those that are extreme in what the rule looks at.

    A score grows with the distance of two items: along the critical direction and in predicted utility (``pool``), or
    in all directions, scaled by how little is known about them (``information``, ``paper``). So the best pair, or one
    that is nearly as good, consists of items that are farthest in some direction.
    """
    items = state.items
    if len(items) <= SMALL:
        return np.arange(len(items))
    if name == "pool":
        angles = np.arange(DIRECTIONS) * (2 * np.pi / DIRECTIONS)
        seen = items @ np.stack([state.mean, state.covariance @ state.critical.direction], axis=1)
        directions = np.stack([np.cos(angles), np.sin(angles)]) / np.maximum(seen.std(axis=0), 1e-300)[:, None]
        return extremes(seen, directions, EACH)
    directions = rng.normal(size=(items.shape[1], DIRECTIONS))
    return extremes(items, np.linalg.cholesky(state.covariance) @ directions, EACH)


def _drawn(name: str, state: State, rng: np.random.Generator, asked: set[tuple[int, int]]) -> tuple[int, int] | None:
    """Two items at random; None where none was found that may be asked."""
    everything = np.arange(len(state.items))
    first, second = everything, everything
    if name == "challenger":
        first, second = state.shown(state.recommended), state.shown(state.critical.contender)
    for _ in range(TRIES if len(first) and len(second) else 0):
        i, j = int(rng.choice(first)), int(rng.choice(second))
        if i != j and (min(i, j), max(i, j)) not in asked:
            return i, j
    return None


def _first_left(size: int, asked: set[tuple[int, int]]) -> tuple[int, int] | None:
    return next((pair for pair in combinations(range(size), 2) if pair not in asked), None)


def extremes(points: FloatArray, directions: FloatArray, each: int) -> IntArray:
    """The points (M, k) that lie farthest along the directions (k, D), ``each`` of them for every direction.

    >>> extremes(np.array([[0.0], [3.0], [-1.0], [2.0]]), np.array([[1.0, -1.0]]), 1)
    array([1, 2])
    """
    far = np.argpartition(-(points @ directions), min(each, len(points)) - 1, axis=0)[:each]
    return np.unique(far)
