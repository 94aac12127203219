"""The paper's transition bonus: its per-cell term xi, the uniform xi-bar, and their sums over an occupancy."""

from __future__ import annotations

from typing import Any

import numpy as np

from bridge_theory.core import Arithmetic, Value, bound, falls, requires, rises, undefined_unless

REAL_TRANSITIONS = (
    "transitions come from the real, stationary environment, independently given the past",
    "the function is smaller than eta in absolute value",
)
_FIXED = (*REAL_TRANSITIONS, "one fixed policy and one fixed, non-random function")
_SEEN_TWICE = undefined_unless(lambda N: N >= 2, "log N is 0 or minus infinity for N < 2", repaired="bonus_radius")
_ALL_SEEN_TWICE = undefined_unless(
    lambda counts: np.min(counts) >= 2, "log N is 0 or minus infinity for N < 2", repaired="transition_bonus"
)
_COUNT_FALLS = falls("(c + log log N)/N falls on the integers N >= 2 for every c > log 6")


def one_count_per_cell(occupancy: Any, counts: Any) -> bool:
    """Whether the two tables have the same number of cells."""
    return np.size(occupancy) == np.size(counts)


SAME_CELLS = requires(one_count_per_cell, "one count for each cell of the occupancy")


@bound(
    title="per-cell bonus, as stated",
    symbol=r"\xi_{s,a}(\eta,\delta)",
    source="lemma:moment_transition_difference_error",
    group="online",
    status="stated",
    trivial=lambda m, eta: 2 * eta,
    spends=("delta",),
    words="each use of this cell adds {value} to the bonus",
    assumptions=_FIXED,
    conditions=(_SEEN_TWICE,),
    monotone={
        "N": _COUNT_FALLS,
        "eta": rises("it multiplies"),
        "S": rises("log rises"),
        "A": rises("log rises"),
        "H": rises("it multiplies log(SA) >= 0"),
        "delta": falls("log(1/delta) falls"),
    },
)
def xi(m: Arithmetic, *, S: Value, A: Value, H: Value, eta: Value, delta: Value, N: Value) -> Value:
    r"""Statement: with ``N`` offline and online transitions out of the cell,

    .. math:: \xi_{s,a}(\eta,\delta)=\min\Bigl(2\eta,4\eta\sqrt{\tfrac{H\log(|S||A|)+\log(6\log N/\delta)}{N}}\Bigr).

    Source: ``lemma:moment_transition_difference_error``. Assumptions: transitions of the real stationary environment;
    one fixed policy and one fixed function. Arguments: ``S, A, H`` positive integers, ``eta`` > 0, ``delta`` in (0, 1),
    ``N`` an integer >= 2. Returns a number in the units of ``eta``. Errors: ``InputError``; ``UndefinedInPaperError``
    for ``N`` = 0 and 1.

    >>> round(float(xi.estimate(S=5, A=4, H=8, eta=1, delta=0.05, N=1000)), 4)
    0.7007
    """
    return _capped(m, eta=eta, N=N, log_term=H * m.log(S * A) + _iterated_log(m, N=N, delta=delta))


