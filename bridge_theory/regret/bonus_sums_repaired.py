"""What the transition bonuses sum to over T rounds, proved on the coverage event, and their martingale part."""

from __future__ import annotations

from collections.abc import Callable

from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total
from bridge_theory.online.coverage import VISITS, coverage_failure, covered_bonus

_COVERED = (
    *VISITS,
    "every pair of the expert has at least n gamma_min / 2 recorded transitions (see coverage_failure)",
    "log_covering bounds the logarithmic term of every bonus used",
    "one comparison a round; counts are frozen within a round",
)
_SUM_MONOTONE = {
    "H": rises("more transitions"),
    "eta": rises("it multiplies"),
    "log_covering": rises("it multiplies, or is under the root"),
    "T": rises("more transitions"),
}


def _when_batches_exceed_counts(
    m: Arithmetic, *, H: Value, n: Value, gamma_min: Value, cost: Callable[[], Value]
) -> Value:
    # a pair with fewer offline counts than the 2(H-1) visits of one round pays once for its first visits
    return m.if_at_most(4 * (H - 1), n * gamma_min, lambda: m.number(0), cost)


@bound(
    title="sum of the squared bonuses",
    symbol=r"\textstyle\sum_{t,i,h}\xi^2",
    source="audit D.3",
    group="regret",
    status="repaired",
    trivial=lambda m, eta, T, H: 8 * eta**2 * T * (H - 1),
    words="the squared bonuses on both policies' trajectories sum to at most {value}",
    assumptions=_COVERED,
    monotone={
        **_SUM_MONOTONE,
        "n": falls("the logarithm falls and the first visits are covered"),
        "gamma_min": falls("the logarithm falls and the first visits are covered"),
        "S_reach": rises("x log(1 + c/x) rises in x"),
        "uncovered": rises("x log(1 + c/x) rises in x"),
    },
)
def squared_bonus_sum_repaired(
    m: Arithmetic, *, H: Value, eta: Value, log_covering: Value, n: Value, T: Value, gamma_min: Value, S_reach: Value,
    uncovered: Value,
) -> Value:  # fmt: skip
    r"""Statement: on the coverage event, with m = 2(H-1), M = 2T(H-1) and u pairs off the expert's used online,

    .. math:: \sum_{t\le T}\sum_i\sum_{h<H}\xi^2\le32\eta^2U|S_{reach}|\log\Bigl(1+\tfrac{2M}{|S_{reach}|n\gamma_{\min}}
       \Bigr)+32\eta^2Uu\log(1+M/u)+8\eta^2m\bigl(u+|S_{reach}|1\{n\gamma_{\min}/2<m\}\bigr).

    Source: audit D.3 with log's concavity over pairs. Pathwise given coverage. Assumptions: minimum visitation, the
    event of ``coverage_failure``. Arguments: ``H, n, T, S_reach`` positive integers, ``eta`` > 0, ``log_covering`` = U
    >= 0, ``gamma_min`` in (0, 1], ``uncovered`` = u a count (at most S A - S_reach). Returns a number in the units of
    ``eta`` squared. Errors: ``InputError``.

    >>> setting = dict(H=8, eta=1, log_covering=50, n=10**5, gamma_min=0.1, S_reach=5)
    >>> round(float(squared_bonus_sum_repaired.estimate(T=100, uncovered=0, **setting)), 1)
    435.9
    """
    visits = 2 * T * (H - 1)
    most = m.max(uncovered, m.number(1))
    first = 16 * eta**2 * (H - 1)
    return total(
        covered=32 * eta**2 * log_covering * S_reach * m.log1p(2 * visits / (S_reach * n * gamma_min)),
        uncovered=32 * eta**2 * log_covering * uncovered * m.log1p(visits / most) + first * uncovered,
        first_visits=_when_batches_exceed_counts(m, H=H, n=n, gamma_min=gamma_min, cost=lambda: first * S_reach),
    )


@bound(
    title="sum of the bonuses",
    symbol=r"\textstyle\sum_{t,i,h}\xi",
    source="audit D.12",
    group="regret",
    status="repaired",
    trivial=lambda m, eta, T, H: 4 * eta * T * (H - 1),
    words="the bonuses on both policies' trajectories sum to at most {value}",
    assumptions=_COVERED,
    monotone={
        **_SUM_MONOTONE,
        "n": falls("it divides and the first visits are covered"),
        "gamma_min": falls("it divides and the first visits are covered"),
        "S_reach": rises("it is under the root"),
        "uncovered": rises("it is under the root"),
    },
)
def bonus_sum_repaired(
    m: Arithmetic, *, H: Value, eta: Value, log_covering: Value, n: Value, T: Value, gamma_min: Value, S_reach: Value,
    uncovered: Value,
) -> Value:  # fmt: skip
    r"""Statement: on the coverage event, with m = 2(H-1), M = 2T(H-1) and u pairs off the expert's used online,

    .. math:: \sum_{t\le T}\sum_i\sum_{h<H}\xi\le4\eta\sqrt U\Bigl(\min\bigl\{2\sqrt{2|S_{reach}|M},
       2M/\sqrt{n\gamma_{\min}}\bigr\}+2\sqrt{2uM}\Bigr)+4m\eta\bigl(u+|S_{reach}|1\{n\gamma_{\min}/2<m\}\bigr).

    Source: audit D.12 with Cauchy-Schwarz over pairs: of order T / sqrt(n), not sqrt(T / n). Pathwise given coverage.
    Assumptions: as ``squared_bonus_sum_repaired``. Arguments: as there. Errors: as there. Returns a
    number in the units of ``eta``.

    >>> setting = dict(H=8, eta=1, log_covering=50, n=10**5, gamma_min=0.1, S_reach=5)
    >>> round(float(bonus_sum_repaired.estimate(T=100, uncovered=0, **setting)), 1)
    792.0
    """
    visits = 2 * T * (H - 1)
    scale = 4 * eta * m.sqrt(log_covering)
    first = 8 * (H - 1) * eta
    return total(
        covered=scale * m.min(m.sqrt(8 * S_reach * visits), 2 * visits / m.sqrt(n * gamma_min)),
        uncovered=scale * m.sqrt(8 * uncovered * visits) + first * uncovered,
        first_visits=_when_batches_exceed_counts(m, H=H, n=n, gamma_min=gamma_min, cost=lambda: first * S_reach),
    )


