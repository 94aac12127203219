r"""The clipped surrogate and its gradient, by hand in NumPy.

For networks this small, more than twice as fast as automatic differentiation, which spends its time on bookkeeping.
Parameters are one vector: the policy's layers, the logarithms of its deviations, the value function's layers; both
networks have two hidden layers of hyperbolic tangents.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from bridge_algos.mdp import FloatArray

_LOG_ROOT_2_PI = 0.5 * math.log(2 * math.pi)
Layers = list[Any]


@dataclass(frozen=True, eq=False)
class Batch:
    """m steps to learn from.

    Args:
        inputs: (m, d_s) normalised observations.
        actions: (m, d_a) as the environment received them.
        before: (m,) log likelihoods of the actions when they were drawn.
        advantages: (m,).
        targets: (m,) of the value function.
    """

    inputs: FloatArray
    actions: FloatArray
    before: FloatArray
    advantages: FloatArray
    targets: FloatArray

    def part(self, rows: Any) -> Batch:
        """Some of the steps."""
        return Batch(*(getattr(self, field.name)[rows] for field in fields(self)))

    def single(self) -> Batch:
        """The same numbers in single precision."""
        return Batch(*(getattr(self, field.name).astype(np.float32) for field in fields(self)))


@dataclass(frozen=True)
class Networks:
    """The two networks' shapes and the range of actions.

    Args:
        d_s: size of the observations.
        d_a: size of the actions.
        hidden: neurons of each hidden layer.
        low: (d_a,) least actions.
        high: (d_a,) greatest actions.
    """

    d_s: int
    d_a: int
    hidden: int
    low: NDArray[np.floating]
    high: NDArray[np.floating]

    @cached_property
    def shapes(self) -> list[tuple[int, ...]]:
        """Six arrays of the policy, its log deviations, six of the value function."""
        body = [(self.d_s, self.hidden), (self.hidden,), (self.hidden, self.hidden), (self.hidden,)]
        return [*body, (self.hidden, self.d_a), (self.d_a,), (self.d_a,), *body, (self.hidden, 1), (1,)]

    def split(self, vector: FloatArray) -> tuple[Layers, FloatArray, Layers]:
        """The policy's layers, the log deviations, the value function's layers: views into the vector."""
        parts, at = [], 0
        for shape in self.shapes:
            size = math.prod(shape)
            parts.append(vector[at : at + size].reshape(shape))
            at += size
        return parts[:6], parts[6], parts[7:]

    def std(self, log_std: FloatArray) -> FloatArray:
        """(d_a,) deviations of the actions."""
        return np.exp(log_std)

    def values(self, vector: FloatArray, inputs: FloatArray) -> FloatArray:
        """The value function, (..., d_s) -> (...)."""
        return np.asarray(_forward(self.split(vector)[2], inputs)[0][..., 0])

    def log_likelihoods(self, vector: FloatArray, inputs: FloatArray, actions: FloatArray) -> FloatArray:
        r"""Of clipped actions (m,): densities inside the range, point masses :math:`\Phi` at its ends."""
        policy, log_std, _ = self.split(vector)
        return self._likelihood(_forward(policy, inputs)[0], self.std(log_std), actions)[0]

    def gradient(self, vector: FloatArray, batch: Batch, clip: float) -> FloatArray:
        """Of half the mean squared value error minus the clipped surrogate; advantages are standardised first.

        Computed in the precision of the vector and the batch.
        """
        policy, log_std, value = self.split(vector)
        m = len(batch.inputs)
        gains = (batch.advantages - batch.advantages.mean()) / (batch.advantages.std() + 1e-8)
        means, policy_cache = _forward(policy, batch.inputs)
        logs, d_means, d_logs = self._likelihood(means, self.std(log_std), batch.actions)
        ratios = np.exp(logs - batch.before)
        limited = np.clip(ratios, 1 - clip, 1 + clip)
        slopes = np.where(ratios * gains <= limited * gains, ratios * gains, 0.0)[:, None] / m
        values, value_cache = _forward(value, batch.inputs)
        errors = (values[:, 0] - batch.targets)[:, None] / m
        parts = [
            *_backward(policy, policy_cache, -slopes * d_means),
            -(slopes * d_logs).sum(axis=0),
            *_backward(value, value_cache, errors),
        ]
        return np.concatenate([part.ravel() for part in parts])

    def _likelihood(
        self, means: FloatArray, std: FloatArray, actions: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Log likelihoods (m,), and their derivatives by the means and by the log deviations (m, d_a)."""
        standard = (actions - means) / std
        logs = -0.5 * standard**2 - np.log(std) - _LOG_ROOT_2_PI
        d_means, d_logs = standard / std, standard**2 - 1
        for rows, sign in ((actions <= self.low, 1.0), (actions >= self.high, -1.0)):
            end = sign * standard[rows]  # at the range's end, standard is the distance of that end
            mass = log_ndtr(end)
            hazard = np.exp(-0.5 * end**2 - _LOG_ROOT_2_PI - mass)
            logs[rows] = mass
            d_means[rows] = -sign * hazard / np.broadcast_to(std, actions.shape)[rows]
            d_logs[rows] = -end * hazard
        return logs.sum(axis=1), d_means, d_logs


def _forward(layers: Layers, inputs: FloatArray) -> tuple[FloatArray, tuple[FloatArray, ...]]:
    first = np.tanh(inputs @ layers[0] + layers[1])
    second = np.tanh(first @ layers[2] + layers[3])
    return second @ layers[4] + layers[5], (inputs, first, second)


def _backward(layers: Layers, cache: tuple[FloatArray, ...], slopes: FloatArray) -> list[FloatArray]:
    inputs, first, second = cache
    inner = (slopes @ layers[4].T) * (1 - second**2)
    outer = (inner @ layers[2].T) * (1 - first**2)
    return [
        inputs.T @ outer,
        outer.sum(axis=0),
        first.T @ inner,
        inner.sum(axis=0),
        second.T @ slopes,
        slopes.sum(axis=0),
    ]
