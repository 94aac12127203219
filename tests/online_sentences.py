"""Rounds of comparisons in which the sentences of the online part are held against the truth."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
from printed_sentences import (
    DELTA,
    DETERMINISTIC,
    Sentence,
    an_expert,
    counted,
    estimate,
    play,
    printed,
    sparse_rows,
)

import bridge_theory as theory

Sentences = Iterator[tuple[Sentence, ...]]
_LOOKS = (1, 2, 3, 5, 8, 13, 21, 34)
"""The rounds in which the sentences about every round are read."""


def weights(rng: np.random.Generator, kind: str) -> Sentences:
    """R1 and R2: the weights' ellipsoid and the best policy's membership, against questions chosen to hurt."""
    names: tuple[str, ...] = ("beta_repaired", "beta_repaired_logdet", "confidence_radius_repaired")
    yield from _rounds(rng, float(theory.kappa_differences.estimate(B=1, W=1)), 2.0, names)
    names = ("confidence_radius_nonnegative",)
    yield from _rounds(rng, float(theory.kappa_nonnegative.estimate(B=1, W=1)), float(np.sqrt(2)), names)


def _rounds(rng: np.random.Generator, kappa: float, reach: float, names: tuple[str, ...]) -> Sentences:
    """Sentences about all rounds of feature differences of norm ``reach``; the last of the names is a radius."""
    d, B, W, lam = 2, 1, 1, 0.5
    w = W * _direction(rng)
    policies = rng.uniform(-1, 1, (5, d))
    policies /= np.maximum(np.linalg.norm(policies, axis=1, keepdims=True), 1)
    gaps = policies[np.argmax(policies @ w)] - policies
    matrix, noise = kappa * lam * np.eye(d), -lam * w
    xs, answers = np.zeros((0, d)), np.zeros(0)
    read: dict[str, list[Sentence]] = {name: [] for name in names}
    missing = 0.0
    for t in range(1, _LOOKS[-1] + 1):
        inverse = np.linalg.inv(matrix)
        if t in _LOOKS:
            chosen = _direction(rng) * rng.random() * W
            off = xs.T @ (1 / (1 + np.exp(-xs @ chosen)) - answers) + lam * chosen
            ratio = max(0.0, float(np.linalg.slogdet(matrix)[1] - d * np.log(kappa * lam)))
            given: dict[str, Any] = {
                "B": B, "W": W, "lam": lam, "d": d, "T": t, "delta": DELTA, "log_det_ratio": ratio,
                "residual": float(np.sqrt(off @ inverse @ off)),
            }  # fmt: skip
            size = float(np.sqrt(noise @ inverse @ noise))
            distance = float(np.sqrt((chosen - w) @ matrix @ (chosen - w)))
            for name in names:
                read[name].append(Sentence(name, distance if "radius" in name else size, given))
            radius = printed(names[-1], tuple(given.items())).enclosure.upper
            widths = np.sqrt(np.einsum("md,de,me->m", gaps, inverse, gaps))
            missing = max(missing, float((gaps @ chosen + radius * widths < 0).any()))
        x = reach * B * _hurting(rng, inverse, noise)
        chance = 1 / (1 + np.exp(-x @ w))
        answer = float(rng.random() < chance)
        xs, answers = np.vstack([xs, x]), np.append(answers, answer)
        noise, matrix = noise + (answer - chance) * x, matrix + np.outer(x, x)
    yield from (tuple(sentences) for sentences in read.values())
    shares = {"delta_off": "0.001", "delta_w": DELTA, "delta_P": "0.001"}
    for name in ("containment_failure_known", "containment_failure_unknown"):
        yield (Sentence(name, missing, shares, event=True),)


def _direction(rng: np.random.Generator) -> np.ndarray:
    angle = rng.random() * 2 * np.pi
    return np.array([np.cos(angle), np.sin(angle)])


def _hurting(rng: np.random.Generator, inverse: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """A direction along the deviation, where least is known, or anywhere."""
    along = inverse @ noise
    options = (along / max(float(np.linalg.norm(along)), 1e-12), np.linalg.eigh(inverse)[1][:, -1], _direction(rng))
    return np.asarray(options[rng.integers(3)])


def matrices(rng: np.random.Generator, kind: str) -> Sentences:
    """R5's potential and the paper's relation of data matrices: expected against sampled feature differences."""
    d, B, W, lam, T = 2, 1, 1, 1, 40
    start = float(theory.kappa_differences.estimate(B=B, W=W)) * lam
    observed, potential = start * np.eye(d), 0.0
    for _ in range(T):
        first, second = (B * _direction(rng) for _ in range(2))  # a policy's two trajectories, equally likely
        chance = rng.choice([0.02, 0.5, 0.98])
        mean = 2 * (chance * first + (1 - chance) * second)
        potential += float(mean @ np.linalg.inv(observed) @ mean)
        x = 2 * (first if rng.random() < chance else second)
        observed = observed + np.outer(x, x)
    given: dict[str, Any] = {"B": B, "W": W, "lam": lam, "d": d, "T": T, "delta": DELTA}
    yield (Sentence("expected_potential", potential, given),)
    # few rounds in which a rare trajectory makes the expectation: often none of them is sampled
    few, chance, mean = 2, 0.3, 2 * 0.3 * B
    excess = few * mean**2 - 2 * int(rng.binomial(few, chance)) * (2 * B) ** 2
    yield (Sentence("matrix_shift", max(excess, 0.0), {"B": B, "d": 1, "T": few, "delta": DELTA}),)


def bonuses(rng: np.random.Generator, kind: str) -> Sentences:
    """R6 and the paper's bonuses: estimated rows, and expectations of a function under the estimated dynamics."""
    S, A, H, n, eta = 2, 2, 3, 60, 1
    start, kernel = sparse_rows(rng, S), sparse_rows(rng, S, A, S)
    expert = an_expert(rng, kind, S, A)
    states, actions = play(rng, start, kernel, expert, n, H)
    counts = counted(states, actions, S, A, H - 1)
    uses, fitted = counts.sum(axis=2), estimate(counts, kernel)
    size: dict[str, Any] = {"S": S, "A": A, "H": H, "eta": eta, "delta": DELTA, "counts": uses.ravel()}
    cells = [(s, a) for s, a in product(range(S), range(A)) if uses[s, a]]
    yield tuple(
        Sentence("bonus_radius", float(np.abs(fitted[c] - kernel[c]).sum()), {**size, "N": int(uses[c])}) for c in cells
    )
    errors = np.array([[_radius(S, A, int(uses[s, a])) for a in range(A)] for s in range(S)])
    changes, sums = [], []
    for choice in product(range(A), repeat=S):
        policy = np.eye(A)[list(choice)]
        true, found = (_expected_uses(start, k, policy, H - 1) for k in (kernel, fitted))
        given = {**size, "occupancy": found.ravel()}
        apart = np.abs(_law(start, kernel, policy, H) - _law(start, fitted, policy, H)).sum() / 2
        changes.append(Sentence("transition_bonus", 2 * eta * float(apart), given))
        expected = {"H": H, "delta": DELTA, "true_bonus": float((true * errors).sum())}
        sums.append(Sentence("estimated_radius_sum", float((found * errors).sum()), expected))
    yield tuple(changes)
    yield tuple(sums)
    policy = expert if kind == DETERMINISTIC else an_expert(rng, DETERMINISTIC, S, A)
    yield from _as_printed(rng, start, kernel, fitted, policy, size, H)