@bound(
    title="per-cell bonus, uniform over policies, as stated",
    symbol=r"\overline\xi_{s,a}(\eta,\delta,\varepsilon)",
    source="lemma:moment_transition_difference_error_uniform",
    group="online",
    status="stated",
    trivial=lambda m, eta: 2 * eta,
    spends=("delta",),
    words="each use of this cell adds {value} to the bonus that holds for every policy",
    assumptions=REAL_TRANSITIONS,
    conditions=(_SEEN_TWICE,),
    monotone={
        "N": _COUNT_FALLS,
        "eta": rises("it multiplies, and the ceiling rises"),
        "S": rises("log(SA) and the ceiling's factor rise"),
        "A": rises("log rises"),
        "H": rises("both logarithms rise"),
        "delta": falls("log(1/delta) falls"),
        "epsilon": falls("the ceiling falls"),
    },
)
def xi_bar(m: Arithmetic, *, S: Value, A: Value, H: Value, eta: Value, delta: Value, epsilon: Value, N: Value) -> Value:
    r"""Statement: ``xi`` with :math:`|S|\log\lceil4\eta H/\varepsilon\rceil` added under the root,

    .. math:: \overline\xi_{s,a}=\min\Bigl(2\eta,4\eta\sqrt{\tfrac{H\log(|S||A|)+|S|\log\lceil4\eta H/\varepsilon\rceil
       +\log(6\log N/\delta)}{N}}\Bigr).

    Source: ``lemma:moment_transition_difference_error_uniform``. Assumptions: real stationary transitions; uniform over
    policies and, through the cover of value functions, over random functions too (audit C.9). Arguments: as ``xi``,
    and ``epsilon`` > 0. Returns a number in the units of ``eta``. Errors: as ``xi``.

    >>> round(float(xi_bar.estimate(S=5, A=4, H=8, eta=1, delta=0.05, epsilon=0.1, N=1000)), 4)
    0.9759
    """
    log_term = uniform_log_term(m, S=S, A=A, H=H, eta=eta, epsilon=epsilon) + _iterated_log(m, N=N, delta=delta)
    return _capped(m, eta=eta, N=N, log_term=log_term)


@bound(
    title="per-cell bonus, defined for every count",
    symbol=r"\xi_{s,a}(\eta,\delta)",
    source="audit C.8",
    group="online",
    status="repaired",
    trivial=lambda m, eta: 2 * eta,
    spends=("delta",),
    words="each use of this cell adds {value} to the bonus",
    assumptions=_FIXED,
    monotone={
        "N": falls("it is at most 2 eta, and (c + log log N)/N falls on the integers N >= 2 for every c > log 6"),
        "eta": rises("it multiplies"),
        "S": rises("log rises"),
        "A": rises("log rises"),
        "H": rises("it multiplies log(SA) >= 0"),
        "delta": falls("log(1/delta) falls"),
    },
)
def xi_repaired(m: Arithmetic, *, S: Value, A: Value, H: Value, eta: Value, delta: Value, N: Value) -> Value:
    r"""Statement: ``xi`` for :math:`N\ge2` and :math:`2\eta` for :math:`N\le1`, where the data say nothing.

    Source: audit C.8 (Howard et al.'s stitched bound leaves a factor above 5 for all N >= 2). Assumptions and
    arguments: as ``xi``, with ``N`` any count. Returns a number in the units of ``eta``. Errors: ``InputError``.

    >>> float(xi_repaired.estimate(S=5, A=4, H=8, eta=1, delta=0.05, N=0))
    2.0
    """
    return m.if_at_most(N, m.number(1), lambda: 2 * eta, lambda: xi(m, S=S, A=A, H=H, eta=eta, delta=delta, N=N))


@bound(
    title="empirical bonus of a policy, as stated",
    symbol=r"\widehat B_t(\pi,\eta,\delta)",
    source="lemma:moment_transition_difference_error",
    group="online",
    status="stated",
    trivial=lambda m, eta: 2 * eta,
    spends=("delta",),
    words="the true expectation exceeds the estimated one by at most {value}",
    assumptions=_FIXED,
    conditions=(SAME_CELLS, _ALL_SEEN_TWICE),
    monotone={
        "eta": rises("xi rises"),
        "S": rises("xi rises"),
        "A": rises("xi rises"),
        "H": rises("xi rises at a fixed occupancy"),
        "delta": falls("xi falls"),
    },
)
def empirical_bonus(
    m: Arithmetic, *, S: Value, A: Value, H: Value, eta: Value, delta: Value, occupancy: Value, counts: Value
) -> Value:
    r"""Statement: :math:`\widehat B_t(\pi,\eta,\delta)=E_{\hat P_t^\pi}\sum_h\xi_{s_h,a_h}(\eta,\delta)`.

    Source: ``lemma:moment_transition_difference_error``. Assumptions: as ``xi``. Arguments: as ``xi``; ``occupancy``
    the expected number of uses of each cell under the estimated dynamics, any shape, cells that are never used left
    out; ``counts`` the transitions seen out of each cell, same shape. Returns a number in the units of ``eta``.
    Errors: ``InputError``; ``UndefinedInPaperError`` if a cell has fewer than two counts.

    >>> bonus = empirical_bonus.estimate(S=5, A=4, H=8, eta=1, delta=0.05, occupancy=[7, 1], counts=[1000, 400])
    >>> round(float(bonus), 3)
    6.01
    """
    return m.sum(lambda q, N: q * xi(m, S=S, A=A, H=H, eta=eta, delta=delta, N=N), occupancy, counts)