@bound(
    title="sum of the squared true bonuses",
    symbol=r"\textstyle\sum_{i,l}B_l(\pi_l^i)^2",
    source="audit D.5",
    group="regret",
    status="repaired",
    trivial=lambda m, eta, T, H: 8 * T * (eta * (H - 1)) ** 2,
    words="the squared true bonuses of both policies sum to at most {value}",
    assumptions=(*_COVERED[:-1], "every policy of the offline set is within Delta_n of the expert in total variation"),
    monotone={
        **_SUM_MONOTONE,
        "n": falls("it divides"),
        "gamma_min": falls("it divides"),
        "Delta_n": rises("it multiplies"),
    },
)
def squared_true_bonus_sum_repaired(
    m: Arithmetic, *, H: Value, eta: Value, log_covering: Value, n: Value, T: Value, gamma_min: Value, Delta_n: Value
) -> Value:
    r"""Statement: on the coverage event, :math:`\sum_{i,l\le T}B_l(\pi_l^i)^2\le2T\cdot` ``covered_bonus`` squared.

    Source: audit D.5: this version does vanish as n grows. Assumptions: as ``covered_bonus``, policies of the offline
    set. Arguments: as ``covered_bonus``, ``T`` a positive integer. Returns a number in the units of ``eta`` squared.
    Errors: ``InputError``.

    >>> setting = dict(H=8, eta=1, log_covering=30, n=10000, gamma_min=0.1, Delta_n=0.01)
    >>> round(float(squared_true_bonus_sum_repaired.estimate(T=100, **setting)), 1)
    9796.0
    """
    bonus = covered_bonus(m, H=H, eta=eta, log_covering=log_covering, n=n, gamma_min=gamma_min, Delta_n=Delta_n)
    return 2 * T * bonus**2


@bound(
    title="martingale part of the bonuses",
    symbol=r"|\textstyle\sum_tX_t|",
    source="audit D.13",
    group="regret",
    status="repaired",
    trivial=lambda m, eta, T, H: 2 * eta * T * (H - 1),
    spends=("delta_martingale",),
    failure=lambda m, delta_martingale, S_reach, n, gamma_min: (
        delta_martingale + coverage_failure(m, S_reach=S_reach, n=n, gamma_min=gamma_min)
    ),
    words="expected and realised bonuses of one policy sequence differ by at most {value}",
    assumptions=(*_COVERED[:2], "the policies played lie in the offline set, within Delta_n of the expert"),
    monotone={
        **_SUM_MONOTONE,
        "n": falls("it divides"),
        "gamma_min": falls("it divides"),
        "Delta_n": rises("it is under the root"),
        "delta_martingale": falls("log(2/delta') falls"),
    },
)
def martingale_repaired(
    m: Arithmetic, *, H: Value, eta: Value, log_covering: Value, n: Value, T: Value, gamma_min: Value, S_reach: Value,
    Delta_n: Value, delta_martingale: Value,
) -> Value:  # fmt: skip
    r"""Statement: with :math:`M_n=4\eta(H-1)\sqrt{2U/(n\gamma_{\min})}` and policies inside the offline set,

    .. math:: \Bigl|\sum_{t\le T}X_t\Bigr|\le\sqrt{2T(M_n^2+(2\eta(H-1))^2\Delta_n)\log(2/\delta')}
       +\tfrac43\eta(H-1)\log(2/\delta').

    Source: audit D.13 and correction 9 (Freedman's inequality). Assumptions: the coverage event, whose failure
    ``coverage_failure`` is included; play inside the offline set. Arguments: ``H, n, T, S_reach`` positive integers,
    ``eta`` > 0, ``log_covering`` = U >= 0, ``gamma_min`` in (0, 1], ``Delta_n`` in [0, 1], ``delta_martingale`` in
    (0, 1). Returns a number in the units of ``eta``. Errors: ``InputError``.

    >>> setting = dict(H=8, eta=1, log_covering=30, n=10**6, gamma_min=0.1, S_reach=5, Delta_n=0)
    >>> round(float(martingale_repaired.estimate(T=100, delta_martingale=0.05, **setting)), 2)
    53.06
    """
    chance = m.log(2 / delta_martingale)
    covered = covered_bonus(m, H=H, eta=eta, log_covering=log_covering, n=n, gamma_min=gamma_min, Delta_n=m.number(0))
    variance = covered**2 + 4 * (eta * (H - 1)) ** 2 * Delta_n
    return total(spread=m.sqrt(2 * T * variance * chance), jumps=4 * eta * (H - 1) * chance / 3)
