r"""The test of the model that runs beside the certificate (companion G4).

Forecasters bet on every answer before it is known. Half of the stake is with the model itself, half outside of it:
tables for questions that are repeated, a logistic regression with interactions for those that are not, one with larger
weights than W allows, and one that errs at times. Q is the logarithm of the mixture's forecasts. Under the model

.. math:: E_t = e^{Q_t} / \max_{\|w\| \le W} e^{\ell_t(w)} \le e^{Q_t - \ell_t(w^*)},

a nonnegative supermartingale that starts at 1; so :math:`E_t \ge 1/\delta_M` for some t has probability at most
:math:`\delta_M`. The maximum is bounded from above by duality, whatever an optimiser finds.
"""

from __future__ import annotations

from math import log

import numpy as np

from bridge_algos.asking.answers import Answers
from bridge_algos.asking.forecasters import Interactions, Logistic, Tables
from bridge_algos.asking.region import highest
from bridge_algos.mdp import FloatArray, IntArray

DELTA_MODEL = 0.01
"""Probability that a teacher who follows the model is ever said to contradict it; apart from a session's delta."""

LAPSES = 0.1
"""One forecaster supposes that so many answers are flipped."""

VARIANCE = 9.0
"""Prior variance that interactions give to the log odds of a typical question."""

SHARES = (0.5, 0.1, 0.1, 0.1, 0.1, 0.1)
"""Of the stake outside of the model: the tables, lapses, larger weights, cycles, bends, and both."""

ROUNDING = 1e-9
"""Subtracted from the log forecast of each answer, far more than floats lose."""


class ModelTest:
    """Bets against the model, for one session.

    Args:
        pool: (M, d) features of the items that questions show.
        groups: (M,) items of equal features share a number.
        weight_bound: W.
    """

    def __init__(self, pool: FloatArray, groups: IntArray, weight_bound: float) -> None:
        self._pool, self._groups, self._weight_bound = pool, groups, weight_bound
        self._interactions = Interactions(pool)
        dimension = pool.shape[1]
        own = np.full(dimension, weight_bound**2 / dimension)
        cycles, bends = self._interactions.features(0, 1)
        both = np.concatenate([np.full(len(part), VARIANCE / max(len(part), 1)) for part in (cycles, bends)])
        self._tables = Tables()
        self._linear = Logistic(own / 4)
        self._wide = Logistic(4 * own)
        self._cycles = Logistic(np.concatenate([own / 4, both[: len(cycles)]]))
        self._bends = Logistic(np.concatenate([own / 4, both[len(cycles) :]]))
        self._both = Logistic(np.concatenate([own / 4, both / 2]))
        self._logs = np.log(SHARES)

    @property
    def outside(self) -> float:
        """The log forecast of all answers by the forecasters outside of the model, mixed by SHARES."""
        return float(np.logaddexp.reduce(self._logs))

    def tell(self, first: int, second: int, answer: int) -> None:
        """Let every forecaster forecast the answer to the question (first, second), then learn it."""
        x = self._pool[first] - self._pool[second]
        key = int(self._groups[first]), int(self._groups[second])
        cycles, bends = self._interactions.features(first, second)
        logistics = (
            (self._wide, x),
            (self._cycles, np.concatenate([x, cycles])),
            (self._bends, np.concatenate([x, bends])),
            (self._both, np.concatenate([x, cycles, bends])),
        )
        lapsing = LAPSES + (1 - 2 * LAPSES) * self._linear.forecast(x)
        forecasts = [self._tables.forecast(key), lapsing, *(one.forecast(given) for one, given in logistics)]
        given = np.array(forecasts)
        self._logs += np.log(given if answer else 1 - given) - ROUNDING
        self._tables.learn(key, answer)
        self._linear.learn(x, answer)
        for one, features in logistics:
            one.learn(features, answer)

    def evidence(self, inside: float, best: float) -> float:
        """log E_t from below.

        Args:
            inside: a lower bound on the log evidence of the model, by a prior fixed before the first answer.
            best: an upper bound on the log-likelihood of all weights in the ball, as from
                :func:`bridge_algos.asking.region.highest`.
        """
        return self._mixture(inside) - best

    def refutes(self, answers: Answers, inside: float, near: FloatArray) -> bool:
        """Whether E_t is at least 1 / DELTA_MODEL; the best weights are searched from ``near``, (d,) in the ball."""
        threshold = log(1 / DELTA_MODEL)
        if self._mixture(inside) - float(answers.log_likelihood(near[None])[0]) < threshold:
            return False  # the best weights explain the answers even better than these
        return self.evidence(inside, highest(answers, self._weight_bound, near)[1]) >= threshold

    def _mixture(self, inside: float) -> float:
        return float(np.logaddexp(inside, self.outside)) - log(2)


def refuted_in_words(weight_bound: float) -> str:
    """What the model test found."""
    return (
        "these answers contradict the model: forecasts from outside of it explain them at least "
        f"{1 / DELTA_MODEL:.0f} times better than any weights with ||w|| <= {weight_bound:.4g} do; a teacher who "
        f"follows the model is told so with probability at most {DELTA_MODEL:g}"
    )


def empty_in_words(weight_bound: float, delta: float) -> str:
    """What an empty likelihood set means."""
    return (
        f"these answers contradict the model or W: no weights with ||w|| <= {weight_bound:.4g} explain them as well as "
        f"the teacher's would; a teacher who follows the model is told so with probability at most {delta:g}"
    )


def nobody_in_words(weight_bound: float, delta: float) -> str:
    """What it means that no candidate can be best."""
    return (
        f"these answers contradict the model, W or the demonstrations: under no weights with ||w|| <= "
        f"{weight_bound:.4g} that explain them is any of the candidates the best policy; this happens with probability "
        f"at most {delta:g} where a candidate is"
    )
