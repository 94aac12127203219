r"""Stochastic clones of noisy demonstrations, and how close deterministic policies come to them.

The paper's offline set has a deterministic centre. These centres are the ones a reader would try to explain the
published table with: the log-loss clone over all stochastic policies, one that counting never makes certain, and one
that was trained only a little.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bridge_algos.mdp import Dynamics, FloatArray
from bridge_algos.offline.cloning import clone_stochastic
from bridge_algos.shapes import PairCounts, PairTable, PerPolicy, Policies


def smoothed(pairs: PairCounts, pseudo_count: float = 0.1) -> PairTable:
    """Action frequencies after ``pseudo_count`` more records of each pair.

    >>> smoothed(np.array([[3, 1]]), 0.5)
    array([[0.7, 0.3]])
    """
    raised = pairs + pseudo_count
    return np.asarray(raised / raised.sum(axis=1, keepdims=True))


def hardly_trained(pairs: PairCounts, steps: int = 10, rate: float = 0.01) -> PairTable:
    """Softmax policy after some gradient steps on the summed log-loss, from equal logits.

    >>> hardly_trained(np.array([[1, 0]]), steps=1, rate=0.0)
    array([[0.5, 0.5]])
    """
    logits = np.zeros(pairs.shape)
    totals = pairs.sum(axis=1, keepdims=True)
    for _ in range(steps):
        logits += rate * (pairs - totals * _softmax(logits))
    return _softmax(logits)


def _softmax(logits: FloatArray) -> FloatArray:
    raised = np.exp(logits - logits.max(axis=1, keepdims=True))
    return np.asarray(raised / raised.sum(axis=1, keepdims=True))


SOFT_CLONES: dict[str, tuple[str, Callable[[PairCounts], PairTable]]] = {
    "frequencies": ("action frequencies", clone_stochastic),
    "smoothed": ("frequencies after 0.1 more records of each action", smoothed),
    "hardly_trained": ("ten gradient steps of 0.01 on the log-loss", hardly_trained),
}
"""Stochastic clones by key, with their descriptions; the constants are examples, not the paper's."""


def overlaps(dynamics: Dynamics, clone: PairTable, policies: Policies) -> PerPolicy:
    r"""Bhattacharyya coefficients of deterministic policies (N, S) with a stochastic clone under one kernel, (N,).

    As :func:`bridge_algos.hellinger.bhattacharyya`, for many policies at once: the weight of a state is
    :math:`\sqrt{\hat\pi(\pi(s)|s)}` and the kernel row is that of :math:`\pi(s)`. :math:`H^2` is 1 less the result.
    """
    states = np.arange(dynamics.n_states)
    weight = np.sqrt(clone)[states, policies]
    kernel = dynamics.transitions[states, policies]
    mass = weight * dynamics.initial
    for _ in range(dynamics.horizon - 1):
        mass = np.einsum("ns,nst->nt", mass, kernel) * weight
    return np.asarray(np.minimum(mass.sum(axis=1), 1.0))
