"""Returns judged on initial states that played no part in any choice.

A policy is chosen by features that are means of rollouts. Its return read off the same rollouts is too high: the choice
favours policies with lucky initial states, the more so where each policy has its own. So every policy that was chosen,
in some round or as the best candidate, is rolled out anew, from initial states that all share with the expert. A regret
is then a mean of n paired differences.
"""

from __future__ import annotations

import numpy as np

from bridge_algos.continuous.config import ContinuousConfig
from bridge_algos.continuous.environments import draw_starts
from bridge_algos.continuous.offline import OfflineStage
from bridge_algos.continuous.rollouts import map_rollouts
from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.run.streams import stream


def judged_returns(
    config: ContinuousConfig, stage: OfflineStage, seed: int, chosen: IntArray, threads: int | None = None
) -> FloatArray:
    """Returns of candidates from n fresh initial states, (N, n); nan for those that were not chosen.

    Args:
        chosen: indices of candidates, repeated or not.
        threads: of the rollouts; does not change the numbers.
    """
    wanted = np.unique(chosen)
    returns = np.full((len(stage.candidates), config.rollouts), np.nan)
    returns[wanted] = map_rollouts(
        stage.environment,
        [stage.candidates[index] for index in wanted],
        draw_starts(stage.environment, config.rollouts, stream(seed, "judge")),
        lambda episodes: episodes.returns[:, None],
        horizon=config.horizon,
        threads=threads,
    )[:, :, 0]
    return returns


def standard_error(samples: FloatArray) -> FloatArray:
    """Standard error of the mean over the last axis, whose entries are independent."""
    return np.asarray(samples.std(axis=-1, ddof=1) / np.sqrt(samples.shape[-1]))


def regret_errors(gaps: FloatArray, chosen: IntArray) -> tuple[FloatArray, FloatArray]:
    """Standard errors (T,) of each round's regret and of the cumulative regret.

    The cumulative one is that of the sum over rounds at each initial state: rounds share initial states and policies,
    so that their errors add up and do not average out.

    Args:
        gaps: (N, n) expert's return less the candidate's, from each initial state.
        chosen: (T,) candidate of each round.
    """
    played = gaps[chosen]
    return standard_error(played), standard_error(np.cumsum(played, axis=0))
