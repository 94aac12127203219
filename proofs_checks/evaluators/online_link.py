"""The Bradley-Terry link: curvature, average preferences, the gradient of the likelihood."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from bridge_theory.arithmetic.flint_balls import ball, working_precision
from proofs_checks.counterexample import Number, evaluates
from proofs_checks.evaluators.online_numbers import enclosed, inverse_slope, numbers


@evaluates("online-curvature")
def curvature(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """1 / sigma' at the difference of two features, and kappa of single features."""
    with working_precision(128):
        first, second, w, B, W = numbers(data, "phi_1 phi_2 w B W")
        return enclosed(inverse_slope((first - second) * w)), enclosed(inverse_slope(B * W))


@evaluates("online-average-preference")
def average_preference(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """E sigma(X) and sigma(E X) for a utility difference X = log(odds) that takes each of its values equally often."""
    odds = [Fraction(value) for value in data["odds"]]
    average = sum((o / (1 + o) for o in odds), Fraction(0)) / len(odds)
    with working_precision(128):
        mean = sum((ball(o).log() for o in odds), start=ball(0)) / len(odds)
        return average, enclosed(1 / (1 + (-mean).exp()))


@evaluates("online-likelihood-gradient")
def likelihood_gradient(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """The gradient of a regulariser inside the sum over t - 1 rounds, and lambda w as in g_t (one dimension)."""
    rounds, lam, w = int(data["t"]) - 1, Fraction(data["lambda"]), Fraction(data["w"])
    return rounds * lam * w, lam * w
