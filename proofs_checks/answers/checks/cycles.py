"""Preferences that go round in a circle: how soon the model test refutes them, and what is certified without it."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from scipy.special import betaln

import bridge_theory as theory
from proofs_checks.answers.checks.logistic import FloatArray, evidence, fit, log_likelihood
from proofs_checks.context import Context
from proofs_checks.coverage import Coverage
from proofs_checks.outcome import Outcome

PAIRS = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0], [-1.0, 0.0, 1.0]])
"""Items 0 > 1 > 2 > 0: the first item of each question is the one that the circle prefers."""


def answers_until_refuted(rng: np.random.Generator, chance: float, most: int) -> int:
    """Answers until tables, mixed half and half with the model, lead by log(2/delta); ``most`` if they never do."""
    lead = float(theory.refutation_threshold.estimate(forecasters=2, delta=0.05))
    wins = rng.random((most, 1)) < chance
    signs = np.where(wins, 1.0, -1.0)
    for t in range(6, most):
        ones = np.array([wins[i:t:3].sum() for i in range(3)])
        zeros = np.array([len(wins[i:t:3]) for i in range(3)]) - ones
        x = np.tile(PAIRS, (t // 3 + 1, 1))[:t] * signs[:t]
        if betaln(ones + 1, zeros + 1).sum() - log_likelihood(x, fit(x, 1e-3, steps=12)) >= lead:
            return t
    return most


def circle_is_refuted(context: Context, *, chance: float = 0.9) -> Outcome:
    """A circle at .9 is refuted within 50 answers in at least 9 of 10 sessions."""
    streams = context.rng().spawn(context.pick(quick=100, full=300))
    needed = [answers_until_refuted(rng, chance, 50) for rng in streams]
    late = sum(t >= 50 for t in needed)
    return Coverage(Fraction(1, 10), len(needed), late).outcome(
        f"a circle at {chance}: median {np.median(needed):.0f} answers until it is refuted"
    )


def certified_gap_of_a_circle(t: int) -> float:
    """The gap certified between two items after ``t`` answers of a circle at exactly .9, without a model test.

    The fit is 0 by symmetry; the threshold is the determinant bound's in the two dimensions that differences span.
    """
    basis = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]]) / np.sqrt([[2.0], [6.0]])
    x = np.repeat(PAIRS @ basis.T, t // 3, axis=0)
    signs = np.where(np.arange(len(x)) % 10 < 9, 1.0, -1.0)[:, None]
    return _gap(x * signs, basis @ np.array([1.0, -1.0, 0.0]))


def _gap(x: FloatArray, v: FloatArray) -> float:
    from proofs_checks.answers.checks.dual import certified_in_floats

    level = float(evidence(x, fit(x, 1.0), 1.0)) + np.log(0.05)
    return certified_in_floats(x, v, level, 5.0)
