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
from dataclasses import dataclass
from math import log, sqrt

import numpy as np
from scipy.special import expit

from bridge_algos.asking.gap import Critical
from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

GAUSS, MASSES = np.polynomial.hermite_e.hermegauss(9)


@dataclass(frozen=True, eq=False)
class State:
    """What a rule may look at.

    Args:
        items: (M, d) features of the pool.
        owners: (M,) candidate that an item was drawn from, -1 where unknown.
        mean: (d,) of the fit.
        covariance: (d, d), the inverse of the curvature A at the fit.
        critical: where the certificate fails.
        recommended: index of the recommended candidate.
        groups: (M,) items of equal features share a number.
    """

    items: FloatArray
    owners: np.ndarray
    mean: FloatArray
    covariance: FloatArray
    critical: Critical
    recommended: int
    groups: np.ndarray


Rule = Callable[[State, np.random.Generator], FloatArray]
"""Scores (M, M) of ordered pairs; the highest is asked."""


def _squared_widths(state: State) -> FloatArray:
    """(M, M) x' A^-1 x of every pair."""
    y = state.items @ np.linalg.cholesky(state.covariance)
    norms = np.vecdot(y, y)
    return np.asarray(np.maximum(norms[:, None] + norms[None] - 2 * (y @ y.T), 0.0))


def _chances(state: State) -> FloatArray:
    z = state.items @ state.mean
    return np.asarray(expit(z[:, None] - z[None]))


def _pool(state: State, rng: np.random.Generator) -> FloatArray:
    p = _chances(state)
    spread = p * (1 - p)
    along = state.items @ (state.covariance @ state.critical.direction)
    return np.asarray(spread * (along[:, None] - along[None]) ** 2 / (1 + spread * _squared_widths(state)))


def _information(state: State, rng: np.random.Generator) -> FloatArray:
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


def _paper(state: State, rng: np.random.Generator) -> FloatArray:
    return _squared_widths(state)


def _challenger(state: State, rng: np.random.Generator) -> FloatArray:
    chosen = (state.owners == state.recommended)[:, None] & (state.owners == state.critical.contender)[None]
    return np.where(chosen, rng.random(chosen.shape), -1.0)


def _random(state: State, rng: np.random.Generator) -> FloatArray:
    return rng.random((len(state.items), len(state.items)))


RULES: dict[str, Rule] = {
    "pool": _pool,
    "challenger": _challenger,
    "information": _information,
    "paper": _paper,
    "random": _random,
}


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
    """The pair (first, second) of the pool that a rule asks about.

    Args:
        asked: pairs (smaller, larger) that must not be asked again; None where asking again is a fresh draw.

    Raises:
        InputError: when no pair with a difference is left.
    """
    scores = RULES[name](state, rng)
    scores = np.where(state.groups[:, None] != state.groups[None], scores, -np.inf)
    if asked:
        pairs = np.array(sorted(asked))
        scores[pairs[:, 0], pairs[:, 1]] = scores[pairs[:, 1], pairs[:, 0]] = -np.inf
    best = int(scores.argmax())
    first, second = divmod(best, len(state.items))
    if not np.isfinite(scores[first, second]):
        raise InputError("every pair of the pool has been asked, or shows no difference; give a larger pool.")
    return first, second
