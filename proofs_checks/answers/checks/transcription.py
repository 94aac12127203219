"""The formulas about answers typed a second time from the companion's text, against bridge_theory.

This is no evidence for a statement, but for its transcription.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import exp, log, sqrt, tanh
from typing import Any

import bridge_theory
from proofs_checks.outcome import Outcome, Tally

_ROUNDING = 1e-10

POINTS: tuple[Mapping[str, Any], ...] = (
    {"loss": 3.5, "lam": 0.8, "weight_norm": 1.25, "log_det_growth": 4.5, "evidence_loss": 9.5, "scales": 3,
     "delta": 0.05, "W": 2.5, "d": 7, "t": 40, "B": 1.5, "margin": 2.25, "tangent": 1.5, "multiplier": 0.3,
     "slope": -1.25, "dual_norm": 0.4, "advantage": 0.7, "shortfall": 0.3, "slack": 5.5, "gradient_norm": 0.2,
     "reach": 1.75, "least_curvature": 2.5, "ridge": 0.6, "newton_norm": 1.2, "forecasters": 2, "rollouts": 50,
     "sample_variance": 0.3, "spread": 1.6, "candidates": 9, "delta_phi": 0.02, "error_norm": 0.15, "look": 4,
     "ellipsoid_radius": 3.5, "feature_reach": 0.9, "pairs": 6, "information": 0.15},
    {"loss": 0.5, "lam": 2.0, "weight_norm": 0.5, "log_det_growth": 0.25, "evidence_loss": 2.0, "scales": 1,
     "delta": 0.3, "W": 1.0, "d": 1, "t": 3, "B": 0.5, "margin": -3.0, "tangent": 0.0, "multiplier": 2.0,
     "slope": 0.75, "dual_norm": 1.4, "advantage": -0.7, "shortfall": 2.5, "slack": 0.5, "gradient_norm": 1.2,
     "reach": 0.5, "least_curvature": 0.5, "ridge": 0.0, "newton_norm": 0.2, "forecasters": 5, "rollouts": 2,
     "sample_variance": 0.0, "spread": 0.4, "candidates": 1, "delta_phi": 0.4, "error_norm": 2.0, "look": 1,
     "ellipsoid_radius": 0.5, "feature_reach": 2.0, "pairs": 1, "information": 3.0},
)  # fmt: skip


def _quadratic(margin: float, tangent: float) -> float:
    factor = tanh(tangent / 2) / (4 * tangent) if tangent else 1 / 8
    return log(1 / (1 + exp(-tangent))) + (margin - tangent) / 2 - factor * (margin**2 - tangent**2)


def _bernstein(rollouts: int, sample_variance: float, spread: float, level: float) -> float:
    return sqrt(2 * sample_variance * level / rollouts) + 7 * spread * level / (3 * (rollouts - 1))


ANSWERS: Mapping[str, Callable[..., float]] = {
    "evidence_loss_logdet": lambda loss, lam, weight_norm, log_det_growth: (
        -(-loss - lam / 2 * weight_norm**2 - log_det_growth / 2)
    ),
    "likelihood_threshold": lambda evidence_loss, scales, delta: evidence_loss + log(scales) + log(1 / delta),
    "likelihood_width_logdet": lambda W, lam, log_det_growth, scales, delta: (
        lam * W**2 / 2 + log_det_growth / 2 + log(scales / delta)
    ),
    "likelihood_width": lambda d, t, B, W, lam, scales, delta: (
        lam * W**2 / 2 + d / 2 * log(1 + t * (2 * B) ** 2 / 4 / (lam * d)) + log(scales / delta)
    ),
    "log_sigmoid_lower": _quadratic,
    "dual_certificate": lambda multiplier, loss, slope, evidence_loss, scales, W, dual_norm, delta: (
        multiplier * (-loss - slope + evidence_loss + log(scales / delta)) + W * dual_norm
    ),
    "certified_gap": lambda advantage: max(0.0, advantage),
    "share_gained": lambda shortfall: 1 / (1 + shortfall),
    "confinement_margin": lambda slack, gradient_norm, reach, least_curvature: (
        slack + gradient_norm * reach - reach**2 * least_curvature / 2
    ),
    "refutation_threshold": lambda forecasters, delta: log(forecasters / delta),
    "curvature_factor": lambda reach: 2 * (exp(-reach) + reach - 1) / reach**2,
    "ellipsoid_radius_squared": lambda slack, ridge, W, weight_norm, newton_norm: (
        2 * slack + ridge * (W**2 - weight_norm**2) + newton_norm**2
    ),
    "bernstein_radius": lambda rollouts, sample_variance, spread, d, candidates, delta_phi: _bernstein(
        rollouts, sample_variance, spread, log(4 * d * candidates / delta_phi)
    ),
    "rollout_gap": lambda W, error_norm: W * error_norm,
    "look_delta": lambda look, delta_phi: delta_phi / (look * (look + 1)),
    "fresh_rollout_gap": lambda rollouts, sample_variance, spread, ellipsoid_radius, feature_reach, delta_phi: (
        _bernstein(rollouts, sample_variance, spread, log(2 / (delta_phi / 2)))
        + ellipsoid_radius * feature_reach * (1 + sqrt(2 * log(2 / delta_phi))) / sqrt(rollouts)
    ),
    "preference_width": lambda t, pairs, delta: sqrt(log((t + 1) * pairs / delta) / (2 * t)),
    "fewest_answers": lambda information, delta: (
        (delta * log(delta / (1 - delta)) + (1 - delta) * log((1 - delta) / delta)) / information
    ),
}


def formulas(*, names: tuple[str, ...] = (), factor: float = 1.0) -> Outcome:
    """The named formulas agree with their text at both points; ``factor`` changes the text."""
    tally = Tally()
    for name in names:
        formula, text = getattr(bridge_theory, name), ANSWERS[name]
        for point in POINTS:
            values = {key: point[key] for key in formula.parameters}
            value, expected = float(formula.estimate(**values)), factor * text(**values)
            agree = abs(value - expected) <= _ROUNDING * max(abs(expected), 1e-9)
            tally.expect(bool(agree), f"{name} is {value!r}, its text says {expected!r}")
    return tally.outcome(f"{len(names)} formulas agree with a second transcription")
