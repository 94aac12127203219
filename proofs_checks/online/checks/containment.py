"""Containment of the best policy (R2) and regret from it (R4): implications between real numbers, decided by Z3."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from proofs_checks.outcome import Outcome, together


def containment(*, bonuses: int = 1) -> Outcome:
    """The best policy's optimistic advantage over any other is at least 0, with known and with unknown dynamics."""
    from proofs_checks.smt import prove, reals

    gap, estimate, radius, norm, hat, b_best, b_other = reals("gap estimate radius norm hat b_best b_other")
    sizes = [gap >= 0, radius >= 0, norm >= 0]
    near = _within(hat - estimate, radius * norm)
    known = prove("known dynamics", [*sizes, *near, hat == gap], estimate + bonuses * radius * norm >= 0)
    errors = [b_best >= 0, b_other >= 0, *_within(gap - hat, b_best + b_other)]
    unknown = prove(
        "unknown dynamics",
        [*sizes, *near, *errors],
        estimate + radius * norm + bonuses * (b_best + b_other) >= 0,
    )
    return together(known, unknown)


def regret_from_width(*, factor: Fraction | int = 2, paper_sign: bool = False) -> Outcome:
    """r_t <= 2 O_t(pi^1, pi^2) for the arg-max pair, by the constraint of pi_i (the paper uses the one of pi*)."""
    from proofs_checks.smt import prove, reals

    gaps, estimates, widths = reals("gap_1 gap_2"), reals("estimate_1 estimate_2"), reals("width_1 width_2")
    (widest,) = reals("widest")
    hypotheses: list[Any] = []
    for gap, estimate, width in zip(gaps, estimates, widths, strict=True):
        member = estimate + width >= 0 if paper_sign else width - estimate >= 0
        hypotheses += [gap >= 0, width >= 0, width <= widest, gap <= estimate + width, member]
    return prove("r_t <= 2 O_t", hypotheses, (gaps[0] + gaps[1]) / 2 <= factor * widest)


def regret_with_bonuses(*, norm_factor: int = 4, bonus_factor: int = 4) -> Outcome:
    """2 r_t <= 4 gamma_t ||.|| + 4 (B_1 + B_2) for the arg-max pair, bonuses at eta = 2WB."""
    from proofs_checks.smt import prove, reals

    gamma, norm, one, two, best = reals("gamma norm B_1 B_2 B_best")
    norms, gaps, estimates = reals("norm_1 norm_2"), reals("gap_1 gap_2"), reals("estimate_1 estimate_2")
    pair = gamma * norm + one + two
    hypotheses: list[Any] = [gamma >= 0, norm >= 0, one >= 0, two >= 0, best >= 0]
    for gap, estimate, size, bonus in zip(gaps, estimates, norms, (one, two), strict=True):
        width = gamma * size + best + bonus
        hypotheses += [size >= 0, width <= pair, gap <= estimate + width, estimate <= width]
    bound = norm_factor * gamma * norm + bonus_factor * (one + two)
    return prove("2 r_t with bonuses", hypotheses, gaps[0] + gaps[1] <= bound, seconds=20)


def refined_width(*, factor: int = 2) -> Outcome:
    """U_t(pi, pi_i) <= 2 O_t(pi, pi_i) for pi_i in Pi_t, so that the optimistic bound is at most the width bound."""
    from proofs_checks.smt import prove, reals

    estimate, width, bonus = reals("estimate width bonus")
    members = [width >= 0, bonus >= 0, estimate <= width + bonus]
    return prove("U <= 2 O", members, estimate + width + bonus <= factor * (width + bonus))


def squared_bonus(*, constant: int = 48) -> Outcome:
    """B_hat^2 <= 4 B^2 + 48 epsilon H^2 WB from B_hat <= 2B + epsilon, B <= 8 H^2 WB and B_hat <= 4 H^2 WB."""
    from proofs_checks.smt import prove, reals

    empirical, true, epsilon, q = reals("empirical true epsilon q")
    hypotheses = [
        q > 0, epsilon > 0, empirical >= 0, true >= 0, true <= 8 * q, empirical <= 4 * q,
        empirical <= 2 * true + epsilon,
    ]  # fmt: skip
    return prove("squared bonus", hypotheses, empirical * empirical <= 4 * true * true + constant * epsilon * q)


def cauchy_schwarz(*, exponent: int = 2) -> Outcome:
    """(sum a)^2 <= T sum a^2 by induction on T: equality for one round, and S^2 <= T Q gives (S+a)^2 <= (T+1)(Q+a^2).

    Without the squares it fails as soon as the sum exceeds T.
    """
    from proofs_checks.smt import prove, reals

    a, rounds, total, squares = reals("a T S Q")
    power = a * a if exponent == 2 else a
    before = [a >= 0, rounds >= 1, total >= 0, squares >= 0, total * total <= rounds * squares]
    return together(
        prove("one round", [a >= 0], a * a <= power),
        prove("one round more", before, (total + a) * (total + a) <= (rounds + 1) * (squares + power)),
    )


def _within(difference: Any, size: Any) -> list[Any]:
    return [difference <= size, -difference <= size]
