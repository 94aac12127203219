r"""BRIDGE with known dynamics on one state and two actions, replayed from its description.

One state, H = 1, actions + and - with features +B and -B, w* = W > 0, expert +. As long as both policies are in
Pi_t, the arg-max pair of a round is (+, -), whatever the preferences were: the pair's feature difference is 2B, the
round's regret is BW, and the data matrix grows by 4B^2. Both policies are in Pi_t as long as
gamma_t 2B / sqrt(kappa lambda + 4 B^2 (t - 1)) >= 2BW, whatever projection |w| <= W was chosen.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from bridge_theory.arithmetic.flint_balls import Ball, ball, working_precision
from proofs_checks.counterexample import Number, evaluates
from proofs_checks.evaluators.online_numbers import alpha, beta, enclosed, inverse_slope, numbers, offline_logarithm

_ONE, _TWO = ball(1), ball(2)


@evaluates("online-two-policies")
def two_policies(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """The quantity ``data["quantity"]`` of the replay, and the paper's bound on it times ``data["constant"]``."""
    with working_precision(128):
        rounds = int(data["T"])
        B, W, lam, delta, n, constant = numbers(data, "B W lambda delta n constant")
        kappa, T = inverse_slope(B * W), ball(rounds)
        common = {"B": B, "lam": lam, "d": _ONE, "delta": delta}
        log_term = offline_logarithm(T, S=_ONE, A=_TWO, n=n, **common)
        width = alpha(T, B=B, W=W, d=_ONE, delta=delta)
        # with unknown dynamics the bonuses enter the arg-max too; they differ by at most 2 eta = 4BW
        margin = 2 if data["quantity"] == "term 2" else 1
        plays = 6 * (2 / delta).log() / n >= 1 and _both_stay(rounds, margin, data, kappa, width)
        if not plays:  # the replay is not decided by the description alone: nothing is claimed
            return Fraction(0), enclosed(constant)
        start = kappa * lam
        low = (start + 4 * B * B * T).sqrt() - start.sqrt()
        norms = (low / B).union(low / B + 2 * B / start.sqrt())
        scale = (W * (kappa * B).sqrt() + W * B) * (T * B / (kappa * delta)).log()
        drift = (T / n).min(T.log()) * B * B + T * B * B * _TWO.sqrt() / n.sqrt()
        sides: dict[str, tuple[Ball, Ball]] = {
            "norm sum": (norms, (2 * log_term).sqrt()),
            "regret": (
                B * W * T,
                (2 * kappa * beta(T, W=W, kappa=kappa, **common) + width) * (2 * log_term).sqrt(),
            ),
            "small horizon": (B * W * T, scale * (T / n).sqrt()),
            "transition": (B * W * T, scale),
            "rate": (B * W * T, scale * (1 + T / n).log().sqrt()),
            "large horizon": (B * W * T, scale * T.log().sqrt()),
            "term 2": ((T * norms).sqrt(), (T * (1 + 10**6 * drift).log()).sqrt()),
        }
        left, right = sides[data["quantity"]]
        return enclosed(left), enclosed(constant * right)


def _both_stay(rounds: int, margin: int, data: Mapping[str, Any], kappa: Ball, width: Ball) -> bool:
    """Whether both policies are certainly in Pi_t for all t up to ``rounds``; gamma_t rises, so blocks are enough."""
    B, W, lam, delta = numbers(data, "B W lambda delta")
    first = 1
    while first <= rounds:
        gamma = 4 * kappa * beta(ball(first), B=B, W=W, lam=lam, d=_ONE, delta=delta, kappa=kappa) + width
        last = min(rounds, first + first // 8)
        if not gamma >= margin * W * (kappa * lam + 4 * B * B * (last - 1)).sqrt():
            return False
        first = last + 1
    return True
