r"""Whether a certificate is about anything: a candidate must be best under weights that the answers leave possible.

Otherwise every bound is a maximum over nothing. Weights are searched in floats; that they belong to the set is proved,
and so is, by duality, that there are none: the bound on <0, w> over them is negative.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from proofs_checks.asking_checker.barrier import Region, search
from proofs_checks.asking_checker.candidates import Candidates
from proofs_checks.asking_checker.dual import bounds, duals
from proofs_checks.asking_checker.gap import Deviations, Tangents
from proofs_checks.verify.enclosed import Enclosed, FloatArray

MOST, TURNS, ACCURACY = 256, 3, 1e-2
"""Candidates that are tried, the most useful at the likeliest weights first; searches for each, and how exact."""

TIE = 1e-9
"""Nats by which a rival may be ahead: features are known to a rounding only."""


def best_somewhere(
    candidates: Candidates,
    deviations: Deviations | None,
    region: Region,
    tangents: Tangents,
    inside: Callable[[FloatArray], bool],
) -> bool | None:
    """True when weights of the set are found under which a candidate is best, up to TIE; False when none is, proved.

    None where neither is known.

    Args:
        candidates, deviations, region, tangents: as for the gap.
        inside: whether weights are proved to be in the set.
    """
    features = candidates.features
    order = np.argsort(-(features @ region.inside), kind="stable")[:MOST]
    nowhere = len(order) == len(features)
    for index in order.tolist():
        verdict = _best_somewhere(index, candidates, deviations, region, tangents, inside)
        if verdict:
            return True
        nowhere &= verdict is False
    return False if nowhere else None


def _best_somewhere(
    index: int,
    candidates: Candidates,
    deviations: Deviations | None,
    region: Region,
    tangents: Tangents,
    inside: Callable[[FloatArray], bool],
) -> bool | None:
    features, d = candidates.features, candidates.features.shape[1]
    own, somewhere = features[index], np.full((1, d), 1 / np.sqrt(d))  # a direction for the search, of no importance
    near = Enclosed(np.zeros((1, 0, d)), 0.0) if deviations is None else deviations(candidates.policies[[index]])
    others, radius = near.mid[0], max(near.rad, float(candidates.radii.max()))
    point = region.inside
    for _ in range(TURNS):
        others = np.concatenate([others, features[[int((features @ point).argmax())]]])
        if float(((own - others) @ point).min()) >= -TIE and inside(point):
            return True
        rows = own - others
        lengths = np.linalg.norm(rows, axis=1)
        lengths = np.where(lengths > 1e-6, lengths, np.inf)
        units = (rows / lengths[:, None])[None]
        found = search(region, somewhere, units, np.zeros((1, len(rows))), ACCURACY, -np.inf)
        point = found.points[0]
        anchor = Enclosed(own, 0.0)
        dual = duals(
            anchor, tangents(found.points), found.c[:, None], Enclosed(others[None], radius), found.mu / lengths
        )
        at = np.zeros(1, dtype=np.int64)
        bound = bounds(dual, at, own[None], candidates.radii[[index]], region.weight_bound)
        if bound[0] < 0:  # on <0, w>
            return False
    return None
