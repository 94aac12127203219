"""Data sets in which the sentences of the offline part, and of what rests on it, are held against the truth."""

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
    meets,
    play,
    printed,
    row_divergence,
    sparse_rows,
    squared_hellinger,
)

Sentences = Iterator[tuple[Sentence, ...]]


def transitions(rng: np.random.Generator, kind: str) -> Sentences:
    """R_2 of the pooled count estimate, the worst of all maximisers; small problems, and a thousand actions."""
    for S, A, H, n in ((2, 2, 2, 400), (3, 2, 3, 4000)):
        start, kernel = sparse_rows(rng, S), sparse_rows(rng, S, A, S)
        yield from _of_transitions(rng, start, kernel, an_expert(rng, kind, S, A), H, n)


def many_actions(rng: np.random.Generator, kind: str) -> Sentences:
    """Two states, a thousand actions, rows of fair coins: most of the rows are used once, or never."""
    S, A, H, n = 2, 1000, 1, 1000
    expert = an_expert(rng, kind, S, A) if kind == DETERMINISTIC else np.full((S, A), 1 / A)
    yield from _of_transitions(rng, np.full(S, 1 / S), np.full((S, A, S), 1 / S), expert, H, n)


def _of_transitions(
    rng: np.random.Generator, start: np.ndarray, kernel: np.ndarray, expert: np.ndarray, H: int, n: int
) -> Sentences:
    S, A = expert.shape
    states, actions = play(rng, start, kernel, expert, n, H)
    fitted = estimate(counted(states, actions, S, A, H), kernel)
    truth = squared_hellinger((start, start), (expert, expert), (kernel, fitted), H, H)
    size: dict[str, Any] = {"S": S, "A": A, "H": H, "n": n, "delta": DELTA}
    for name in ("stated", "infimum", "repaired", "closed_form"):
        yield (Sentence(f"transition_error_{name}", truth, size),)
    epsilon = 1e-3
    cover = printed("transition_log_covering_repaired", (("S", S), ("A", A), ("epsilon", epsilon / H)))
    given = {**size, "epsilon": epsilon, "log_covering": cover.enclosure.upper}
    yield (Sentence("transition_error_covering", truth, given),)
    yield (Sentence("mle_covering_repaired", truth, given),)


def clone(rng: np.random.Generator, kind: str) -> Sentences:
    """R_1, the missing mass and the version space: the clone errs in every state without data."""
    if kind != DETERMINISTIC:
        return
    S, A, H, n, T = 6, 3, 2, 25, 3
    start, chain = _star(rng, S, n * H), np.stack([_star(rng, S, n * H) for _ in range(S)])[:, None]
    states, _ = play(rng, start, chain, np.ones((S, 1)), n, H)
    unseen = np.ones(S, dtype=bool)
    unseen[states[:, :H]] = False
    truth = meets(start, chain[:, 0], unseen, H)
    visited = [frozenset(row) for row in states[:, :H].tolist()]
    alone = sum(visited.count(item) == 1 for item in visited)
    given: dict[str, Any] = {
        "S": S, "A": A, "H": H, "n": n, "T": T, "d": 3, "B": 1, "W": 1, "lam": 1, "delta": DELTA,
        "unvisited": int(unseen.sum()), "singletons": alone, "class_size": A**S,
    }  # fmt: skip
    for name in ("policy_error_stated", "policy_error_corollary", "policy_error_repaired", "policy_error_sharp",
                 "policy_error_finite", "missing_mass_observed", "missing_mass_good_turing", "delta_n_version_space",
                 "delta_n_version_space_sharp"):  # fmt: skip
        yield (Sentence(name, truth, given),)
    yield (Sentence("offline_radius_known", float(np.sqrt(truth)), given),)
    for name in ("regret_known_version_space", "regret_unknown_version_space"):  # the worst play inside the set
        yield (Sentence(name, 2 * T * truth, given),)


