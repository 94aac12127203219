"""Each mistake that would make the checker certify too much is noticed by a comparison with plain computations."""

import itertools
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import isqrt
from typing import Any

import numpy as np
import pytest
from asking_forgeries import _largest, _log, oracle_level
from test_asking_sessions_are_certified import honest

from bridge_theory.arithmetic.flint_balls import ball, working_precision
from proofs_checks.asking_checker import candidates, checker, dual, evidence, facts, region, slopes
from proofs_checks.verify.enclosed import Enclosed


@cache
def record() -> dict[str, Any]:
    return honest("starmdp")


def problems() -> list[str]:
    """What is wrong with the checker, on one session."""
    with working_precision(64):
        given = facts.facts(record())
        found, fixed = [], given.setting
        x = _log(record(), fixed.mdp)
        plain = oracle_level(x, list(fixed.precisions), fixed.delta)
        least = evidence.level(given.log, fixed.precisions, fixed.delta)
        found += ["level"] if not plain - 1e-4 <= least <= plain + 1e-9 else []
        shown = record()["demonstrations"]
        pairs = [pair for row in zip(shown["states"], shown["actions"], strict=True) for pair in zip(*row, strict=True)]
        taken = dict(pairs)
        listed = list(itertools.product(*[[taken[s]] if s in taken else range(4) for s in range(5)]))
        found += ["candidates"] if sorted(map(tuple, given.candidates.policies.tolist())) != sorted(listed) else []
        found += ["bounds"] if not _bounds_hold(given, plain, x) else []
        exact = [-(Fraction(k, 2**16)) for k in (1, 77, 30000)]
        for k, share in zip((1, 77, 30000), exact, strict=True):
            entropy = ball(share) * ball(-share).log() - ball(1 + share) * ball(1 + share).log()
            found += ["entropies"] if not entropy * 2**40 >= int(slopes.entropies()[k]) else []
        found += ["rounding"] if not _rounded_up() else []
    return found


def _bounds_hold(given: Any, level: float, x: np.ndarray) -> bool:
    fixed = given.setting
    regional = region.region_at(given.log, level, fixed.weight_bound)
    gap = checker.certified_gap(given, regional, facts.Claims(False, False, 1.0))
    gap.target = -1.0
    gap.tighten(1e-3)
    features = given.candidates.features
    for i in range(len(features)):
        changed = [np.where(np.arange(5) == s, a, given.candidates.policies[i]) for s in range(5) for a in range(4)]
        others = candidates.features_of(fixed.mdp, fixed.table, np.array(changed)).mid
        rows = features[i] - np.concatenate([features, others])
        most = _largest(features[i] - given.anchor.mid, rows, x, [len(x)], [level], fixed.weight_bound)
        if not max(most, -1.0) - 1e-5 <= gap.bounds[i] <= max(most, -1.0) + 0.02:
            return False
    return True


def _rounded_up() -> bool:
    """Whether bounds lie above what fractions give, for random certificates."""
    rng = np.random.default_rng(3)
    for _ in range(60):
        g, h, c, mu = rng.normal(size=(1, 2, 3)), rng.normal(size=(1, 2)), rng.random((1, 2)), rng.random((1, 2))
        rivals, anchor, own = rng.normal(size=(1, 2, 3)), rng.normal(size=3), rng.normal(size=(1, 3))
        made = dual.duals(Enclosed(anchor, 0.0), (g, h), c, Enclosed(rivals, 0.0), mu)
        bound = dual.bounds(made, np.array([0]), own, np.zeros(1), 1.5)[0]
        f = lambda v: [Fraction(float(e)) for e in np.ravel(v)]  # noqa: E731
        rest = [
            p - a + sum(cj * gj for cj, gj in zip(f(c), f(g[0, :, i]), strict=True))
            for i, (p, a) in enumerate(zip(f(own), f(anchor), strict=True))
        ]
        for i in range(3):
            rest[i] += sum(m * (f(own)[i] - r) for m, r in zip(f(mu), f(rivals[0, :, i]), strict=True))
        squares = sum(e * e for e in rest) * 10**60
        offset = sum(cj * hj for cj, hj in zip(f(c), f(h), strict=True))
        if Fraction(float(bound)) < offset + Fraction(3, 2) * Fraction(isqrt(int(squares)), 10**30):
            return False
    return True


Patch = Callable[[pytest.MonkeyPatch], None]
level, divergence, expectation = evidence.level, evidence.divergence, evidence.expectation
space, bounds, table, tangents = (
    candidates.version_space,
    dual.bounds,
    slopes.entropies,
    slopes.tangents,
)


def _invented(given: Any, policies: Any) -> Enclosed:
    """Rivals that are no policies: beating them means not to beat the recommended one."""
    own = candidates.features_of(given.setting.mdp, given.setting.table, policies)
    return Enclosed((2 * own.mid - given.anchor.mid)[:, None], own.rad)


def _no_rounding(m: pytest.MonkeyPatch) -> None:
    m.setattr(dual, "UNIT", 0.0)
    m.setattr(dual, "_up", lambda v: v)


MUTANTS: dict[str, Patch] = {
    "log(1/delta) is dropped": lambda m: m.setattr(
        evidence, "level", lambda g, p, d, u=None: level(g, p, 1 - 1e-12, u)
    ),
    "the divergence has the wrong sign": lambda m: m.setattr(evidence, "divergence", lambda *a: -divergence(*a)),
    "the divergence is dropped": lambda m: m.setattr(evidence, "divergence", lambda *a: ball(0)),
    "the mixture's log k is dropped": lambda m: m.setattr(
        evidence, "level", lambda g, p, d, u=None: max(level(g, (k,), d, u) for k in p)
    ),
    "the spread is halved": lambda m: m.setattr(evidence, "expectation", lambda mu, s: expectation(mu, s / 2)),
    "a candidate is missing": lambda m: m.setattr(facts, "version_space", lambda r, n: space(r, n)[1:]),
    "rivals are no policies": lambda m: m.setattr(checker, "deviations", _invented),
    "W is halved": lambda m: m.setattr("proofs_checks.asking_checker.gap.bounds", lambda *a: bounds(*a[:4], a[4] / 2)),
    "entropies are rounded up": lambda m: m.setattr(slopes, "entropies", lambda: table() + 1),
    "nothing is rounded": _no_rounding,
    "a tangent's height is dropped": lambda m: m.setattr(
        checker, "tangents", lambda *a: (tangents(*a)[0], tangents(*a)[1] - 0.5)
    ),
}


def test_the_checker_has_no_problems() -> None:
    assert problems() == []


@pytest.mark.parametrize("name", MUTANTS)
def test_mutant_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    MUTANTS[name](monkeypatch)
    assert problems() != []
