"""The elliptical potential: how large a sum of squared data-matrix norms can be."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises

_VECTORS = ("every vector has norm at most L", "V_1 = v I and V_{t+1} = V_t + x_t x_t^T")
_MONOTONE = {
    "square_sum": rises("the logarithm rises"),
    "d": rises("d log(1 + c/d) rises in d for every c >= 0"),
    "v": falls("both L^2 / v and the logarithm fall"),
}


@bound(
    title="price of a large step in the elliptical potential",
    symbol=r"c(a)",
    source="audit R3",
    group="regret",
    status="sharp",
    words="every u up to L^2 / v is at most {value} times log(1+u)",
    monotone={"L": rises("a/log(1+a) rises"), "v": falls("a/log(1+a) rises in a = L^2/v")},
)
def potential_factor(m: Arithmetic, *, L: Value, v: Value) -> Value:
    r"""Statement: :math:`c(a)=a/\log(1+a)` with :math:`a=L^2/v`: the least c with :math:`u\le c\log(1+u)` on [0, a].

    Source: audit R3. It is at most 2 exactly for :math:`a\le2.51286...`; the paper takes 2 for all :math:`u\ge1`, which
    is false. Assumptions: none. Arguments: ``L >= 0`` (``c(0) = 1``), ``v`` > 0. Returns a number >= 1. Errors:
    ``InputError``.

    >>> round(float(potential_factor.estimate(L=1, v=1)), 4)
    1.4427
    """
    a = L**2 / v
    return m.if_at_most(a, m.number(0), lambda: m.number(1), lambda: a / m.log1p(a))


@bound(
    title="elliptical potential",
    symbol=r"\textstyle\sum_t\|x_t\|^2_{V_t^{-1}}",
    source="audit R3",
    group="regret",
    status="sharp",
    words="the squared data-matrix norms sum to at most {value}",
    assumptions=_VECTORS,
    monotone={**_MONOTONE, "L": rises("c(L^2 / v) rises")},
)
def elliptical_potential(m: Arithmetic, *, L: Value, v: Value, d: Value, square_sum: Value) -> Value:
    r"""Statement: :math:`\sum_{t\le T}\|x_t\|^2_{V_t^{-1}}\le c(L^2/v)\,d\log(1+\tfrac1{dv}\sum_t\|x_t\|_2^2)`.

    Source: audit R3 (equality is attained for T = d = 1). Assumptions: norms at most ``L``; :math:`V_1=vI`. Arguments:
    ``L`` >= 0, ``v`` > 0, ``d`` a positive integer, ``square_sum`` = :math:`\sum_t\|x_t\|_2^2` >= 0, at most
    :math:`TL^2`. Returns a number without unit. Errors: ``InputError``.

    >>> round(float(elliptical_potential.estimate(L=1, v=1, d=1, square_sum=1)), 12)
    1.0
    """
    a, growth = L**2 / v, square_sum / (d * v)
    return m.if_at_most(a, m.number(0), lambda: d * m.log1p(growth), lambda: a * d * m.log1p_ratio(growth, a))


@bound(
    title="elliptical potential, terms capped at 1",
    symbol=r"\textstyle\sum_t\min(1,\|x_t\|^2_{V_t^{-1}})",
    source="audit R3",
    group="regret",
    status="sharp",
    words="the squared data-matrix norms, each capped at 1, sum to at most {value}",
    assumptions=_VECTORS[1:],
    monotone=_MONOTONE,
)
def elliptical_potential_capped(m: Arithmetic, *, v: Value, d: Value, square_sum: Value) -> Value:
    r"""Statement: :math:`\sum_t\min(1,\|x_t\|^2_{V_t^{-1}})\le\tfrac1{\log2}d\log(1+\tfrac1{dv}\sum_t\|x_t\|_2^2)`.

    Source: audit R3. Assumptions: :math:`V_1=vI`; no bound on the norms. Arguments: ``v`` > 0, ``d`` a positive
    integer, ``square_sum`` >= 0. Returns a number without unit. Errors: ``InputError``.

    >>> float(elliptical_potential_capped.estimate(v=1, d=1, square_sum=1))
    1.0
    """
    return d * m.log1p_ratio(square_sum / (d * v), m.number(1))


@bound(
    title="sum of data-matrix norms",
    symbol=r"\textstyle\sum_t\|x_t\|_{V_t^{-1}}",
    source="audit R3",
    group="regret",
    status="sharp",
    words="the data-matrix norms sum to at most {value}",
    assumptions=_VECTORS,
    monotone={**_MONOTONE, "L": rises("c(L^2 / v) rises"), "T": rises("it is under the root")},
)
def elliptical_norm_sum(m: Arithmetic, *, L: Value, v: Value, d: Value, T: Value, square_sum: Value) -> Value:
    r"""Statement: :math:`\sum_{t\le T}\|x_t\|_{V_t^{-1}}\le\sqrt{T\,c(L^2/v)\,d\log(1+\tfrac1{dv}\sum_t\|x_t\|_2^2)}`.

    Source: audit R3 with Cauchy-Schwarz; the factor ``sqrt(T)`` is what ``lemma:feature_diff_bound`` loses.
    Assumptions: as ``elliptical_potential``. Arguments: as there, and ``T`` a positive integer. Returns a number
    without unit. Errors: as there.

    >>> float(elliptical_norm_sum.estimate(L=1, v=1, d=1, T=1, square_sum=1))
    1.0
    """
    return m.sqrt(T * elliptical_potential(m, L=L, v=v, d=d, square_sum=square_sum))
