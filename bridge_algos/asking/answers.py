r"""The answers of a session, and their log-likelihood :math:`\ell_t(w) = \sum_s \log P_w(o_s)`.

Model: the answer to a question with feature difference x is 1 with probability :math:`\sigma(\langle x, w^* \rangle)`.
Equal differences are kept once, with the numbers of their answers: the likelihood of ten thousand answers to fifty
different questions costs as much as that of fifty.
"""

from __future__ import annotations

import numpy as np
from scipy.special import expit

from bridge_algos.mdp import FloatArray


def log_sigmoid(z: FloatArray) -> FloatArray:
    r""":math:`\log \sigma(z)`, without overflow.

    >>> log_sigmoid(np.array([0.0, -1000.0]))
    array([-6.93147181e-01, -1.00000000e+03])
    """
    return np.asarray(-np.logaddexp(0.0, -z))


class Answers:
    """Distinct feature differences with their counts of answers; answers are only ever added.

    Args:
        dimension: d.

    >>> answers = Answers(2)
    >>> for x, answer in (([1.0, 0.0], 1), ([-1.0, 0.0], 1), ([0.0, 2.0], 0)):
    ...     _ = answers.add(np.array(x), answer)
    >>> answers.differences, answers.ones, answers.zeros
    (array([[1., 0.],
           [0., 2.]]), array([1., 0.]), array([1., 1.]))
    """

    def __init__(self, dimension: int) -> None:
        self._rows: dict[bytes, int] = {}
        self._differences = np.zeros((8, dimension))
        self._counts = np.zeros((2, 8))
        self.total = 0

    def add(self, difference: FloatArray, answer: int) -> tuple[FloatArray, int]:
        """Count one answer; returns the stored orientation of the difference and of the answer."""
        first = np.flatnonzero(difference)[0]
        flip = bool(difference[first] < 0)
        difference = (-difference if flip else difference) + 0.0  # no negative zeros: bytes must agree
        answer = 1 - answer if flip else answer
        row = self._rows.setdefault(difference.tobytes(), len(self._rows))
        if row == self._differences.shape[0]:
            self._differences = np.concatenate([self._differences, np.zeros_like(self._differences)])
            self._counts = np.concatenate([self._counts, np.zeros_like(self._counts)], axis=1)
        self._differences[row] = difference
        self._counts[answer, row] += 1
        self.total += 1
        return difference, answer

    @property
    def differences(self) -> FloatArray:
        """(m, d) the distinct differences."""
        return self._differences[: len(self._rows)]

    @property
    def ones(self) -> FloatArray:
        """(m,) how often the answer was 1."""
        return np.asarray(self._counts[1, : len(self._rows)])

    @property
    def zeros(self) -> FloatArray:
        """(m,) how often the answer was 0."""
        return np.asarray(self._counts[0, : len(self._rows)])

    def log_likelihood(self, weights: FloatArray) -> FloatArray:
        """Log-likelihood of weights (B, d), (B,)."""
        z = weights @ self.differences.T
        return np.asarray(log_sigmoid(z) @ self.ones + log_sigmoid(-z) @ self.zeros)

    def derivatives(self, weights: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Log-likelihood (B,), its gradients (B, d) and the negative Hessians (B, d, d) at weights (B, d)."""
        x = self.differences
        z = weights @ x.T
        value = log_sigmoid(z) @ self.ones + log_sigmoid(-z) @ self.zeros
        p = expit(z)
        total = self.ones + self.zeros
        gradient = (self.ones - total * p) @ x
        curvature = total * p * (1 - p)
        if len(weights) == 1:  # one product instead of a stack of them
            return value, gradient, ((x.T * curvature[0]) @ x)[None]
        outer = (x[:, :, None] * x[:, None, :]).reshape(len(x), x.shape[1] ** 2)
        return value, gradient, (curvature @ outer).reshape(len(weights), x.shape[1], x.shape[1])
