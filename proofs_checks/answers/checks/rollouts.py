"""Features from rollouts: exact failure probabilities of coins, and simulated ellipsoids."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from math import comb

import numpy as np

import bridge_theory as theory
from proofs_checks.context import Context
from proofs_checks.coverage import Coverage
from proofs_checks.exact.certify import at_most, value_of
from proofs_checks.exact.every import QUICK
from proofs_checks.outcome import Outcome, Tally

_DELTA = Fraction(1, 5)


def coins(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """The probability that a coin's mean is off by more than the radius, exactly, against delta, at many biases.

    ``share`` multiplies the spread, which is the part that small samples need.
    """
    tally, worst = Tally(), Fraction(0)
    for n in context.pick(quick=(4, 12), full=(2, 4, 8, 12, 24, 48)):
        for p in (Fraction(1, k) for k in (2, 3, 5, 10, 20, 60)):
            failure = sum(
                (comb(n, k) * p**k * (1 - p) ** (n - k) for k in range(n + 1) if _misses(n, k, p, share)), Fraction(0)
            )
            worst = max(worst, failure)
            tally.expect(failure <= _DELTA, f"{n} tosses at {p} miss with probability {float(failure):.4f}")
    return tally.outcome(f"the worst coin misses with {float(worst / _DELTA):.3f} of delta")


def _misses(n: int, ones: int, p: Fraction, share: Fraction) -> bool:
    variance = Fraction(ones * (n - ones), n * (n - 1))
    return not at_most(
        abs(Fraction(ones, n) - p),
        lambda: value_of(
            theory.bernstein_radius, rollouts=n, sample_variance=variance, spread=share, d=1, candidates=1,
            delta_phi=_DELTA,
        ),
    )  # fmt: skip


def looks(*, shift: int = 1) -> Outcome:
    """delta/(k(k+1)) sums to delta: the first n looks spend delta n/(n+1), exactly."""
    tally, delta, spent = Tally(), Fraction(1, 20), Fraction(0)
    for k in range(1, 200):
        spent += delta / k / (k + shift)
        tally.expect(spent == delta * k / (k + 1), f"{k} looks spend {spent}")
        tally.expect(
            at_most(partial(value_of, theory.look_delta, look=k, delta_phi=delta), delta / k / (k + 1)),
            f"the formula spends more at look {k}",
        )
    return tally.outcome("all looks together spend no more than delta")


def linear(*, factor: int = 1) -> Outcome:
    """Errors e_j within E_j change <e, w> by at most |E| W for |w| <= W: in two coordinates (Z3)."""
    from proofs_checks.smt import prove, reals

    e, f, E, F, x, y, W = reals("e f E F x y W")
    return prove(
        "two coordinates",
        [W > 0, E >= 0, F >= 0, e <= E, e >= -E, f <= F, f >= -F, x * x + y * y <= W * W],
        factor * (e * x + f * y) * (e * x + f * y) <= W * W * (E * E + F * F),
        seconds=30,
    )


def fresh(context: Context, *, share: float = 1.0) -> Outcome:
    """The largest true advantage over an ellipsoid stays below that of the sample mean plus the bound.

    Differences are corners of a box around their mean, 20 fresh pairs a session, delta' = 1/5.
    """
    runs, n, d, delta = context.pick(quick=400, full=1000), 20, 3, Fraction(1, 5)
    rng = context.rng()
    mean, m = rng.normal(size=(runs, d)), rng.normal(size=(runs, d)) / 2
    scale, rho = rng.uniform(0.3, 1.5, (runs, d)), rng.uniform(0.5, 2, runs)  # A = diag(1/scale^2)
    noise = rng.choice((-1.0, 1.0), (runs, n, d)) * np.where(rng.random((runs, 1, d)) < 0.5, 1.0, 0.2)
    y = mean[:, None, :] + noise
    inner = np.einsum("rnd,rd->rn", y, m)
    largest = np.abs(mean) + np.abs(noise).max(axis=1)
    spread = 2 * (np.abs(m) * np.abs(noise).max(axis=1)).sum(axis=1)
    added = theory.fresh_rollout_gap.estimate(
        rollouts=n, sample_variance=inner.var(axis=1, ddof=1), spread=spread,
        ellipsoid_radius=rho, feature_reach=np.sqrt(((largest * scale) ** 2).sum(axis=1)), delta_phi=float(delta),
    )  # fmt: skip
    failed = _largest(mean, m, scale, rho) > _largest(y.mean(axis=1), m, scale, rho) + share * added
    return Coverage(delta, runs, int(failed.sum())).outcome("the true advantage is below the certified one")


def _largest(v: np.ndarray, m: np.ndarray, scale: np.ndarray, rho: np.ndarray) -> np.ndarray:
    return np.asarray((v * m).sum(axis=1) + rho * np.sqrt(((v * scale) ** 2).sum(axis=1)))
