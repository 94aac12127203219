r"""How far estimated differences of features may be from the truth: a few long axes, and a ball for the rest.

The difference of two candidates' features is the mean of differences y of their rollouts. Most of these are long in one
or two directions, and in those directions the answers settle the utility; a ball around the estimate would charge the
longest axis to every direction. So with orthonormal u_1..u_q and P the projection across them

.. math:: E y = \bar y + \sum_k t_k a_k u_k + e, \qquad |t_k| \le 1, \quad \|e\| \le r ,

where a_k bounds :math:`|\langle u_k, \bar y - E y \rangle|` and r bounds :math:`\|P(\bar y - E y)\|`, both from
:mod:`bridge_algos.asking.rollout_bounds`. The axes come from other rollouts than the means, and so are fixed for them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bridge_algos.asking.rollout_bounds import mean_radius, norm_radius
from bridge_algos.mdp import FloatArray, IntArray

AXES = 2
"""Axes of a pair of candidates."""

EVENTS = 3 * AXES + 3 + 2
"""Bounds that hold for a pair, each with its own chance to fail: of the axes, the rest, and the ball around all."""


@dataclass(frozen=True, eq=False)
class FeatureErrors:
    """Of the differences of N candidates to one, all holding at once.

    Args:
        radii: (N,) the difference is within so much of its estimate.
        closely: maps indices (B,) to axes (B, q, d), each as long as a_k, and to the radii (B,) of the rest; None where
            nothing but ``radii`` is known.
        rivals: maps indices (B,) to the radii (B, k) of their rivals' differences to the one; None without rivals.
    """

    radii: FloatArray
    closely: Callable[[IntArray], tuple[FloatArray, FloatArray]] | None = None
    rivals: Callable[[IntArray], FloatArray] | None = None

    def axes(self, index: IntArray, dimension: int) -> tuple[FloatArray, FloatArray]:
        """Axes (B, q, d) and the radii (B,) of the rest."""
        if self.closely is None:
            return np.zeros((len(index), 0, dimension)), self.radii[index]
        return self.closely(index)


def ball_errors(radii: FloatArray) -> Callable[[int], FeatureErrors]:
    """From radii (N,) of balls around each candidate's features, all holding at once.

    >>> ball_errors(np.array([0.1, 0.2]))(0).radii
    array([0. , 0.3])
    """

    def errors(recommended: int) -> FeatureErrors:
        both = radii + radii[recommended]
        both[recommended] = 0.0
        return FeatureErrors(both)

    return errors


def long_axes(pilot: FloatArray) -> FloatArray:
    """(q, d) orthonormal directions in which differences of other rollouts, with these moments (d, d), are longest."""
    found = np.linalg.eigh(pilot)[1]
    return np.asarray(found[:, ::-1][:, : min(AXES, found.shape[1])].T)


def along_and_across(
    axes: FloatArray, moments: FloatArray, reach: float, log_chance: float, n: int
) -> tuple[FloatArray, float]:
    """Axes scaled to a_k, and r, of the mean of n differences y with norms at most ``reach``.

    Args:
        axes: (q, d) from other rollouts.
        moments: (d, d) the sample mean of y y'.
        log_chance: L; what is returned fails with probability at most (3 q + 3) exp(-L).
        n: rollouts, fixed before they were made.
    """
    squares = np.maximum(np.vecdot(axes @ moments, axes), 0.0)
    lengths = mean_radius(squares, reach, log_chance, n)
    across = np.eye(len(moments)) - axes.T @ axes
    left = across @ moments @ across
    trace, top = max(float(np.trace(left)), 0.0), max(float(np.linalg.eigvalsh(left)[-1]), 0.0)
    rest = norm_radius(np.array(trace), np.array(top), reach, log_chance, n)
    return lengths[:, None] * axes, float(rest)