@bound(
    title="true bonus of a policy, as stated",
    symbol=r"B_t(\pi,\eta,\delta,\varepsilon)",
    source="lemma:moment_transition_difference_error_uniform",
    group="online",
    status="stated",
    trivial=lambda m, eta: 2 * eta,
    spends=("delta",),
    words="the estimated expectation exceeds the true one by at most {value} + epsilon, for every policy",
    assumptions=REAL_TRANSITIONS,
    conditions=(SAME_CELLS, _ALL_SEEN_TWICE),
    monotone={
        "eta": rises("xi-bar rises"),
        "S": rises("xi-bar rises"),
        "A": rises("xi-bar rises"),
        "H": rises("xi-bar rises at a fixed occupancy"),
        "delta": falls("xi-bar falls"),
        "epsilon": falls("xi-bar falls"),
    },
)
def expected_bonus(
    m: Arithmetic, *, S: Value, A: Value, H: Value, eta: Value, delta: Value, epsilon: Value, occupancy: Value,
    counts: Value,
) -> Value:  # fmt: skip
    r"""Statement: :math:`B_t(\pi,\eta,\delta,\varepsilon)=E_{P_*^\pi}\sum_h\overline\xi_{s_h,a_h}`; the error of

    the estimated expectation is at most :math:`B_t+\varepsilon`, simultaneously for all policies and rounds.

    Source: ``lemma:moment_transition_difference_error_uniform``. Assumptions: as ``xi_bar``. Arguments: as
    ``empirical_bonus``, with the ``occupancy`` under the true dynamics, and ``epsilon`` > 0. Returns a number in the
    units of ``eta``. Errors: as ``empirical_bonus``.

    >>> bonus = expected_bonus.estimate(
    ...     S=5, A=4, H=8, eta=1, delta=0.05, epsilon=0.1, occupancy=[7, 1], counts=[1000, 400])
    >>> round(float(bonus), 3)
    8.373
    """
    return m.sum(
        lambda q, N: q * xi_bar(m, S=S, A=A, H=H, eta=eta, delta=delta, epsilon=epsilon, N=N), occupancy, counts
    )


def uniform_log_term(m: Arithmetic, *, S: Value, A: Value, H: Value, eta: Value, epsilon: Value) -> Value:
    r""":math:`H\log(|S||A|)+|S|\log\lceil4\eta H/\varepsilon\rceil`: histories and a cover of value functions.

    >>> from bridge_theory.arithmetic.floats import FLOATS
    >>> round(float(uniform_log_term(FLOATS, S=1, A=1, H=1, eta=1.0, epsilon=0.5)), 3)
    2.079
    """
    return H * m.log(S * A) + S * m.log(m.ceil(4 * eta * H / epsilon))


def _iterated_log(m: Arithmetic, *, N: Value, delta: Value) -> Value:
    return m.log(6 * m.log(N) / delta)


def _capped(m: Arithmetic, *, eta: Value, N: Value, log_term: Value) -> Value:
    return m.min(2 * eta, 4 * eta * m.sqrt(log_term / N))
