"""Whole runs of the repaired algorithm, played with ``bridge_algos``, and the data-dependent bounds of R4 on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import bridge_theory as theory
from bridge_algos.embeddings import Embedding, expected_features
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.offline.transitions import estimate_transitions, transition_counts
from bridge_algos.online.confidence import Confidence, RoundState
from bridge_algos.online.policy_filter import surviving, whiten, widest_pair
from bridge_algos.online.preference_model import fit_exact, projection_error
from bridge_algos.trajectories import sample_trajectories


@dataclass(frozen=True, eq=False)
class View:
    """What is known at the start of a round: features and bonuses of all policies, weights, multiplier, data matrix."""

    features: FloatArray
    bonus: FloatArray
    w: FloatArray
    radius: float
    matrix: FloatArray
    kept: np.ndarray


@dataclass(frozen=True, eq=False)
class Play:
    """All views (one more than rounds), the pairs played, and the utilities of the policies."""

    views: list[View]
    pairs: list[tuple[int, int]]
    utility: FloatArray
    weight_bound: float

    @property
    def regret(self) -> float:
        best = float(self.utility.max())
        return float(sum(best - (self.utility[i] + self.utility[j]) / 2 for i, j in self.pairs))

    @property
    def best_is_kept(self) -> bool:
        return all(bool(view.kept[int(self.utility.argmax())]) for view in self.views)

    def bounds(self) -> dict[str, float]:
        """R4: the bounds from the widths played, from optimism, and in hindsight."""
        widths, bonuses, optimism = 0.0, 0.0, 0.0
        for view, (i, j) in zip(self.views, self.pairs, strict=False):
            z = whiten(view.features, view.matrix)
            widths += view.radius * float(np.linalg.norm(z[i] - z[j]))
            bonuses += float(view.bonus[i] + view.bonus[j])
            optimism += sum(self._optimism(view, z, k) for k in (i, j)) / 2
        return {
            "width": float(theory.regret_width.estimate(width_sum=widths, bonus_sum=bonuses)),
            "optimism": optimism,
            "hindsight": self._hindsight(),
        }

    def _optimism(self, view: View, z: FloatArray, other: int) -> float:
        gap = (view.features - view.features[other]) @ view.w + view.radius * np.linalg.norm(z - z[other], axis=1)
        plain = self.weight_bound * np.linalg.norm(view.features - view.features[other], axis=1)
        bonus = np.where(np.arange(len(z)) == other, 0.0, view.bonus + view.bonus[other])
        return float((np.minimum(gap, plain) + bonus)[view.kept].max())

    def _hindsight(self) -> float:
        view = self.views[-1]
        first, second = (np.array([pair[k] for pair in self.pairs]) for k in (0, 1))
        sums = len(self.pairs) * view.features
        sums = sums - (view.features[first] + view.features[second]).sum(axis=0) / 2
        z = whiten(sums, view.matrix)
        optimism = sums @ view.w + view.radius * np.linalg.norm(z, axis=1)
        extra = np.zeros(len(sums))
        for played in (first, second):
            other = np.arange(len(sums))[:, None] != played
            extra += (other * (view.bonus[:, None] + view.bonus[played])).sum(axis=1)
        values = theory.regret_hindsight.estimate(
            W=self.weight_bound,
            optimism=np.maximum(optimism, 0),
            norm=np.linalg.norm(sums, axis=1),
            bonus_sum=extra,
        )
        return float(values.max())


def play(
    mdp: TabularMDP,
    policies: IntArray,
    embedding: Embedding,
    w_star: FloatArray,
    confidence: Confidence,
    rounds: int,
    rng: np.random.Generator,
    *,
    lam: float,
    weight_bound: float,
    counts: IntArray | None = None,
    shrink: float = 1.0,
) -> Play:
    """Run the repaired algorithm; ``counts`` are the offline transition counts, None for known dynamics.

    ``shrink`` scales the multiplier and the bonuses: 1 is the theory, less is a mutant.
    """
    d = embedding.dimension
    x, outcomes, matrix = np.empty((0, d)), np.empty(0), confidence.initial_scale * np.eye(d)
    truth = expected_features(mdp.dynamics, policies, embedding)[0]
    w, views, pairs = np.zeros(d), [], []
    for t in range(1, rounds + 2):
        features, bonus = truth, np.zeros(len(policies))
        if counts is not None:
            costs = confidence.step_bonus(counts.sum(axis=2))
            dynamics = mdp.dynamics.under(estimate_transitions(counts))
            features, bonus = expected_features(dynamics, policies, embedding, costs, confidence.bonus_steps)
            bonus = shrink * np.minimum(bonus, confidence.bonus_cap)
        w = fit_exact(x, outcomes, lam, w)
        w = w * min(1.0, weight_bound / max(float(np.linalg.norm(w)), weight_bound))  # R1 takes any point of the ball
        error = projection_error(w, x, outcomes, lam, matrix)
        radius = shrink * confidence.multiplier(RoundState(t, matrix, error, [], []))
        z, scores = whiten(features, matrix), features @ w
        kept = surviving(scores + bonus, scores - bonus, z, radius)
        views.append(View(features, bonus, w, radius, matrix, kept))
        if t > rounds:
            break
        members = np.flatnonzero(kept)
        i, j = widest_pair(z[members], radius, bonus[members])
        pair = (int(members[i]), int(members[j]))
        pairs.append(pair)
        one, two = (sample_trajectories(mdp, policies[k], 1, rng) for k in pair)
        difference = embedding.of_trajectories(one) - embedding.of_trajectories(two)
        answer = rng.random(1) < 1 / (1 + np.exp(-difference @ w_star))
        x, outcomes = np.concatenate([x, difference]), np.concatenate([outcomes, answer])
        matrix = matrix + difference.T @ difference
        if counts is not None:
            counts = counts + sum(transition_counts(path, mdp.n_states, mdp.n_actions) for path in (one, two))
    return Play(views, pairs, truth @ w_star, weight_bound)
