"""Which two policies to compare next, chosen from the confidence set Pi_t."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np

from bridge_algos.online.policy_filter import first_best, widest_pair
from bridge_algos.shapes import Features, Kept, PerPolicy
from bridge_theory.errors import InputError

PairRule = Literal["uncertainty_and_bonus", "max_uncertainty", "ucb", "greedy_vs_random"]


def choose_pair(
    rule: PairRule,
    kept: Kept,
    scores: PerPolicy,
    z: Features,
    gamma: float,
    bonus: PerPolicy,
    rng: np.random.Generator,
) -> tuple[int, int]:
    r"""Indices of the two policies to play, which differ unless Pi_t holds one policy alone.

    The paper's rules maximise over all pairs of Pi_t, also those of a policy with itself, whose bonus 2 b_i can be the
    largest value of all. Such a pair has the expected feature difference 0, so that no expected data matrix grows by
    it, and it compares nothing. Leaving it out costs no guarantee (audit R4): a policy played, unless it is the best
    one, forms a pair of two policies with the best one, so that the regret of a round is still at most twice the
    largest value over pairs of two policies, which is at most the paper's.

    Args:
        rule: ``"uncertainty_and_bonus"`` maximises gamma ||z_i - z_j|| + b_i + b_j (algo:main line 7);
            ``"max_uncertainty"`` maximises ||z_i - z_j|| (algo:main_known); ``"ucb"`` maximises s_i - s_j +
            gamma ||z_i - z_j|| + b_i + b_j and ``"greedy_vs_random"`` plays the greedy policy against a uniform other
            one (the paper's appendix "Continuous implementation", where there are no bonuses and gamma is beta).
        kept: (N,) booleans, Pi_t, of N different policies; at least one is true.
        scores, z, bonus: (N,), (N, d), (N,) of all candidates.
        gamma: multiplier of the norm.
        rng: used by ``"greedy_vs_random"`` alone.
    """
    members = np.flatnonzero(kept)
    s, points, b = scores[members], z[members], bonus[members]
    if rule == "uncertainty_and_bonus":
        first, second = widest_pair(points, gamma, b)
    elif rule == "max_uncertainty":
        first, second = widest_pair(points, 1.0, np.zeros(len(b)))
    elif rule == "ucb":
        first, second = widest_pair(points, gamma, b, s)
    elif rule == "greedy_vs_random":
        greedy = first_best(s)
        others = np.delete(np.arange(len(members)), greedy)
        first, second = greedy, int(rng.choice(others)) if len(others) else greedy
    else:
        raise InputError(f"unknown pair rule {rule!r}; expected one of {', '.join(get_args(PairRule))}.")
    return int(members[first]), int(members[second])
