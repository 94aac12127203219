r"""A confidence sequence for a preference probability, by betting (companion G10).

After a answers for the one item and b for the other, a stake against p has grown to

.. math:: K(p) = \frac{B(a + 1/2, b + 1/2)}{B(1/2, 1/2)\, p^a (1 - p)^b},

a nonnegative martingale of mean 1 when p is the true probability, whatever decides when this pair is asked and when to
stop. So K reaches 1/alpha for the true p at any time with probability at most alpha.
"""

from __future__ import annotations

from math import log

from scipy.special import betaln

ROUNDING = 1e-9
"""A stake counts only when its logarithm exceeds the threshold by this, relative to the numbers that it is made of."""


def excluded(p: float, won: float, lost: float, level: float) -> bool:
    """Whether the stake against a preference probability p has reached exp(level).

    >>> excluded(0.5, 9, 1, level=3.0), excluded(0.5, 19, 1, level=3.0)
    (False, True)
    """
    if p in (0.0, 1.0):
        return (won if p == 0 else lost) > 0
    gained, paid = float(betaln(won + 0.5, lost + 0.5) - betaln(0.5, 0.5)), won * log(p) + lost * log(1 - p)
    return gained - paid >= level + ROUNDING * (1 + abs(gained) + abs(paid))


def lower_bound(won: float, lost: float, level: float) -> float:
    """The largest p, to within 1e-9, below the share of answers won such that it and all smaller ones are excluded.

    >>> round(lower_bound(90, 10, level=3.0), 3), lower_bound(0, 0, level=3.0)
    (0.772, 0.0)
    """
    low, high = 0.0, won / (won + lost) if won else 0.0
    while high - low > 1e-9:  # the stake falls as p grows towards the share
        middle = (low + high) / 2
        low, high = (middle, high) if excluded(middle, won, lost, level) else (low, middle)
    return low