def _star(rng: np.random.Generator, S: int, n: int) -> np.ndarray:
    """A law in which half of the states have a probability near 1 / n: they are often missed, and it matters."""
    rare = np.where(np.arange(S) < S // 2, rng.uniform(0.3, 1, S) / n, 0.0)
    common = np.where(np.arange(S) < S // 2, 0.0, 1.0)
    return np.asarray(rare + common / common.sum() * (1 - rare.sum()))


def recovery(rng: np.random.Generator, kind: str) -> Sentences:
    """How likely some state of a deterministic expert is never seen, and some pair of any expert too rarely."""
    S, A, n = 4, 2, 12
    start, H = np.full(S, 1 / S), 1
    expert = an_expert(rng, kind, S, A)
    states, _ = play(rng, start, np.full((S, A, S), 1 / S), expert, n, H)
    if kind == DETERMINISTIC:
        unseen = len(set(states[:, 0].tolist())) < S
        given: dict[str, Any] = {"S": S, "A": A, "n": n, "gamma_min": 1 / S}
        yield (Sentence("exact_recovery_failure", float(unseen), given, event=True),)
    S, A, n, H = 2, 2, 80, 2
    expert = np.full((S, A), 1 / A) if kind != DETERMINISTIC else an_expert(rng, kind, S, A)
    kernel, start = np.full((S, A, S), 1 / S), np.full(S, 1 / S)
    states, actions = play(rng, start, kernel, expert, n, H)
    gamma = 1 / (S * A) if kind != DETERMINISTIC else 1 / S
    uses = counted(states, actions, S, A, H - 1).sum(axis=2)
    rare = bool((uses[expert > 0] < n * gamma / 2).any())
    yield (Sentence("coverage_failure", float(rare), {"S": S, "A": A, "n": n, "gamma_min": gamma}, event=True),)


def radii(rng: np.random.Generator, kind: str) -> Sentences:
    """The expert's distance from the worst clone under the count estimate; dynamics are pooled over the steps."""
    if kind != DETERMINISTIC:
        return
    S, A, H, n = 4, 2, 3, 3000
    start, kernel = _star(rng, S, n * H), np.array([[_star(rng, S, n * H) for _ in range(A)] for _ in range(S)])
    expert = rng.integers(A, size=S)
    states, actions = play(rng, start, kernel, np.eye(A)[expert], n, H)
    unseen = np.ones(S, dtype=bool)
    unseen[states[:, :H]] = False
    counts = counted(states, actions, S, A, H - 1)
    other = np.where(unseen, 1 - expert, expert)
    fitted = estimate(counts, kernel)
    truth = np.sqrt(meets(start, fitted[np.arange(S), expert], unseen, H))
    gamma = _rarest(start, kernel[np.arange(S), expert], H)
    given: dict[str, Any] = {"S": S, "A": A, "H": H, "n": n, "delta": DELTA, "gamma_min": gamma}
    for name in ("offline_radius", "offline_radius_appendix", "offline_radius_corollaries", "offline_radius_repaired",
                 "offline_radius_repaired_angle"):  # fmt: skip
        yield (Sentence(name, float(truth), given),)
    mass = meets(start, fitted[np.arange(S), other], unseen, H)
    yield (Sentence("offline_radius_mass", float(truth), {"mass": min(1.0, mass)}),)
    closed = estimate(counts, kernel, empty="stay")
    first = np.bincount(states[:, 0], minlength=S) / n
    zero = np.sqrt(meets(first, closed[np.arange(S), expert], unseen, H))
    yield (Sentence("offline_radius_closed", float(zero), {}),)


def _rarest(start: np.ndarray, chain: np.ndarray, H: int) -> float:
    occupancy = np.array([start @ np.linalg.matrix_power(chain, h) for h in range(H)])
    return float(occupancy[occupancy > 0].min())


def counts(rng: np.random.Generator, kind: str) -> Sentences:
    """The budgets of T10 and T13: pooled rows, and tables for each step."""
    S, A, H, n = 3, 2, 3, 30
    start, kernel, expert = sparse_rows(rng, S), sparse_rows(rng, S, A, S), an_expert(rng, kind, S, A)
    states, actions = play(rng, start, kernel, expert, n, H)
    pooled = counted(states, actions, S, A, H)
    used, fitted = pooled.sum(axis=2), estimate(pooled, kernel)
    spent = sum(used[s, a] * row_divergence(fitted[s, a], kernel[s, a]) for s, a in np.argwhere(used > 0))
    yield (Sentence("transition_kl_budget", spent, {"S": S, "counts": used.ravel(), "delta": DELTA}),)
    yield from _trajectory_divergence(states, used, fitted, kernel, expert, H)
    visits, policies, kernels = _by_step(states, actions, S, A, H)
    first = np.bincount(states[:, 0], minlength=S) / n
    wrong = sum(visits[h, s] * row_divergence(policies[h, s], expert[s]) for h, s in np.argwhere(visits > 0))
    given: dict[str, Any] = {"S": S, "A": A, "n": n, "visits": visits.ravel(), "delta": DELTA}
    yield (Sentence("policy_kl_budget", wrong, given),)
    experts = np.broadcast_to(expert, policies.shape)
    away = squared_hellinger((first, first), (experts, policies), (kernels, kernels), H, H - 1)
    yield (Sentence("offline_radius_stochastic", float(np.sqrt(max(away, 0.0))), given),)
    if kind == DETERMINISTIC:
        true_kernels = np.broadcast_to(kernel, kernels.shape)
        error = squared_hellinger((start, first), (expert, expert), (true_kernels, kernels), H, H - 1)
        yield (Sentence("transition_error_counts", error, {**given, "counts": visits[: H - 1].ravel()}),)


def _trajectory_divergence(
    states: np.ndarray, used: np.ndarray, fitted: np.ndarray, kernel: np.ndarray, expert: np.ndarray, H: int
) -> Sentences:
    S = len(expert)
    expected, present = np.zeros_like(used), np.bincount(states[:, 0], minlength=S) / len(states)
    for _ in range(H):
        expected += present[:, None] * expert
        present = np.einsum("s,sa,sap->p", present, expert, fitted)
    if (expected[used == 0] > 0).any():
        return  # the statement is about policies that stay on pairs with data
    pairs = np.argwhere(used > 0)
    truth = sum(expected[s, a] * row_divergence(fitted[s, a], kernel[s, a]) for s, a in pairs)
    ratio = max(expected[s, a] / used[s, a] for s, a in pairs)
    yield (Sentence("trajectory_kl", truth, {"S": S, "counts": used.ravel(), "ratio": ratio, "delta": DELTA}),)


def _by_step(
    states: np.ndarray, actions: np.ndarray, S: int, A: int, H: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Visits (H, S), the estimated policy (H, S, A) and the estimated kernel (H, S, A, S) of each step."""
    pairs = np.zeros((H, S, A))
    np.add.at(pairs, (np.arange(H), states[:, :H], actions), 1)
    moves = np.zeros((H, S, A, S))
    np.add.at(moves, (np.arange(H), states[:, :H], actions, states[:, 1:]), 1)
    visits = pairs.sum(axis=2)
    return visits, pairs / np.maximum(visits, 1)[:, :, None], moves / np.maximum(pairs, 1)[..., None]


def likelihood(rng: np.random.Generator, kind: str) -> Sentences:
    """Maximum likelihood over eight laws of one choice among four, and over all coins; the worst of tied maximisers."""
    n, options = 30, 4
    if kind == DETERMINISTIC:
        laws = np.concatenate([np.eye(options), rng.dirichlet(np.ones(options), size=4)])
        truth = laws[rng.integers(options)]
    else:
        centre = rng.dirichlet(np.ones(options))
        laws = centre + 0.3 * (rng.dirichlet(np.ones(options), size=8) - centre)
        truth = laws[rng.integers(8)]
    seen = rng.multinomial(n, truth)
    with np.errstate(divide="ignore", invalid="ignore"):
        scores = np.where(seen > 0, seen * np.log(laws), 0.0).sum(axis=1)
    best = scores >= scores.max() - 1e-9
    error = float(max(1 - np.sqrt(truth * law).sum() for law in laws[best]))
    given: dict[str, Any] = {"n": n, "delta": DELTA, "class_size": len(laws)}
    for name in ("mle_finite_repaired", "mle_finite_sharp", "policy_error_finite"):
        yield (Sentence(name, error, given),)
    yield from _coin(rng, kind)


def _coin(rng: np.random.Generator, kind: str) -> Sentences:
    n, epsilon = 300, 0.01
    p = float(rng.integers(2)) if kind == DETERMINISTIC else float(rng.uniform(0.2, 0.8))
    cover = printed("transition_log_covering_two_states", (("S", 2), ("rows", 1), ("epsilon", epsilon)))
    given: dict[str, Any] = {"n": n, "delta": DELTA, "epsilon": epsilon, "log_covering": cover.enclosure.upper}
    found = rng.binomial(n, p) / n
    for name in ("mle_covering_repaired", "policy_error_covering"):
        yield (Sentence(name, _between_coins(p, found), given),)
    nearest, inside = (0.9, max(found, 0.9)) if p < 0.9 else (p, found)  # the class of coins of at least nine tenths
    misfit = (p - nearest) ** 2 / (nearest * (1 - nearest)) if nearest < 1 else 0.0
    yield (Sentence("mle_misspecified_repaired", _between_coins(p, inside), {**given, "chi2": misfit}),)


def _between_coins(p: float, q: float) -> float:
    return max(0.0, 1 - np.sqrt(p * q) - np.sqrt((1 - p) * (1 - q)))


def balls(rng: np.random.Generator, kind: str) -> Sentences:
    """Two policies of the ball for known dynamics: how far their features and utilities can be apart."""
    S, A, H, n, T, B = 2, 2, 2, 2000, 4, 1
    start, expert = _star(rng, S, n * H), an_expert(rng, DETERMINISTIC, S, A)
    kernel = np.array([[_star(rng, S, n * H) for _ in range(A)] for _ in range(S)])
    states, _ = play(rng, start, kernel, expert, n, H)
    unseen = np.ones(S, dtype=bool)
    unseen[states[:, :H]] = False
    cloned = np.where(unseen[:, None], 1 - expert, expert)
    given: dict[str, Any] = {"S": S, "A": A, "H": H, "n": n, "T": T, "B": B, "W": 1, "delta": DELTA}
    radius = printed("offline_radius_known", tuple((k, given[k]) for k in ("S", "A", "n", "delta"))).enclosure.upper
    if kind == DETERMINISTIC:
        candidates = [np.eye(A)[list(choice)] for choice in product(range(A), repeat=S)]
    else:
        candidates = [cloned + 0.02 * (rng.dirichlet(np.ones(A), size=S) - cloned) for _ in range(6)]
    inside = [
        p for p in candidates if squared_hellinger((start, start), (p, cloned), (kernel, kernel), H, H - 1) <= radius**2
    ]
    laws = [_trajectory_law(start, kernel, p, H) for p in (*inside, cloned)]
    apart = max(float(np.abs(p - q).sum() / 2) for p in laws for q in laws)
    yield (Sentence("feature_difference_squared_stated", (2 * B * apart) ** 2, given),)
    if kind == DETERMINISTIC:
        best = _trajectory_law(start, kernel, expert, H)
        worst = max(float(np.abs(best - law).sum() / 2) for law in laws)
        yield (Sentence("regret_known_deterministic", 2 * B * T * worst, given),)


def _trajectory_law(start: np.ndarray, kernel: np.ndarray, policy: np.ndarray, H: int) -> np.ndarray:
    """Probabilities of all (s_1, a_1, ..., s_H, a_H)."""
    law = start[:, None] * policy
    for _ in range(H - 1):
        ahead = kernel[..., None] * policy  # (s, a, s', a')
        law = np.einsum("...sa,sapb->...sapb", law, ahead)
    return np.asarray(law.ravel())


SIMULATIONS = (transitions, many_actions, clone, recovery, radii, counts, likelihood, balls)
