r"""Regret against the expert and against the best candidate, with Monte-Carlo errors; never clipped.

All policies are rolled out from the same n initial states, so that a regret is a mean of n paired differences, whose
standard error is smaller than that of two separate means.
"""

from __future__ import annotations

import numpy as np

from bridge_algos.mdp import FloatArray, IntArray


def standard_error(samples: FloatArray) -> FloatArray:
    """Standard error of the mean over the last axis, whose entries are independent."""
    return np.asarray(samples.std(axis=-1, ddof=1) / np.sqrt(samples.shape[-1]))


def best_policy(returns: FloatArray, members: IntArray) -> tuple[int, FloatArray]:
    r"""Which of the ``members`` has the largest mean return, and (n,) returns whose mean estimates that of the best.

    The largest of N noisy means overstates the largest mean. So the best policy is chosen on every other initial state
    and judged on the rest, and the other way round; the returns are those of the judged halves. Their mean has no
    bias towards luck; it is at most the largest mean, in expectation.

    Args:
        returns: (N, n) of all candidates.
        members: indices of those that may be searched.
    """
    fold = np.arange(returns.shape[1]) % 2 == 1
    judged = np.empty(returns.shape[1])
    for chosen_on in (fold, ~fold):
        best = members[returns[members][:, chosen_on].mean(axis=1).argmax()]
        judged[~chosen_on] = returns[best, ~chosen_on]
    return int(members[returns[members].mean(axis=1).argmax()]), judged


def regret_errors(gaps: FloatArray, greedy: IntArray) -> tuple[FloatArray, FloatArray]:
    """Standard errors (T,) of each round's regret and of the cumulative regret.

    The cumulative one is that of the sum over rounds at each initial state: rounds share initial states and policies,
    so that their errors add up and do not average out.

    Args:
        gaps: (N, n) expert's return less the candidate's, from each initial state.
        greedy: (T,) candidate of each round.
    """
    played = gaps[greedy]
    return standard_error(played), standard_error(np.cumsum(played, axis=0))
