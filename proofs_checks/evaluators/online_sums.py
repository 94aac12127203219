"""Sums and inequalities of the regret analysis, each evaluated from its definition."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from bridge_theory.arithmetic.flint_balls import ball, working_precision
from proofs_checks.counterexample import Number, evaluates
from proofs_checks.evaluators.online_numbers import alpha, beta, bonus_logarithm, enclosed, inverse_slope, numbers

_ONE = ball(1)


@evaluates("online-log-potential")
def log_potential(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """u and 2 log(1 + u), where u = D^2 / (kappa lambda) is the first squared norm of the potential."""
    u = Fraction(data["D"]) ** 2 / Fraction(data["kappa_lambda"])
    with working_precision(128):
        return u, enclosed(2 * (1 + ball(u)).log())


@evaluates("online-early-norm")
def early_norm(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """The norm of w* - w_t after ``silent`` rounds, and 4 kappa beta_t + alpha, on a path where both events hold.

    One dimension. In the silent rounds the feature difference is 0 or 2B with equal probability and 0 happens; then it
    is 2B for certain in ``loud`` rounds, with answers that keep their sum within 1 of its mean plus lambda W.
    """
    silent, loud = int(data["silent"]), int(data["loud"])
    with working_precision(128):
        B, W, lam, delta = numbers(data, "B W lambda delta")
        kappa, steep = inverse_slope(B * W), inverse_slope(2 * B * W)
        T, t = ball(silent + loud + 1), ball(silent + 1)
        start = kappa * lam
        expected = start + silent * B * B + 4 * B * B * loud
        observed = start + 4 * B * B * loud
        precision = expected <= 2 * observed + 84 * B * B * ((1 + 2 * T) / delta).log()
        # |g(w) - g(w*)| <= 2B + lambda W gives at most (2B + lambda W) sqrt(steep / lambda) in the norm of V_t
        least = 2 * kappa * beta(_ONE, B=B, W=W, lam=lam, d=_ONE, delta=delta, kappa=kappa)
        confident = (2 * B + lam * W) * (steep / lam).sqrt() <= least and start.sqrt() * W <= least
        if not (precision and confident):
            return Fraction(0), Fraction(0)
        bound = 4 * kappa * beta(t, B=B, W=W, lam=lam, d=_ONE, delta=delta, kappa=kappa)
        bound += alpha(T, B=B, W=W, d=_ONE, delta=delta)
        return enclosed(W * (start + silent * B * B).sqrt()), enclosed(bound)


@evaluates("online-drift-sum")
def drift_sum(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """sum over t <= T of t / (n (n + t)), and a constant times min(T / n, log T)."""
    n, T = int(data["n"]), int(data["T"])
    total = sum((ball(Fraction(t, n * (n + t))) for t in range(1, T + 1)), start=ball(0))
    return enclosed(total), enclosed(ball(Fraction(data["constant"])) * ball(Fraction(T, n)).min(ball(T).log()))


@evaluates("online-three-squares")
def three_squares(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """The squared difference of estimated features, and 2 (its drift of one policy)^2 + (its offline part)^2."""
    now_1, now_2, before_1, before_2 = (Fraction(data[name]) for name in ("now_1", "now_2", "before_1", "before_2"))
    drift = max(abs(now_1 - before_1), abs(now_2 - before_2))
    return (now_1 - now_2) ** 2, 2 * drift**2 + (before_1 - before_2) ** 2


@evaluates("online-offline-diameter")
def offline_diameter(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """Squared feature difference of two laws on {0, 1} with features +-B, and 4 R B^2, R the distance to a centre."""
    p, q, centre, B = (Fraction(data[name]) for name in ("p", "q", "centre", "B"))
    with working_precision(128):
        radius = max((_hellinger(p, centre), _hellinger(q, centre)), key=float)
        return (2 * B * (p - q)) ** 2, enclosed(4 * radius * ball(B) ** 2)


def _hellinger(p: Fraction, q: Fraction) -> Any:
    overlap = (ball(p) * ball(q)).sqrt() + (ball(1 - p) * ball(1 - q)).sqrt()
    return (1 - overlap).max(ball(0)).sqrt()


@evaluates("online-uncovered-bonuses")
def uncovered_bonuses(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """Squared bonuses on the first policy's trajectories in rounds 2 to T, and the bound of the bonus lemma.

    One state, A actions, constant features; the expert plays action 0, so gamma_min = S_reach = 1. The objective is the
    sum of the two bonuses, and an action without data has the largest possible one, 2 eta; A - 1 >= 2T such actions are
    enough for all rounds. All policies must be in the offline set: its radius must be at least 1.
    """
    n, T, horizon, actions = (int(data[name]) for name in ("n", "T", "H", "A"))
    with working_precision(128):
        eta, epsilon, delta = numbers(data, "eta epsilon delta")
        H, A, root = ball(horizon), ball(actions), ball(n).sqrt()
        a = (4 * (A * 2 / delta).log()).sqrt()
        b = (4 * A * (n * H * 2 / delta).log()).sqrt()
        radius = a / root + b / root * (1 + (H * (1 + 2 * a / root)).sqrt())
        if not (radius >= 1 and actions - 1 >= 2 * T):
            return Fraction(0), Fraction(0)
        squares = enclosed(4 * eta**2 * (T - 1) * (horizon - 1))
        if data["bound"] == "rate":
            rate = ball(T).log().min(ball(Fraction(T, n)))
            return squares, enclosed(ball(Fraction(data["constant"])) * eta**2 * H**2 * rate)
        log_term = bonus_logarithm(ball(horizon * T), S=_ONE, A=A, H=H, eta=eta, epsilon=epsilon, delta=delta)
        return squares, enclosed(32 * eta**2 * log_term * (1 + ball(Fraction(T, n))).log())


@evaluates("online-covered-bonuses")
def covered_bonuses(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """Bonuses in rounds 2 to T on one state with one action and n demonstrations, and the bound of the lemma."""
    n, T, horizon = (int(data[name]) for name in ("n", "T", "H"))
    with working_precision(128):
        B, W, epsilon, delta = numbers(data, "B W epsilon delta")
        H = ball(horizon)
        eta = 8 * H * W * B
        names = {"S": _ONE, "A": _ONE, "H": H, "eta": eta, "epsilon": epsilon, "delta": delta}
        total = ball(0)
        for t in range(2, T + 1):
            seen = ball((n + 2 * (t - 1)) * (horizon - 1))
            total += (horizon - 1) * (2 * eta).min(4 * eta * (bonus_logarithm(ball(t), **names) / seen).sqrt())
        bound = 64 * H * W * B * bonus_logarithm(H * T, **names).sqrt() * 2 * ball(Fraction(T, n)).sqrt()
        return enclosed(total), enclosed(bound)


@evaluates("online-decomposition")
def decomposition(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """Twice the regret of a round, and the sum into which the paper decomposes it (utilities, true and estimated)."""
    best, one, two = (Fraction(value) for value in data["true"])
    best_hat, one_hat, two_hat = (Fraction(value) for value in data["estimated"])
    left = (best - one) + (best - two)
    right = (best_hat - one_hat) + (best_hat - two_hat) + 2 * (best_hat - best) + (one_hat - one) + (two_hat - two)
    return left, right


@evaluates("online-simplified-rate")
def simplified_rate(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """The last part of Term 3 (H = W = B = S = A = 1), and a constant times the simplified rate."""
    with working_precision(128):
        n, T, gamma_min, constant = numbers(data, "n T gamma_min constant")
        rate = T.sqrt() * ((1 + T / n).log()).sqrt() + T.sqrt() / (n * gamma_min).sqrt()
        return enclosed(T.sqrt() / n.sqrt().sqrt()), enclosed(constant * rate)


@evaluates("online-dimension")
def dimension(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """sqrt(d log(1 + x / d)) in the larger and in the smaller dimension."""
    with working_precision(128):
        large, small, x = numbers(data, "d_large d_small x")
        return enclosed((large * (1 + x / large).log()).sqrt()), enclosed((small * (1 + x / small).log()).sqrt())
