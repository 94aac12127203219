"""Distances between two finite laws, and maximum likelihood on one of them."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from bridge_theory.arithmetic.flint_balls import ball, working_precision
from bridge_theory.errors import InputError
from proofs_checks.counterexample import Number, evaluates
from proofs_checks.evaluators.offline_numbers import log, side
from proofs_checks.evaluators.online_numbers import enclosed
from proofs_checks.exact.laws import Row, row_hellinger, total_variation
from proofs_checks.exact.model import fractions_of, probability_row


def _laws(data: Mapping[str, Any]) -> tuple[Row, Row]:
    return probability_row(data["laws"]["P"]), probability_row(data["laws"]["Q"])


def _variation(p: Row, q: Row) -> Fraction:
    return total_variation(dict(enumerate(p)), dict(enumerate(q)))


@evaluates("offline-tv-against-hellinger")
def tv_against_hellinger(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """TV^2 and H^2."""
    p, q = _laws(data)
    return _variation(p, q) ** 2, side(row_hellinger(p, q))


@evaluates("offline-largest-gap")
def largest_gap(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """max |P - Q| and 2 TV."""
    p, q = _laws(data)
    return max(abs(a - b) for a, b in zip(p, q, strict=True)), 2 * _variation(p, q)


@evaluates("offline-certain-class")
def certain_class(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """H^2 of the only member of a class to itself, and 6 log(2 |G| / delta^{-1})/n + 2 log(1 + 0), as typeset."""
    (law,) = (probability_row(row) for row in data["laws"].values())
    with working_precision(128):
        bound = 6 * log(2 * len(data["laws"]) * Fraction(data["delta"])) / int(data["n"])
        return side(row_hellinger(law, law)), enclosed(bound)


@evaluates("offline-subset-class")
def subset_class(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """Class: the uniform laws on M-subsets of L outcomes. Two members that share every drawn outcome, and the bound.

    Every member that contains the n drawn outcomes maximises the likelihood, so the adversary may choose the one that
    shares exactly n outcomes with the truth. One law, uniform on all L outcomes, covers the class at eps = log(L/M).
    """
    size, outcomes, n = int(data["M"]), int(data["L"]), int(data["n"])
    if not (n <= size and 2 * size - n <= outcomes):
        raise InputError(f"no two {size}-subsets of {outcomes} outcomes share exactly {n}; expected 2 M - n <= L.")
    truth = (Fraction(1, size),) * size + (Fraction(0),) * (outcomes - size)
    other = (Fraction(1, size),) * n + (Fraction(0),) * (outcomes - size) + (Fraction(1, size),) * (size - n)
    with working_precision(128):
        bound = 6 * log(2 / Fraction(data["delta"])) / n + log(Fraction(outcomes, size))
        return side(row_hellinger(truth, other)), enclosed(bound)


@evaluates("offline-one-draw")
def one_draw(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """The smallest H^2 from the truth to the empirical law of one draw, and 4 S^2 A log(nH/delta)/n at n = H = 1."""
    truth = probability_row(data["laws"]["P^*"])
    points = [tuple(Fraction(i == k) for i in range(len(truth))) for k, p in enumerate(truth) if p]
    with working_precision(128):
        bound = 4 * len(truth) ** 2 * log(1 / Fraction(data["delta"]))
        return min((side(row_hellinger(truth, p)) for p in points), key=_lower), enclosed(bound)


def _lower(number: Number) -> Fraction:
    return number[0] if isinstance(number, tuple) else number


@evaluates("offline-union-step")
def union_step(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """2 A^S/delta and (A/delta)^S."""
    size, actions, delta = int(data["S"]), int(data["A"]), Fraction(data["delta"])
    return 2 * actions**size / delta, (actions / delta) ** size


@evaluates("offline-last-coordinate")
def last_coordinate(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """p_K/q_K and e^eps, where all other ratios p_i/q_i lie within e^{+-eps/2} as on the paper's grid."""
    p, q = _laws(data)
    with working_precision(128):
        half = ball(Fraction(data["epsilon"])) / 2
        if not all(abs(log(a / b)) <= half for a, b in zip(p[:-1], q[:-1], strict=True)):
            raise InputError("a ratio before the last lies outside e^{+-eps/2}; choose q on the grid.")
        return p[-1] / q[-1], enclosed((2 * half).exp())


@evaluates("offline-grid-size")
def grid_size(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """The proof's ceil(2 log(1/eps)/eps) + 1 grid points at delta = eps, and the lemma's 1/eps + 1."""
    eps = Fraction(data["epsilon"])
    with working_precision(128):
        points = (2 * log(1 / eps) / ball(eps)).ceil().unique_fmpz()
        return Fraction(int(points)) + 1, 1 / eps + 1


@evaluates("offline-scaled-radius")
def scaled_radius(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """sqrt(n) times the theorem's radius at the larger and at the smaller n."""
    gamma = Fraction(data["gamma_min"])
    with working_precision(128):
        return enclosed(_scaled(data, int(data["n_2"]), gamma)), enclosed(_scaled(data, int(data["n_1"]), gamma))


@evaluates("offline-hidden-visitation")
def hidden_visitation(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """The theorem's radius in two environments that give the same demonstrations with positive probability.

    The first state is fixed and known. The other one follows it with probability ``rare_1`` or ``rare_2``, which in two
    steps is also the smallest visitation probability; all n demonstrations stay in the first.
    """
    n, sides = int(data["n"]), []
    with working_precision(128):
        for rare in fractions_of((data["rare_1"], data["rare_2"])):
            if not (0 < rare <= Fraction(1, 2) and (1 - rare) ** n > 0):
                raise InputError(f"the rare state comes with probability {rare}; expected a number in (0, 1/2].")
            sides.append(enclosed(_scaled(data, n, rare) / ball(n).sqrt()))
    return sides[0], sides[1]


def _scaled(data: Mapping[str, Any], n: int, gamma: Fraction) -> Any:
    s, a, h, delta = int(data["S"]), int(data["A"]), int(data["H"]), Fraction(data["delta"])
    alpha = (4 * s * log(2 * a / delta)).sqrt()
    beta = (4 * s * s * a * log(2 * n * h / delta)).sqrt()
    return alpha + beta * (1 + (h * (1 + 2 * alpha / (ball(gamma) * ball(n).sqrt()))).sqrt())
