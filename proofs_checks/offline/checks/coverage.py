"""Events of the offline part with a stated failure probability, simulated and judged by exact binomial tails."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from bridge_theory import (
    missing_mass_good_turing,
    missing_mass_observed,
    offline_radius_stochastic,
    policy_error_sharp,
    trajectory_kl,
    transition_error_counts,
    transition_kl_budget,
)
from proofs_checks.context import Context
from proofs_checks.coverage import simulate
from proofs_checks.exact.every import QUICK
from proofs_checks.outcome import Outcome

Floats = NDArray[np.float64]


def _rows(rng: np.random.Generator, shape: tuple[int, ...]) -> Floats:
    """Rows with some rare successors and some impossible ones."""
    weights = rng.exponential(size=shape) ** 3 * (rng.random(shape) < 0.7)
    weights[..., 0] += 1e-3
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))


def _row_kl(p: Floats, q: Floats) -> float:
    seen = p > 0
    return float((p[seen] * np.log(p[seen] / q[seen])).sum())


def transition_budget(*, shrink: float = 1.0, context: Context = QUICK) -> Outcome:
    """T10: sum N KL(P-hat || P*) within the budget at every time at once, for pairs chosen adaptively (delta = 1/2)."""
    size, pairs, steps, delta = 3, 4, 60, 0.5

    def fails(rng: np.random.Generator) -> bool:
        kernel = _rows(rng, (pairs, size))
        counts = np.zeros((pairs, size))
        for _ in range(steps):
            used = counts.sum(axis=1)
            surprise = [used[k] * _row_kl(counts[k] / used[k], kernel[k]) if used[k] else 0.0 for k in range(pairs)]
            if sum(surprise) > shrink * transition_kl_budget.estimate(S=size, counts=used, delta=delta):
                return True
            # use the pair that looks worst, or one at random: the bound must not mind
            pair = int(np.argmax(surprise)) if rng.random() < 0.5 else int(rng.integers(pairs))
            counts[pair, rng.choice(size, p=kernel[pair])] += 1
        return False

    trials = context.pick(quick=40, full=150)
    return simulate("KL budget", fails, Fraction(1, 2), trials, context.seed)


def _demonstrations(
    rng: np.random.Generator, start: Floats, kernel: Floats, policy: Floats, n: int, horizon: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    states, actions = np.zeros((n, horizon), dtype=int), np.zeros((n, horizon), dtype=int)
    for i in range(n):
        state = int(rng.choice(len(start), p=start))
        for t in range(horizon):
            action = int(rng.choice(policy.shape[1], p=policy[state]))
            states[i, t], actions[i, t] = state, action
            state = int(rng.choice(len(start), p=kernel[state, action]))
    return states, actions


def step_wise_transition_error(*, shrink: float = 1.0, context: Context = QUICK) -> Outcome:
    """T10 for the step-wise count estimate: H^2(P-hat^pi*, P*^pi*) below the formula (delta = 1/2), a Markov chain."""
    size, n, horizon, delta = 3, 8, 3, 0.5

    def fails(rng: np.random.Generator) -> bool:
        start, kernel = _rows(rng, (size,)), _rows(rng, (size, 1, size))
        states, _ = _demonstrations(rng, start, kernel, np.ones((size, 1)), n, horizon)
        overlap = np.sqrt(start * np.bincount(states[:, 0], minlength=size) / n)
        cells = []
        for t in range(horizon - 1):
            counts = np.zeros((size, size))
            np.add.at(counts, (states[:, t], states[:, t + 1]), 1)
            used = counts.sum(axis=1)
            cells += list(used)
            estimate = counts / np.maximum(used, 1)[:, None]
            overlap = overlap @ np.sqrt(estimate * kernel[:, 0])
        bound = transition_error_counts.estimate(S=size, n=n, counts=cells, delta=delta)
        return bool(1 - overlap.sum() > shrink * bound + 1e-12)

    trials = context.pick(quick=60, full=250)
    return simulate("transition error from counts", fails, Fraction(1, 2), trials, context.seed)


def stochastic_expert(*, shrink: float = 1.0, context: Context = QUICK) -> Outcome:
    """T13: the expert lies in the ball around the step-wise clone under the step-wise estimate (delta = 1/2)."""
    size, choices, n, horizon, delta = 2, 3, 8, 2, 0.5

    def fails(rng: np.random.Generator) -> bool:
        start, kernel, policy = _rows(rng, (size,)), _rows(rng, (size, choices, size)), _rows(rng, (size, choices))
        states, actions = _demonstrations(rng, start, kernel, policy, n, horizon)
        overlap, visits = np.bincount(states[:, 0], minlength=size) / n, []
        for t in range(horizon):
            counts = np.zeros((size, choices))
            np.add.at(counts, (states[:, t], actions[:, t]), 1)
            used = counts.sum(axis=1)
            visits += list(used)
            agree = np.sqrt(counts / np.maximum(used, 1)[:, None] * policy)
            if t == horizon - 1:
                return bool(np.sqrt(max(1 - overlap @ agree.sum(axis=1), 0)) > shrink * _radius(visits) + 1e-9)
            moves = np.zeros((size, choices, size))
            np.add.at(moves, (states[:, t], actions[:, t], states[:, t + 1]), 1)
            moves /= np.maximum(moves.sum(axis=2), 1)[:, :, None]
            overlap = np.einsum("s,sa,sap->p", overlap, agree, moves)
        raise AssertionError("the last step returns")

    def _radius(visits: list[float]) -> float:
        return float(offline_radius_stochastic.estimate(A=choices, n=n, visits=visits, delta=delta))

    trials = context.pick(quick=60, full=250)
    return simulate("radius for a stochastic expert", fails, Fraction(1, 2), trials, context.seed)


def _star(rng: np.random.Generator, n: int, size: int) -> tuple[Floats, set[int], NDArray[np.int64]]:
    """First states of n demonstrations of horizon 1: a star, where the missing mass is largest."""
    weights = _rows(rng, (size,))
    drawn = rng.choice(size, size=n, p=weights)
    return weights, set(drawn.tolist()), drawn


def observed_missing_mass(*, shrink: float = 1.0, context: Context = QUICK) -> Outcome:
    """T7(b), (c): the missing mass is below both formulas, simultaneously at half of delta = 1/2 each."""
    size, n, delta = 6, 5, 0.25

    def fails(rng: np.random.Generator) -> bool:
        weights, seen, _ = _star(rng, n, size)
        mass = 1 - sum(weights[s] for s in seen)
        observed = missing_mass_observed.estimate(S=size, n=n, unvisited=size - len(seen), delta=delta)
        sharp = policy_error_sharp.estimate(S=size, n=n, delta=delta)
        return bool(mass > shrink * min(observed, sharp) + 1e-12)

    trials = context.pick(quick=100, full=1000)
    return simulate("missing mass", fails, Fraction(1, 2), trials, context.seed)


def good_turing_mass(*, shrink: float = 1.0, context: Context = QUICK) -> Outcome:
    """T7(d): the missing mass is below the Good-Turing bound (delta = 1/2), with its cited constant."""
    size, n, delta = 60, 200, 0.5

    def fails(rng: np.random.Generator) -> bool:
        weights, seen, drawn = _star(rng, n, size)
        singletons = int((np.bincount(drawn, minlength=size) == 1).sum())
        bound = missing_mass_good_turing.estimate(n=n, singletons=singletons, delta=delta)
        return bool(1 - sum(weights[s] for s in seen) > shrink * bound)

    trials = context.pick(quick=100, full=1000)
    return simulate("Good-Turing bound", fails, Fraction(1, 2), trials, context.seed)


def trajectory_divergence(*, shrink: float = 1.0, context: Context = QUICK) -> Outcome:
    """T10: KL(P-hat^pi || P*^pi) <= budget * max m-hat/N, for a stationary count estimate of a chain (delta = 1/2)."""
    size, n, horizon, delta = 3, 6, 4, 0.5

    def fails(rng: np.random.Generator) -> bool:
        start, kernel = _rows(rng, (size,)), _rows(rng, (size, 1, size))
        states, _ = _demonstrations(rng, start, kernel, np.ones((size, 1)), n, horizon + 1)
        counts = np.zeros((size, size))
        np.add.at(counts, (states[:, :-1].ravel(), states[:, 1:].ravel()), 1)
        used = counts.sum(axis=1)
        estimate = np.where(used[:, None] > 0, counts / np.maximum(used, 1)[:, None], np.eye(size))
        visits, x = np.zeros(size), np.bincount(states[:, 0], minlength=size) / n
        for _ in range(horizon):
            visits += x
            x = x @ estimate
        if (visits[used == 0] > 0).any():
            return False  # the statement is about policies that stay on pairs with data
        divergence = sum(visits[s] * _row_kl(estimate[s], kernel[s, 0]) for s in range(size) if used[s])
        ratio = float(max(visits[s] / used[s] for s in range(size) if used[s]))
        return bool(divergence > shrink * trajectory_kl.estimate(S=size, counts=used, ratio=ratio, delta=delta))

    trials = context.pick(quick=60, full=250)
    return simulate("trajectory KL", fails, Fraction(1, 2), trials, context.seed)
