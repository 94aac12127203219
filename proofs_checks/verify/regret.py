r"""Audit R4 from a log: upper bounds on the regret of a round and of all rounds, each number rounded up.

With :math:`\pi^*` in :math:`\Pi_t`, :math:`w^*` in the ellipsoid of R1 and the transitions within their L1 radii (R6),

.. math:: \langle\phi^* - \phi_i, w^*\rangle \le U_t(\pi^*, \pi_i) = \min\{\langle\hat\phi^* - \hat\phi_i, w_t\rangle
   + \rho_t\|\hat\phi^* - \hat\phi_i\|_{V_t^{-1}}, W\|\hat\phi^* - \hat\phi_i\|_2\} + b_t(\pi^*) + b_t(\pi_i) ,

so the largest value over :math:`\Pi_t` bounds what a round loses, whichever pair was played. The bound from the widths
replaces the gap :math:`\langle\hat\phi^* - \hat\phi_i, w_t\rangle` by :math:`O_t(\pi^*, \pi_i)` where that is larger:
for a pair inside :math:`\Pi_t` this is :math:`2 O_t(\pi^*, \pi_i)`, at most R4's :math:`2 O_t(\pi_t^1, \pi_t^2)` of the
arg-max pair, and it needs no arg-max.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bridge_theory import regret_hindsight, regret_optimism
from bridge_theory.arithmetic.flint_balls import Ball
from bridge_theory.arithmetic.floats import FLOATS
from proofs_checks.verify.ellipsoid import DataMatrix
from proofs_checks.verify.enclosed import UNIT, Enclosed, FloatArray, difference, enlarged, largest_norms, product
from proofs_checks.verify.features import IntArray
from proofs_checks.verify.policies import TILE, squared_distances, worst_margins


@dataclass(frozen=True, eq=False)
class View:
    """What is certain at the start of a round.

    Args:
        features: (N, d) of all candidates, under the known or the estimated dynamics.
        bonus: (N,) rounded up; zeros for known dynamics.
        matrix: V_t of R1.
        w: (d,) with norm at most W for certain.
        rho: the radius of R1 at w, rounded up.
        error: the solver's error at w.
    """

    features: Enclosed
    bonus: FloatArray
    matrix: DataMatrix
    w: FloatArray
    rho: float
    error: Ball

    def possible(self) -> NDArray[np.bool_]:
        """The candidates that are not excluded from Pi_t for certain, (N,)."""
        stretched = self.rho * enlarged(1 / np.sqrt(1 - self.matrix.defect))
        _, highest = worst_margins(self.scores, self.whitened, enlarged(stretched), self.bonus)
        return np.asarray(highest >= 0)

    @cached_property
    def scores(self) -> Enclosed:
        """<phi(pi), w> of all candidates, (N,)."""
        column = product(self.features, Enclosed(self.w[:, None], 0.0))
        return Enclosed(column.mid[:, 0], column.rad)

    @cached_property
    def whitened(self) -> Enclosed:
        """L phi(pi) of all candidates, (N, d)."""
        return self.matrix.whitened(self.features)


def round_bounds(
    view: View, possible: NDArray[np.bool_], pair: tuple[int, int], weight_bound: float
) -> tuple[float, float]:
    """Upper bounds on one round's regret: from optimism (B_ucb's term) and from the widths (B_width's)."""
    scores, whitened = view.scores, view.whitened
    optimism, width = 0.0, 0.0
    for i in pair:
        gap = difference(scores, Enclosed(scores.mid[i], scores.rad))
        reach = view.rho * view.matrix.largest_norms(difference(whitened, whitened.rows(np.array([i]))))
        norms = largest_norms(difference(view.features, view.features.rows(np.array([i]))))
        bonus = view.bonus + view.bonus[i]
        highest = gap.mid + gap.rad
        slack = 16 * UNIT * (np.abs(highest) + reach + weight_bound * norms + bonus)
        terms = {"W": weight_bound, "optimism": highest + reach, "norm": norms, "bonus_sum": bonus}
        advantages = regret_optimism(FLOATS, **terms) + slack
        widths = reach + bonus + np.maximum(highest, reach + bonus) + slack
        advantages[i] = widths[i] = 0.0  # a policy has no regret against itself
        optimism += max(0.0, float(advantages[possible].max(initial=0.0)))
        width += max(0.0, float(widths[possible].max(initial=0.0)))
    return enlarged(optimism / 2), enlarged(width / 2)


def hindsight(view: View, possible: NDArray[np.bool_], plays: IntArray, weight_bound: float) -> float:
    r"""B_hind after t rounds, from the view of round t + 1 (audit R4(iii)).

    Args:
        possible: (N,) candidates that may have been in Pi_t in every round so far: pi* is one of them.
        plays: (N,) how often each candidate was played, 2 t in total.
    """
    rounds = int(plays.sum()) // 2
    sums = excess(view.features, plays, rounds)
    column = product(sums, Enclosed(view.w[:, None], 0.0))
    reach = view.rho * view.matrix.largest_norms(excess(view.whitened, plays, rounds))
    norms = largest_norms(sums)
    highest = column.mid[:, 0] + column.rad
    bonus = 2 * (rounds - plays) * view.bonus + float(plays @ view.bonus)
    slack = 32 * UNIT * (np.abs(highest) + reach + weight_bound * norms)
    slack += 4 * (len(plays) + 8) * UNIT * rounds * view.bonus.max()
    terms = {"W": weight_bound, "optimism": highest + reach, "norm": norms, "bonus_sum": bonus}
    values = regret_hindsight(FLOATS, **terms) + slack
    return enlarged(max(0.0, float(values[possible].max(initial=0.0))))


def excess(rows: Enclosed, plays: IntArray, rounds: int) -> Enclosed:
    """rounds * row - (the sum of the rows played) / 2, for every row."""
    played = product(Enclosed(plays[None] / 2, 0.0), rows)
    return difference(Enclosed(rounds * rows.mid, enlarged(rounds * (rows.rad + UNIT * rows.size))), played)


def diameter(features: Enclosed) -> float:
    """An upper bound on the largest ||phi(pi) - phi(pi')||_2."""
    centred = Enclosed(features.mid - features.mid.mean(axis=0), enlarged(features.rad + 4 * UNIT * features.size))
    largest, height = 0.0, max(1, TILE // len(features.mid))
    for first in range(0, len(features.mid), height):
        squares, radius = squared_distances(centred, slice(first, first + height))
        largest = max(largest, float(squares.max()) + radius)
    return enlarged(np.sqrt(largest))


def best_bounds(steps: dict[str, FloatArray], hindsights: FloatArray) -> FloatArray:
    r"""The smallest cumulative bound that follows from all of them, (T,).

    They hold on one event. A round's regret is at most its smallest bound; the regret after t rounds is at most that
    after t - 1 plus a round's; and since no round has negative regret against the best candidate, it is at most any
    bound on the regret after later rounds.

    Args:
        steps: per-round bounds by name, each (T,).
        hindsights: bounds on the regret after t rounds, (T,).
    """
    step = np.min(list(steps.values()), axis=0)
    best, total = np.empty(len(step)), 0.0
    for t in range(len(step)):
        total = min(float(np.nextafter(total + step[t], np.inf)), float(hindsights[t]))
        best[t] = total
    return np.minimum.accumulate(best[::-1])[::-1]
