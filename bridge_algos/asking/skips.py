"""Whether the questions left without an answer look like those that were too close to call.

Leaving out questions because they are close makes the other answers look surer than they are: the guarantee is then
void. No test can show that skips are innocent; this one says when they look guilty.
"""

from __future__ import annotations

import numpy as np

from bridge_algos.mdp import FloatArray

FEWEST = 5
"""Questions of each sort without which nothing is said."""

ALARM = 2.33
"""Standard deviations of the rank sum: one innocent session in a hundred is warned, at each look."""


def skip_warning(skipped: FloatArray, answered: FloatArray) -> str | None:
    """A sentence when the predicted |log odds| of skipped questions are smaller than those of answered ones.

    Args:
        skipped, answered: (n,), (m,) predicted log odds.

    >>> close, far = np.linspace(-0.3, 0.3, 9), np.linspace(1, 3, 20)
    >>> print(skip_warning(close, far))
    the 9 questions left unanswered look closer than those answered: a random one of them has the smaller predicted log
    odds with probability 1.00; if they were left out because they are close, nothing here is certified
    >>> skip_warning(far[::4], far) is None
    True
    """
    n, m = len(skipped), len(answered)
    if min(n, m) < FEWEST:
        return None
    ordered = np.sort(np.abs(answered))
    above = m - np.searchsorted(ordered, np.abs(skipped), side="right")
    ties = m - above - np.searchsorted(ordered, np.abs(skipped), side="left")
    closer = float((above + ties / 2).sum()) / (n * m)
    if (closer - 0.5) * np.sqrt(12 * n * m / (n + m + 1)) < ALARM:
        return None
    return (
        f"the {n} questions left unanswered look closer than those answered: a random one of them has the smaller "
        f"predicted log odds with probability {closer:.2f}; if they were left out because they are close, nothing here "
        "is certified"
    )
