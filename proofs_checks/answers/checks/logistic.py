"""The log-likelihood of answers twice: in balls for certified statements, in floats for searches and simulations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt
from scipy.special import expit, log_expit

from bridge_theory.arithmetic.flint_balls import Ball, ball

Vector = Sequence[Fraction]
FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Answers:
    """Rational feature differences, oriented so that every answer is 1 (an answer 0 turns its difference around)."""

    oriented: tuple[tuple[Fraction, ...], ...]

    def log_likelihood(self, w: Vector) -> Ball:
        """l(w) as a ball at the working precision."""
        return -sum(((ball(-dot(x, w)).exp() + 1).log() for x in self.oriented), start=ball(0))

    def gradient(self, w: Vector) -> list[Ball]:
        """The gradient of l at w, by coordinates."""
        weights = [1 / (ball(dot(x, w)).exp() + 1) for x in self.oriented]
        return [
            sum((g * ball(x[j]) for g, x in zip(weights, self.oriented, strict=True)), start=ball(0))
            for j in range(len(w))
        ]

    def floats(self) -> FloatArray:
        """The oriented differences as an array, one a row."""
        return np.array([[float(entry) for entry in x] for x in self.oriented])


def dot(x: Vector, w: Vector) -> Fraction:
    """The inner product of two rational vectors."""
    return sum((a * b for a, b in zip(x, w, strict=True)), Fraction(0))


def rational(values: FloatArray, denominator: int = 1024) -> tuple[Fraction, ...]:
    """Nearby rationals of one denominator."""
    return tuple(Fraction(round(float(value) * denominator), denominator) for value in values)


def random_answers(rng: np.random.Generator, count: int, dimension: int, scale: float = 1.0) -> tuple[Answers, Vector]:
    """Answers of a Bradley-Terry teacher to random questions, and its weights."""
    w = rational(rng.normal(size=dimension) * scale)
    questions = [rational(rng.normal(size=dimension)) for _ in range(count)]
    chances = [float(expit(float(dot(x, w)))) for x in questions]
    signs = [1 if rng.random() < p else -1 for p in chances]
    return Answers(tuple(tuple(s * entry for entry in x) for s, x in zip(signs, questions, strict=True))), w


def log_likelihood(x: FloatArray, w: FloatArray) -> FloatArray:
    """l(w) in floats for oriented differences ``x`` (..., t, d) and weights ``w`` (..., d)."""
    return np.asarray(log_expit(np.einsum("...td,...d->...t", x, w)).sum(axis=-1))


def fit(x: FloatArray, ridge: float, steps: int = 8) -> FloatArray:
    """Approximate maximiser of l(w) - ridge |w|^2/2 by damped Newton steps: nothing relies on its quality."""
    w = np.zeros((*x.shape[:-2], x.shape[-1]))
    eye = ridge * np.eye(x.shape[-1])
    for _ in range(steps):
        p = expit(-np.einsum("...td,...d->...t", x, w))
        gradient = np.einsum("...t,...td->...d", p, x) - ridge * w
        hessian = np.einsum("...t,...td,...te->...de", np.maximum(p * (1 - p), 0.02), x, x) + eye
        w = w + np.linalg.solve(hessian, gradient[..., None])[..., 0]
    return w


def evidence(x: FloatArray, m: FloatArray, lam: float) -> FloatArray:
    """Q of the Gaussian around ``m`` by the determinant bound: l(m) - lam |m|^2/2 - log det(I + X'X/(4 lam))/2."""
    gram = np.eye(x.shape[-1]) + np.einsum("...td,...te->...de", x, x) / (4 * lam)
    growth = np.linalg.slogdet(gram)[1]
    return np.asarray(log_likelihood(x, m) - lam * (m**2).sum(axis=-1) / 2 - growth / 2)
