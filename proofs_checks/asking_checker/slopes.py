r"""Tangents of the log-likelihood with exact slopes: half-spaces that contain the likelihood set.

:math:`\log \sigma(z) = \min_{0 \le p \le 1} (p z - H(p))`, H the binary entropy in nats. So slopes p_r for the distinct
questions, whatever they are, give :math:`\ell_t(w) \le \langle g, w \rangle - \sum_r N_r H(p_r)` with
:math:`g = \sum_r (N_r p_r - n^0_r) x_r`, for every w. Slopes are multiples of 2^-16, features and counts whole
numbers: g is exact, the entropies come from a table made in balls, and nothing here rests on a float's exponential.
This is companion G2's tangent, except that its points may differ from question to question.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from bridge_theory.arithmetic.flint_balls import ball
from bridge_theory.errors import InputError
from proofs_checks.asking_checker.fit import sigmoid
from proofs_checks.asking_checker.log import Log
from proofs_checks.verify.enclosed import FloatArray
from proofs_checks.verify.features import IntArray

PARTS = 2**16
"""Slopes are whole multiples of 1 / PARTS."""

BITS = 40
"""Entropies are whole multiples of 2^-BITS, rounded down."""


@cache
def entropies() -> NDArray[np.int64]:
    """(PARTS + 1,) H(k / PARTS) in units of 2^-BITS, rounded down."""
    terms = [ball(0)] + [-ball(k) / PARTS * (ball(k) / PARTS).log() for k in range(1, PARTS)] + [ball(0)]
    half = [int(((terms[k] + terms[PARTS - k]) * 2**BITS).lower().floor().unique_fmpz()) for k in range(PARTS // 2 + 1)]
    return np.array(half + half[-2::-1], dtype=np.int64)


def tangents(log: Log, w: FloatArray, until: int | None = None) -> tuple[FloatArray, FloatArray]:
    """For each of B points (B, d) a pair g (B, d) and h (B,) with l_t(w) <= <g, w> + h for every w.

    g is exact and h is rounded up. The pair touches near the point, and is valid however far away.
    """
    ones, zeros = log.counts(until)
    total, x = ones + zeros, log.x
    reach = int((total @ np.abs(log.differences)).max(initial=0)) if len(x) else 0
    if reach * PARTS >= 2**52 or int(total.sum()) >= 2**22:
        raise InputError(f"{total.sum()} answers with features of this size are more than the checker's integers hold.")
    chosen: IntArray = np.rint(sigmoid(-(w @ x.T)) * PARTS).astype(np.int64)
    gradient = (total * chosen - zeros * PARTS).astype(np.float64) @ x / PARTS  # whole numbers below 2^53, exactly
    entropy = entropies()[chosen] @ total
    return gradient, -np.nextafter(entropy.astype(np.float64), -np.inf) * 2.0**-BITS
