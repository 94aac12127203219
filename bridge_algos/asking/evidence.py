r"""The evidence of the answers, from below: :math:`Q(q) = E_q[\ell_t] - KL(q \| \nu)` (companion G1').

With the prior :math:`\nu` fixed before the first answer, :math:`\ell_t(w^*) \ge Q - \log(1/\delta)` holds for all t and
all densities q at once, with probability at least :math:`1 - \delta`; so whatever finds q need not be trusted. Here
:math:`\nu` is an equal mixture of normal laws :math:`N(0, I/\lambda_k)`, q is normal for each of them, and the
mixture's evidence is at least :math:`\log \frac1k \sum_k e^{Q_k}`.

:math:`E_q[\log \sigma(\langle x, w\rangle)]` is an integral against a normal law, computed by the trapezoidal rule. For
a function that is analytic in a strip :math:`|Im\, u| \le a` the rule with step h errs by at most
:math:`2 M / (e^{2 \pi a / h} - 1)`; here :math:`a = \pi / (2 s)`, M is at most
:math:`e^{a^2/2} (\log 2 + |\mu| + s + \pi/2)`, and h is chosen so that this is below the slack that is subtracted.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log, pi, sqrt

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import expit

from bridge_algos.asking.answers import Answers, log_sigmoid
from bridge_algos.mdp import FloatArray

SLACK = 1e-10
"""Subtracted from each expected log-likelihood, relative to 1 + |mu| + s: more than the error of rule and rounding."""

TAIL = 8.5
"""Standard deviations that the rule covers; beyond them the normal law holds less than 2e-17."""

MOST_SPREAD = 60.0
"""Largest standard deviation that is integrated; beyond, an elementary bound serves."""


@dataclass
class Component:
    """One normal law of the prior, N(0, I / precision), and the normal law q that answers its evidence.

    Args:
        precision: lambda.
        mean: (d,) of q.
        covariance: (d, d) of q.
        value: Q, a lower bound on the log of this component's evidence.
    """

    precision: float
    mean: FloatArray
    covariance: FloatArray
    value: float = 0.0


class Evidence:
    """A lower bound on the log evidence of the answers, kept up to date.

    Args:
        precisions: the lambda_k, fixed before the first answer.
        dimension: d.

    >>> evidence = Evidence([1.0], 1)
    >>> answers = Answers(1)
    >>> for _ in range(3):
    ...     evidence.tell(*answers.add(np.array([1.0]), 1))
    >>> evidence.refit(answers)
    >>> round(evidence.value, 3)  # the exact evidence is -1.655
    -1.661
    """

    def __init__(self, precisions: list[float], dimension: int) -> None:
        self.components = [Component(k, np.zeros(dimension), np.eye(dimension) / k) for k in precisions]
        self._fitted = 0
        self._told = 0

    @property
    def value(self) -> float:
        """The lower bound on the mixture's log evidence."""
        values = np.array([component.value for component in self.components])
        return float(np.logaddexp.reduce(values) - log(len(values)))

    @property
    def mean(self) -> FloatArray:
        """(d,) the mean of the component with the largest evidence."""
        return max(self.components, key=lambda component: component.value).mean

    def tell(self, difference: FloatArray, answer: int) -> None:
        """Add one answer with the present q, which stays valid for any answers."""
        signed = difference[None] if answer else -difference[None]
        for component in self.components:
            component.value += float(expected_log_sigmoid(*_law(component, signed))[0])
        self._told += 1

    @property
    def stale(self) -> bool:
        """Whether enough answers came since q was fitted for a new fit to pay."""
        return self._told - self._fitted > 0.01 * self._told

    def refit(self, answers: Answers, steps: int = 2) -> None:
        """Move each q towards its best by Newton steps, and keep the better of old and new."""
        for component in self.components:
            mean, covariance = _improved(component, answers, steps)
            candidate = Component(component.precision, mean, covariance)
            candidate.value = lower_bound(candidate, answers)
            component.value = lower_bound(component, answers)
            if candidate.value > component.value:
                component.mean, component.covariance = mean, covariance
                component.value = candidate.value
        self._fitted = self._told


def lower_bound(component: Component, answers: Answers) -> float:
    r""":math:`E_q[\ell] - KL(q \| N(0, I/\lambda))`, from below."""
    precision, mean, covariance = component.precision, component.mean, component.covariance
    d = len(mean)
    mu, spread = _law(component, answers.differences)
    expected = answers.ones @ expected_log_sigmoid(mu, spread) + answers.zeros @ expected_log_sigmoid(-mu, spread)
    log_det = np.linalg.slogdet(covariance)[1]
    parts = precision * np.trace(covariance), precision * (mean @ mean), d * (1 + log(precision)), log_det
    divergence = 0.5 * (parts[0] + parts[1] - parts[2] - parts[3])
    return float(expected - divergence - SLACK * (1 + sum(abs(part) for part in parts)))


def expected_log_sigmoid(mu: FloatArray, spread: FloatArray) -> FloatArray:
    r""":math:`E \log \sigma(\mu + s u)` for normal u, (m,), from below by the slack.

    >>> expected_log_sigmoid(np.array([0.0]), np.array([1e-8]))
    array([-0.69314718])
    """
    largest = float(spread.max(initial=0.0))
    if largest > MOST_SPREAD:
        return np.asarray(-log(2) - np.maximum(-mu, 0) - spread / np.sqrt(2 * pi) - SLACK * (1 + np.abs(mu) + spread))
    nodes, masses = _rule(largest)
    values = log_sigmoid(mu[:, None] + spread[:, None] * nodes) @ masses
    return np.asarray(values - SLACK * (1 + np.abs(mu) + spread))


def _rule(spread: float) -> tuple[FloatArray, FloatArray]:
    strip = min(pi / (2 * max(spread, 1e-3)), 5.0)
    step = 2 * pi * strip / (strip**2 / 2 + log(8 / SLACK))
    count = ceil(TAIL / step)
    nodes = np.asarray(step * np.arange(-count, count + 1, dtype=np.float64))
    return nodes, np.asarray(step * np.exp(-(nodes**2) / 2) / sqrt(2 * pi))


def _law(component: Component, differences: FloatArray) -> tuple[FloatArray, FloatArray]:
    variance = np.einsum("md,md->m", differences @ component.covariance, differences)
    return differences @ component.mean, np.asarray(np.sqrt(np.maximum(variance, 0)))


def _improved(component: Component, answers: Answers, steps: int) -> tuple[FloatArray, FloatArray]:
    """A better normal law: Newton steps in the mean, with the expected curvature as inverse covariance."""
    mean, covariance = component.mean, component.covariance
    x, total = answers.differences, answers.ones + answers.zeros
    identity = np.eye(len(mean))
    for _ in range(steps):
        mu, spread = _law(Component(component.precision, mean, covariance), x)
        nodes, masses = _rule(min(float(spread.max(initial=0.0)), 3.0))
        p = expit(mu[:, None] + np.minimum(spread, 3.0)[:, None] * nodes)
        curvature = (p * (1 - p)) @ masses
        factor = cho_factor((x.T * (total * curvature)) @ x + component.precision * identity)
        covariance = cho_solve(factor, identity)
        step = cho_solve(factor, x.T @ (answers.ones - total * (p @ masses)) - component.precision * mean)
        largest = np.abs(x @ step).max(initial=0.0)
        mean = mean + step * min(1.0, 3.0 / max(largest, 1e-12))
    return np.asarray(mean), np.asarray((covariance + covariance.T) / 2)
