r"""Dual certificates, evaluated with every rounding bounded: one bounds every candidate (companion G2 and G3).

Weights of the set satisfy <g_j, w> + h_j >= 0 for every tangent j (h_j less the level), and the best candidate beats
every policy it is compared with. So for the candidate with features phi, anchor a, c_j >= 0 and mu_k >= 0

.. math:: \langle \phi - a, w \rangle
          \le \sum_j c_j h_j + W \| \phi - a + \sum_j c_j g_j + \sum_k \mu_k (\phi - \phi_k) \|
          = o + W \| f \phi + b \|

with o = sum c_j h_j, f = 1 + sum mu_k and b = -a + sum c_j g_j - sum mu_k phi_k, in which only phi is the candidate's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from proofs_checks.verify.enclosed import UNIT, Enclosed, FloatArray
from proofs_checks.verify.features import IntArray


@dataclass(frozen=True, eq=False)
class Duals:
    """J certificates.

    Args:
        offset: (J,) o, rounded up.
        factor: (J,) f.
        shift: (J, d) b.
        wrong: (J,) bounds on what is missing in any coordinate of f phi + b, besides phi's own radius and that sum.
        terms: roundings in f.
    """

    offset: FloatArray
    factor: FloatArray
    shift: FloatArray
    wrong: FloatArray
    terms: int


def duals(
    anchor: Enclosed,
    tangents: tuple[FloatArray, FloatArray],
    c: FloatArray,
    rivals: Enclosed,
    mu: FloatArray,
) -> Duals:
    """Certificates from J sets of multipliers, negative ones counted as zero.

    Args:
        anchor: (d,).
        tangents: g (J, i, d), exact, and h (J, i) less the level, rounded up.
        c: (J, i).
        rivals: (J, k, d) features of the policies that the best candidate beats.
        mu: (J, k).
    """
    c, mu = np.maximum(np.nan_to_num(c), 0.0), np.maximum(np.nan_to_num(mu), 0.0)
    g, h = tangents
    size, k, i = len(c), mu.shape[1], c.shape[1]
    terms = 4 * (k + i + 8)
    shift = np.einsum("ji,jid->jd", c, g) - np.einsum("jk,jkd->jd", mu, rivals.mid) - anchor.mid
    sizes = np.abs(anchor.mid) + np.einsum("ji,jid->jd", c, np.abs(g)) + np.einsum("jk,jkd->jd", mu, np.abs(rivals.mid))
    wrong = terms * UNIT * sizes.max(axis=1) + anchor.rad + mu.sum(axis=1) * rivals.rad
    offset = (c * h).sum(axis=1) + terms * UNIT * (c * np.abs(h)).sum(axis=1)
    assert shift.shape[0] == size
    return Duals(_up(offset), 1 + mu.sum(axis=1), shift, wrong * (1 + 1e-9) + 1e-280, terms)


def bounds(dual: Duals, chosen: IntArray, features: FloatArray, radii: FloatArray, weight_bound: float) -> FloatArray:
    """(N,) for each candidate the bound by the certificate chosen for it, rounded up."""
    d = features.shape[1]
    factor, shift = dual.factor[chosen], dual.shift[chosen]
    rest = factor[:, None] * features + shift
    sizes = factor * np.abs(features).max(axis=1) + np.abs(shift).max(axis=1)
    wrong = dual.wrong[chosen] + factor * radii * (1 + 1e-9) + dual.terms * UNIT * sizes
    norm = np.sqrt((rest**2).sum(axis=1)) * (1 + (d + 8) * UNIT) + d * wrong * (1 + 1e-9)
    offset, reach = dual.offset[chosen], weight_bound * norm
    return _up(offset + reach + 4 * UNIT * (np.abs(offset) + reach))


def nearest(dual: Duals, features: FloatArray, weight_bound: float) -> IntArray:
    """(N,) for each candidate the certificate that seems to bound it best; a choice in floats, which nothing trusts."""
    squares = dual.factor[:, None] ** 2 * np.vecdot(features, features) + np.vecdot(dual.shift, dual.shift)[:, None]
    squares += 2 * dual.factor[:, None] * (dual.shift @ features.T)
    return np.asarray((dual.offset[:, None] + weight_bound * np.sqrt(np.maximum(squares, 0))).argmin(axis=0))


def _up(x: FloatArray) -> FloatArray:
    return np.asarray(np.nextafter(x, np.inf))
