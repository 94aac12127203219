"""The confidence set of the preference weights (audit R1) and the relation between data matrices (R9)."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

import bridge_theory as theory
from proofs_checks.context import Context
from proofs_checks.coverage import Coverage
from proofs_checks.outcome import Outcome, together

_DELTA = Fraction(1, 10)


def matrix_step(*, factor: int = 1) -> Outcome:
    """G >= V / kappa gives G^-1 V G^-1 <= kappa^2 V^-1; both are diagonal in one basis, so scalars decide."""
    from proofs_checks.smt import prove, reals

    g, v, kappa = reals("g v kappa")
    return prove(
        "one eigenvalue", [g > 0, v > 0, kappa > 0, kappa * g >= v], factor * v * v <= (kappa * g) * (kappa * g)
    )


def fourth_power(*, constant: int = 4) -> Outcome:
    """(1 + u)^4 >= 1 + 4u for u >= 0: B^2 in place of 4B^2 costs at most a factor 4 outside the logarithm."""
    import sympy

    from proofs_checks.smt import prove, reals
    from proofs_checks.symbolic import identity

    u = sympy.Symbol("u", nonnegative=True)
    (x,) = reals("u")
    rest = u**2 * (6 + 4 * u + u**2)
    return together(
        identity("(1+u)^4", (1 + u) ** 4 - 1 - constant * u, rest),
        prove("the rest is positive", [x >= 0], x * x * (6 + 4 * x + x * x) >= 0),
    )


def stated_is_wider(*, factor: int = 2) -> Outcome:
    r"""beta_t as stated is at least sqrt(2) times beta_t of R1 with the same kappa >= 4."""
    from proofs_checks.smt import prove, reals

    prior, root, noise, sharp, log_delta, growth, stated_growth = reals("p r s q L g G")
    return prove(
        "stated >= sqrt 2 sharp",
        [
            prior >= 0, root > 0, root * root <= Fraction(1, 4), noise >= 0, sharp >= 0, log_delta >= 0, growth >= 0,
            4 * stated_growth >= growth,  # by (1 + u)^4 >= 1 + 4u; both times d
            noise * noise == log_delta + 2 * stated_growth,
            4 * sharp * sharp == 2 * log_delta + growth,
        ],
        (prior + noise) * (prior + noise) >= factor * (prior * root + sharp) * (prior * root + sharp),
    )  # fmt: skip


def small_products(*, largest: str = "7/10") -> Outcome:
    """kappa_2 <= sqrt(2) kappa while BW <= 7/10."""
    from bridge_theory.arithmetic.flint_balls import ball
    from proofs_checks.balls import prove_positive

    def gap(x):  # type: ignore[no-untyped-def]
        return ball(2).sqrt() * (2 + 2 * x.cosh()) - (2 + 2 * (2 * x).cosh())

    return prove_positive("sqrt 2 kappa - kappa_2", gap, {"x": (0, Fraction(largest))})


def weights_are_covered(context: Context, *, scale: float = 1.0, nonnegative: bool = False) -> Outcome:
    """||g_t(w*) - s_t|| <= beta_t in the inverse data matrix, for all t, against adaptive comparisons."""
    runs, rounds, lam = context.pick(quick=300, full=2000), 60, 0.5
    B = 1 / np.sqrt(2) if nonnegative else 1.0  # half the largest difference of two features
    rng, kappa = context.rng(), float(theory.kappa_differences.estimate(B=B, W=1))
    w = _directions(rng, runs)
    matrix, deviation = np.tile(kappa * lam * np.eye(2), (runs, 1, 1)), -lam * w
    failed = np.zeros(runs, dtype=bool)
    for _ in range(rounds):
        inverse = np.linalg.inv(matrix)
        size = np.sqrt(np.einsum("ri,rij,rj->r", deviation, inverse, deviation))
        ratio = np.linalg.slogdet(matrix)[1] - 2 * np.log(kappa * lam)
        width = theory.beta_repaired_logdet.estimate(
            B=B, W=1, lam=lam, delta_w=float(_DELTA), log_det_ratio=np.maximum(ratio, 0)
        )
        failed |= size > scale * width
        x = _adaptive(inverse, deviation, rng)
        x = _of_nonnegative(x) if nonnegative else 2 * x
        mean = 1 / (1 + np.exp(-(x * w).sum(axis=1)))
        answer = rng.random(runs) < mean
        deviation = deviation + (answer - mean)[:, None] * x
        matrix = matrix + x[:, :, None] * x[:, None, :]
    return Coverage(_DELTA, runs, int(failed.sum())).outcome("w* in the confidence set in all rounds")


def ellipsoid_as_stated(context: Context, *, scale: float = 1.0) -> Outcome:
    """|w* - w_t| <= 2 kappa beta_t in the norm of V_t for all t, in one dimension and with the printed kappa."""
    runs, rounds, B, W, lam = context.pick(quick=300, full=2000), 80, 1.0, 2.0, 0.1
    rng, kappa = context.rng(), float(theory.kappa.estimate(B=B, W=W))
    x, total = 2 * B, np.zeros(runs)
    failed = np.zeros(runs, dtype=bool)
    mean = 1 / (1 + np.exp(-x * W))
    for t in range(1, rounds + 1):
        weight = _clipped_estimate(total, t - 1, x, lam, W)
        radius = theory.confidence_radius.estimate(B=B, W=W, lam=lam, d=1, t=t, delta=float(_DELTA))
        failed |= np.sqrt(kappa * lam + (t - 1) * x**2) * np.abs(W - weight) > scale * radius
        total += x * (rng.random(runs) < mean)
    return Coverage(_DELTA, runs, int(failed.sum())).outcome("w* in the printed ellipsoid in all rounds")


def _clipped_estimate(total: np.ndarray, rounds: int, x: float, lam: float, W: float) -> np.ndarray:
    """The projected maximum-likelihood weight by bisection: in one dimension, projecting is clipping."""
    low, high = np.full_like(total, -W), np.full_like(total, W)
    for _ in range(50):
        middle = (low + high) / 2
        above = rounds * x / (1 + np.exp(-x * middle)) + lam * middle > total
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return np.asarray((low + high) / 2)


def _directions(rng: np.random.Generator, runs: int) -> np.ndarray:
    angle = rng.random(runs) * 2 * np.pi
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _of_nonnegative(unit: np.ndarray) -> np.ndarray:
    """The longest difference of two vectors of norm at most 1 without negative coordinates, in each direction."""
    opposed = unit[:, 0] * unit[:, 1] < 0
    return np.where(opposed[:, None], unit / np.abs(unit).max(axis=1, keepdims=True), unit)


def _adaptive(inverse: np.ndarray, deviation: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A third of the runs compare along the deviation, a third where the matrix is smallest, a third anywhere."""
    runs = len(deviation)
    along = np.einsum("rij,rj->ri", inverse, deviation)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    weakest = np.linalg.eigh(inverse)[1][:, :, -1]
    choice = (np.arange(runs) % 3)[:, None]
    return np.where(choice == 0, along, np.where(choice == 1, weakest, _directions(rng, runs)))
