r"""Arrays of numbers known up to one common radius: ball arithmetic at the speed of NumPy.

Every entry of the true array lies within ``rad`` of its entry in ``mid``. A product of k terms in double precision errs
by at most :math:`\gamma_k = ku/(1-ku)`, u = 2^-53, times the sum of magnitudes, in any order of summation and with or
without fused operations (Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 3.1); radii are
enlarged by a factor that covers their own rounding, and by a constant that covers underflow.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]

UNIT = 2.0**-53
_ENLARGE = 1 + 1e-9
_TINY = 1e-280


class Enclosed(NamedTuple):
    """Midpoints and the radius that they share."""

    mid: FloatArray
    rad: float

    @property
    def size(self) -> float:
        """A bound on the magnitude of every entry."""
        return enlarged(float(np.abs(self.mid).max(initial=0.0)) + self.rad)

    def rows(self, chosen: NDArray[np.int64]) -> Enclosed:
        """Some of the rows."""
        return Enclosed(self.mid[chosen], self.rad)


def enlarged(x: float) -> float:
    """A float that is larger than x, by more than the rounding of the few operations that made it."""
    return x * _ENLARGE + _TINY


def raised(x: FloatArray) -> FloatArray:
    """Nonnegative floats, enlarged by more than the rounding of a dozen operations."""
    return np.asarray(x * (1 + 32 * UNIT) + _TINY)


def product(a: Enclosed, b: Enclosed) -> Enclosed:
    """The matrix product.

    >>> product(Enclosed(np.ones((1, 2)), 0.0), Enclosed(np.ones((2, 1)), 0.5)).rad > 1
    True
    """
    terms = a.mid.shape[-1]
    rows, top = float(np.abs(a.mid).sum(axis=-1).max(initial=0.0)), float(np.abs(b.mid).max(initial=0.0))
    rounding = (terms + 2) * UNIT * rows * top
    return Enclosed(a.mid @ b.mid, enlarged(rounding + rows * b.rad + terms * a.rad * (top + b.rad)))


def difference(a: Enclosed, b: Enclosed) -> Enclosed:
    """a - b, with broadcasting."""
    mid = a.mid - b.mid
    return Enclosed(mid, enlarged(a.rad + b.rad + UNIT * float(np.abs(mid).max(initial=0.0))))


def largest_norms(a: Enclosed) -> FloatArray:
    """Upper bounds on the Euclidean norms of the rows."""
    d = a.mid.shape[-1]
    norms = np.sqrt((a.mid**2).sum(axis=-1))
    return np.asarray(norms * (1 + (d + 8) * UNIT) + enlarged(np.sqrt(d) * a.rad))


def cumulative(steps: FloatArray) -> FloatArray:
    """Running sums of nonnegative floats, each addition rounded up."""
    total, sums = 0.0, np.empty(len(steps))
    for i, step in enumerate(steps):
        total = float(np.nextafter(total + step, np.inf))
        sums[i] = total
    return sums
