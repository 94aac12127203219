r"""How many answers the earlier certificate (audit R1, with kappa in its width) would need: an estimate in its favour.

R1 keeps the weights with :math:`\|w - w_t\|_{V_t} \le \rho_t`, :math:`V_t = \kappa \lambda I + \sum x x'`, so that its
gap for a contender is :math:`\langle v, w_t \rangle + \rho_t \|v\|_{V_t^{-1}}`. The number reported puts the centre
:math:`w_t` exactly at the true weights with no solver's error, and recommends the best candidate. Pairs are chosen by
the paper's rule, the greatest :math:`\|x\|_{V_t^{-1}}` in the pool; the counts are far beyond what can be simulated, so
that the shares in which the rule asks its pairs are taken from its first steps and extrapolated.
"""

from __future__ import annotations

from math import inf

import numpy as np

import bridge_theory as theory
from bridge_algos.asking.limit import farthest
from bridge_algos.asking.tabular import Problem
from bridge_algos.mdp import FloatArray

LAM, STEPS, LARGEST = 1.0, 200, 300.0
"""R1's lambda; pairs that the rule's shares are taken from; log10 of the largest number of answers tried."""


def paper_design(items: FloatArray, steps: int = STEPS) -> FloatArray:
    """(d, d) the mean of x x' over the pairs that the paper's rule asks first, with little regularisation."""
    items = np.unique(items, axis=0)
    dimension = items.shape[1]
    total = 1e-6 * np.eye(dimension)
    for _ in range(steps):
        y = items @ np.linalg.cholesky(np.linalg.inv(total))
        norms = np.vecdot(y, y)
        first, second = divmod(int((norms[:, None] + norms[None] - 2 * (y @ y.T)).argmax()), len(items))
        x = items[first] - items[second]
        total += np.outer(x, x)
    return np.asarray((total - 1e-6 * np.eye(dimension)) / steps)


def answers_needed(problem: Problem, nats: float, delta: float) -> float:
    """The number of answers from which R1's gap is at most ``nats``; infinite above 10^LARGEST."""
    from scipy.optimize import brentq

    features, utility = problem.candidates.features, problem.utility
    values = features @ utility.weights
    v = np.delete(features, int(values.argmax()), axis=0) - features[int(values.argmax())]
    room = nats - v @ utility.weights
    if not len(v):
        return 0.0
    kappa = float(theory.kappa_differences.estimate(B=utility.embedding.bound, W=utility.weight_bound))
    spectrum, basis = np.linalg.eigh(paper_design(farthest(utility.embedding.of_trajectories(problem.pool))))
    along = (v @ basis) ** 2

    def excess(exponent: float) -> float:
        grown = kappa * LAM + 10**exponent * np.maximum(spectrum, 0)
        ratio = float(np.log(grown / (kappa * LAM)).sum())
        radius = float(
            theory.confidence_radius_repaired.estimate(
                B=utility.embedding.bound,
                W=utility.weight_bound,
                lam=LAM,
                delta_w=delta,
                log_det_ratio=ratio,
                residual=0,
            )
        )
        return float(np.log((radius * np.sqrt((along / grown).sum(axis=1)) / room).max()))

    if excess(LARGEST) > 0:
        return inf
    return float(10 ** brentq(excess, 0.0, LARGEST)) if excess(0.0) > 0 else 0.0