def _as_printed(
    rng: np.random.Generator, start: np.ndarray, kernel: np.ndarray, fitted: np.ndarray, policy: np.ndarray,
    size: dict[str, Any], H: int,
) -> Sentences:  # fmt: skip
    true, found = _law(start, kernel, policy, H), _law(start, fitted, policy, H)
    f = rng.choice([-1.0, 1.0], size=true.shape) * 0.99
    uses = np.stack([_expected_uses(start, k, policy, H - 1).ravel() for k in (kernel, fitted)])
    met = (uses > 0).any(axis=0)
    if (size["counts"][met] < 2).any():
        return  # the paper's bonus has no value there
    gain, epsilon = float(((true - found) * f).sum()), 1e-6
    given = {**size, "counts": size["counts"][met], "epsilon": epsilon}
    yield (Sentence("empirical_bonus", max(gain, 0.0), {**given, "occupancy": uses[1][met]}),)
    yield (Sentence("expected_bonus", max(-gain - epsilon, 0.0), {**given, "occupancy": uses[0][met]}),)


def _radius(S: int, A: int, N: int) -> float:
    known = (("S", S), ("A", A), ("N", N), ("delta", DELTA))
    return printed("bonus_radius", known).enclosure.upper


def _expected_uses(start: np.ndarray, kernel: np.ndarray, policy: np.ndarray, steps: int) -> np.ndarray:
    present, uses = start, np.zeros_like(policy)
    for _ in range(steps):
        uses = uses + present[:, None] * policy
        present = np.einsum("s,sa,sap->p", present, policy, kernel)
    return uses


def _law(start: np.ndarray, kernel: np.ndarray, policy: np.ndarray, H: int) -> np.ndarray:
    """Probabilities of all (s_1, ..., s_H) under a deterministic policy."""
    chain = np.einsum("sa,sap->sp", policy, kernel)
    law = start
    for _ in range(H - 1):
        law = law[..., None] * chain
    return np.asarray(law.ravel())


def martingales(rng: np.random.Generator, kind: str) -> Sentences:
    """D.13: realised against expected bonuses, where the offline set is the expert itself, and so covered."""
    H, eta, S_reach, n, T, gamma = 2, 1, 2, 400, 50, 0.25
    start, log_term = np.array([gamma, 1 - gamma]), 8.0
    uses = rng.multinomial(n, start)
    cost = np.minimum(2 * eta, 4 * eta * np.sqrt(log_term / np.maximum(uses, 1)))
    drawn = rng.choice(2, p=start, size=T)
    truth = abs(float(T * (cost @ start) - cost[drawn].sum()))
    given: dict[str, Any] = {
        "H": H, "eta": eta, "log_covering": log_term, "n": n, "T": T, "gamma_min": gamma, "S_reach": S_reach,
        "Delta_n": 0, "delta": DELTA,
    }  # fmt: skip
    yield (Sentence("martingale_repaired", truth, given),)


SIMULATIONS = (weights, matrices, bonuses, martingales)
