"""Simulated adaptive sessions: the true weights stay in the likelihood set up to any stopping time."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

import bridge_theory as theory
from proofs_checks.answers.checks.logistic import FloatArray, evidence, fit, log_likelihood
from proofs_checks.context import Context
from proofs_checks.coverage import Coverage
from proofs_checks.outcome import Outcome

DELTA = Fraction(1, 10)
_ROUNDS, _LAM, _W = 50, 0.5, 2.0


def stays_inside(context: Context, *, price: float = 1.0) -> Outcome:
    """l_t(w*) >= Q_t - log(1/delta) at every t <= 50, Q_t at a fitted m; ``price`` multiplies what Q pays for m.

    A third of the sessions ask where the fit and the truth disagree, a third where the fit is least certain, a third
    at random; the first are adversaries that know the truth.
    """
    runs = context.pick(quick=300, full=1500)
    rng = context.rng()
    w = _W * _directions(rng, runs)
    x = np.zeros((runs, 0, 2))
    failed = np.zeros(runs, dtype=bool)
    for _ in range(_ROUNDS):
        m = fit(x, _LAM, steps=4)
        question = 1.5 * _question(x, m, w, rng)
        sign = np.where(rng.random(runs) < 1 / (1 + np.exp(-(question * w).sum(axis=1))), 1.0, -1.0)
        x = np.concatenate([x, (sign[:, None] * question)[:, None, :]], axis=1)
        m = fit(x, _LAM, steps=4)
        at_m = log_likelihood(x, m)
        q = at_m - price * (at_m - evidence(x, m, _LAM))
        threshold = theory.likelihood_threshold.estimate(
            evidence_loss=np.maximum(-q, 0.0), scales=1, delta=float(DELTA)
        )
        failed |= log_likelihood(x, w) < -threshold
    return Coverage(DELTA, runs, int(failed.sum())).outcome("w* in the likelihood set at all times")


def _question(x: FloatArray, m: FloatArray, w: FloatArray, rng: np.random.Generator) -> FloatArray:
    runs = len(m)
    apart = (m - w) / np.maximum(np.linalg.norm(m - w, axis=1, keepdims=True), 1e-9)
    weakest = np.linalg.eigh(np.eye(2) + np.einsum("rti,rtj->rij", x, x))[1][:, :, 0]
    choice = (np.arange(runs) % 3)[:, None]
    return np.where(choice == 0, apart, np.where(choice == 1, weakest, _directions(rng, runs)))


def _directions(rng: np.random.Generator, runs: int) -> FloatArray:
    angle = rng.random(runs) * 2 * np.pi
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)
