"""Logarithms of covering numbers of tabular transition kernels, in the paper's one-sided log sense."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, requires, rises

_WORDS = "the logarithm of the covering number is at most {value}"
_COVERED = "rows counts the rows of a kernel that are covered (S A for the whole kernel)"
_FINER = falls("a coarser cover needs fewer elements")
_ROWS = rises("every row needs its own cover")


@bound(
    title="covering number of transition kernels",
    symbol=r"\log\mathcal{N}_{trans}",
    source="lem:transition_covering_number_stationary_tabular_stochastic_transitions",
    group="offline",
    status="stated",
    words=_WORDS,
    monotone={"S": _ROWS, "A": _ROWS, "epsilon": _FINER},
)
def transition_log_covering_stated(m: Arithmetic, *, S: Value, A: Value, epsilon: Value) -> Value:
    r"""Statement: :math:`\log\mathcal N_{trans}(\mathcal P,\varepsilon)\le|S||A|(|S|-1)\log(1/\varepsilon+1)`.

    Source: ``lem:transition_covering_number_stationary_tabular_stochastic_transitions``; true for two states, false for
    three or more at small ``epsilon`` (audit O11). Assumptions: none. Arguments: ``S, A`` positive integers,
    ``epsilon`` > 0. Returns nats. Errors: ``InputError`` outside the domain.

    >>> round(float(transition_log_covering_stated.estimate(S=2, A=1, epsilon=1)), 4)
    1.3863
    """
    return S * A * (S - 1) * m.log1p(1 / epsilon)


@bound(
    title="covering number of transition kernels, lattice cover",
    symbol=r"\log\mathcal{N}_{trans}",
    source="audit T11",
    group="offline",
    status="repaired",
    words=_WORDS,
    assumptions=(_COVERED,),
    monotone={"S": _ROWS, "rows": _ROWS, "epsilon": _FINER},
)
def transition_log_covering_repaired(m: Arithmetic, *, S: Value, rows: Value, epsilon: Value) -> Value:
    r"""Statement: :math:`\log\mathcal N_{trans}(\varepsilon)\le\mathrm{rows}\cdot\log\binom{m+2|S|-2}{|S|-1}` with
    :math:`m=\lceil(|S|-1)/(e^\varepsilon-1)\rceil`.

    Source: audit T11, by distributions with denominator ``m + S - 1``. Assumptions: none. Arguments: ``S, rows``
    positive integers (``rows = S A`` for the whole kernel), ``epsilon`` > 0. Returns nats. Errors: ``InputError``.

    >>> round(float(transition_log_covering_repaired.estimate(S=2, rows=1, epsilon=1)), 4)
    1.0986
    """
    denominator = m.max(1, m.ceil((S - 1) / m.expm1(epsilon)))  # the float quotient may underflow to 0
    return rows * m.log_binomial(denominator + 2 * S - 2, S - 1)


@bound(
    title="covering number of transition kernels, closed form",
    symbol=r"\log\mathcal{N}_{trans}",
    source="audit T11",
    group="offline",
    status="repaired",
    words=_WORDS,
    assumptions=(_COVERED,),
    monotone={"S": _ROWS, "rows": _ROWS, "epsilon": _FINER},
)
def transition_log_covering_closed_form(m: Arithmetic, *, S: Value, rows: Value, epsilon: Value) -> Value:
    r"""Statement: :math:`\log\mathcal
    N_{trans}(\varepsilon)\le\mathrm{rows}(|S|-1)\log\bigl(e(1/(e^\varepsilon-1)+3)\bigr)`.

    Source: audit T11. Assumptions: none. Arguments: ``S, rows`` positive integers, ``epsilon`` > 0. Returns nats.
    Errors: ``InputError`` outside the domain.

    >>> round(float(transition_log_covering_closed_form.estimate(S=2, rows=1, epsilon=1)), 4)
    2.2759
    """
    return rows * (S - 1) * (1 + m.log(1 / m.expm1(epsilon) + 3))


@bound(
    title="covering number of transition kernels on two states",
    symbol=r"\log\mathcal{N}_{trans}",
    source="audit T11",
    group="offline",
    status="sharp",
    words=_WORDS,
    assumptions=(_COVERED,),
    conditions=(requires(lambda S: S == 2, "exactly two states"),),
    monotone={"rows": _ROWS, "epsilon": _FINER},
)
def transition_log_covering_two_states(m: Arithmetic, *, S: Value, rows: Value, epsilon: Value) -> Value:
    r"""Statement: for :math:`|S|=2`, :math:`\log\mathcal N_{trans}(\varepsilon)=\mathrm{rows}\cdot\log\lceil
    1/(e^\varepsilon-1)\rceil`.

    Source: audit T11, an equality for one row. Assumptions: two states. Arguments: ``S = 2``, ``rows`` positive
    integer, ``epsilon`` > 0. Returns nats. Errors: ``InputError`` unless ``S`` is 2.

    >>> round(float(transition_log_covering_two_states.estimate(S=2, rows=3, epsilon=0.25)), 4)
    4.1589
    """
    return rows * m.log(m.max(1, m.ceil((S - 1) / m.expm1(epsilon))))
