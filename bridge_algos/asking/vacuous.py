r"""Whether a certificate says anything: can a candidate be the best under weights that the answers leave possible?

A contender is bounded over the weights under which it beats its rivals. Where no candidate beats its own anywhere in
the likelihood set, every bound is a maximum over nothing, and no gap would be smaller (companion, trap 10): then the
answers contradict the model, W, or that a candidate is best.
"""

from __future__ import annotations

import numpy as np

from bridge_algos.asking.dual import LikelihoodSet, dual_bounds, search
from bridge_algos.asking.gap import Rivals
from bridge_algos.mdp import FloatArray, IntArray

MOST, BATCH, TURNS = 256, 8, 3
"""Candidates that are looked at, in the order of their utilities; at a time; and searches for each."""

TILT = 1e-3
"""Length of the direction that a search follows; it mostly lowers what the rivals are ahead by."""

TIE = 1e-9
"""Nats by which a rival may be ahead, which rounding can feign."""


def best_somewhere(features: FloatArray, rivals: Rivals | None, region: LikelihoodSet) -> bool | None:
    """True when weights of the set were found under which a candidate is best; False when none is, by duality.

    None where neither is known.

    Args:
        features: (N, d) of the candidates.
        rivals: as of :class:`bridge_algos.asking.gap.Gap`.
        region: the likelihood set.
    """
    order = np.argsort(-(features @ region.interior), kind="stable")[:MOST]
    nowhere = len(order) == len(features)
    for start in range(0, len(order), BATCH):
        verdict = _some_best(features, rivals, region, order[start : start + BATCH])
        if verdict:
            return True
        nowhere &= verdict is False
    return False if nowhere else None


def _some_best(features: FloatArray, rivals: Rivals | None, region: LikelihoodSet, chosen: IntArray) -> bool | None:
    own, d = features[chosen], features.shape[1]
    points = np.repeat(region.interior[None], len(chosen), axis=0)
    known = np.zeros((len(chosen), 0, d)) if rivals is None else own[:, None] - rivals(chosen)
    tilt = np.full((len(chosen), d), TILT / np.sqrt(d))
    nowhere = np.zeros(len(chosen), dtype=bool)
    for _ in range(TURNS):
        ahead = own - features[(points @ features.T).argmax(axis=1)]
        known = np.concatenate([known, ahead[:, None]], axis=1)
        if (np.einsum("bkd,bd->bk", known, points).min(axis=1) >= -TIE).any():
            return True
        lengths = np.linalg.norm(known, axis=2, keepdims=True)
        units = known / np.where(lengths > 1e-9, lengths, np.inf)
        found = search(region, tilt, units, 1e-6)
        bound, _ = dual_bounds(region, 0 * tilt, units, found.points, found.multipliers, found.rival_multipliers)
        nowhere |= bound < 0  # on <0, w>, over the weights under which this candidate is best
        points = found.inside
    return False if nowhere.all() else None
