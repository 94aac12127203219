"""Regret with known dynamics as the paper states it: the lemma, the feature sum, the theorem, the three regimes."""

from __future__ import annotations

from typing import Any

from bridge_theory.comparison import at_most
from bridge_theory.core import Arithmetic, Value, bound, falls, rate, requires, rises
from bridge_theory.offline.assumptions import DETERMINISTIC
from bridge_theory.online.confidence import beta_t
from bridge_theory.online.norm_relation import alpha_dT, gamma_known
from bridge_theory.preference import kappa
from bridge_theory.regret.trivial import BOUNDED, twice_range

_LOG_RISES = rises("d log(1 + c/d) rises in d for every c >= 0")


def _regularised_enough(lam: Any, B: Any, W: Any) -> Any:
    return at_most(lambda m, lam, B, W: (B, lam * kappa(m, B=B, W=W)), lam=lam, B=B, W=W)


def _unlikely_enough(delta: Any) -> Any:
    return at_most(lambda m, delta: (delta, m.exp(m.number(-1))), delta=delta)


@bound(
    title="regret with known dynamics from the feature differences, as stated",
    symbol=r"R_T",
    source="local:regret_known_dynamics",
    group="regret",
    status="stated",
    trivial=twice_range,
    spends=("delta",),
    failure=lambda m, T, delta: delta + delta * m.log(T) / m.log(m.number(2)),
    words="the regret is at most {value}",
    assumptions=(BOUNDED, "the best policy is in every round's set"),
    monotone={
        "norm_sum": rises("it multiplies"),
        "T": rises("gamma_T rises"),
        "d": rises("gamma_T rises"),
        "delta": falls("gamma_T falls"),
        "B": rises("gamma_T rises"),
        "W": rises("gamma_T rises"),
    },
)
def regret_known_from_sum(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, T: Value, delta: Value, norm_sum: Value
) -> Value:
    r"""Statement: :math:`R_T\le2\gamma^{known}_T\sum_{t\le T}\|\phi(\pi_t^1)-\phi(\pi_t^2)\|_{(\overline V_t)^{-1}}`.

    Source: ``local:regret_known_dynamics`` (a lemma without a label; audit A.4: true given containment). Assumptions:
    containment. Arguments: ``B, W, lam`` > 0, ``d, T`` positive integers, ``delta`` in (0, 1), ``norm_sum`` >= 0.
    Returns a regret. Errors: ``InputError``.

    >>> round(float(regret_known_from_sum.estimate(B=1, W=1, lam=1, d=1, T=1, delta=0.05, norm_sum=0.5)), 3)
    98.077
    """
    return 2 * gamma_known(m, B=B, W=W, lam=lam, d=d, t=T, T=T, delta=delta) * norm_sum


@bound(
    title="sum of feature differences under offline constraints, as stated",
    symbol=r"\textstyle\sum_t\|\phi(\pi_t^1)-\phi(\pi_t^2)\|_{(\overline V_t)^{-1}}",
    source="lemma:feature_diff_bound",
    group="regret",
    status="stated",
    spends=("delta",),
    words="the feature differences sum to at most {value} in the data-matrix norm",
    assumptions=(BOUNDED, "everything played lies in the offline set for known dynamics"),
    monotone={
        "B": rises("the logarithm rises"),
        "T": rises("the logarithm rises"),
        "S": rises("the logarithm rises"),
        "A": rises("the logarithm rises"),
        "d": _LOG_RISES,
        "n": falls("the logarithm falls"),
        "lam": falls("the logarithm falls"),
        "delta": falls("the logarithm falls"),
    },
)
def feature_difference_sum(
    m: Arithmetic, *, B: Value, lam: Value, d: Value, S: Value, A: Value, n: Value, T: Value, delta: Value
) -> Value:
    r"""Statement: :math:`\sum_{t\le T}\|\phi(\pi_t^1)-\phi(\pi_t^2)\|_{(\overline V_t)^{-1}}
    \le\sqrt{2d\log\bigl(1+\tfrac{192B^2T|S|\log(|A|/\delta)}{nd\lambda}\bigr)}`.

    Source: ``lemma:feature_diff_bound``; false by a factor ``sqrt(T)`` (audit A.11), see ``elliptical_norm_sum``.
    Assumptions: everything played lies in the offline set. Arguments: ``B, lam`` > 0, ``d, S, A, n, T`` positive
    integers, ``delta`` in (0, 1). Returns a number without unit. Errors: ``InputError``.

    >>> round(float(feature_difference_sum.estimate(B=0.5, lam=1, d=1, S=1, A=2, n=22, T=10**4, delta=0.05)), 2)
    4.75
    """
    return m.sqrt(2 * d * m.log1p(192 * B**2 * T * S * m.log(A / delta) / (n * d * lam)))


@bound(
    title="regret with known dynamics, as stated",
    symbol=r"R_T",
    source="thm:main_known",
    group="regret",
    status="stated",
    trivial=twice_range,
    spends=("delta",),
    words="the regret is at most {value}",
    assumptions=(BOUNDED, DETERMINISTIC, "the expert is the best policy of the class"),
    conditions=(
        requires(_unlikely_enough, "delta <= 1/e"),
        requires(_regularised_enough, "lam >= B / kappa"),
    ),
    monotone={
        "T": rises("both factors rise"),
        "S": rises("the logarithm rises"),
        "A": rises("the logarithm rises"),
        "d": rises("both factors rise"),
        "n": falls("the logarithm falls"),
        "delta": falls("both factors fall"),
        "B": rises("kappa beta_T, alpha and the logarithm rise"),
        "W": rises("kappa beta_T and alpha rise"),
    },
)
def regret_known_stated(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, S: Value, A: Value, n: Value, T: Value, delta: Value
) -> Value:
    r"""Statement: for :math:`\delta\le1/e` and :math:`\lambda\ge B/\kappa`, with probability at least :math:`1-\delta`,

    .. math:: R_T\le(2\kappa\beta_T(\delta)+\alpha_{d,T}(\delta))
       \sqrt{2d\log\bigl(1+\tfrac{192B^2T|S|\log(|A|/\delta)}{nd\lambda}\bigr)}.

    Source: ``thm:main_known``; false (audit A.12: a factor ``sqrt(T)`` is lost; deterministic counterexamples), see
    ``regret_known_repaired``. Assumptions: bounded features and weights, deterministic stationary expert. Arguments:
    ``B, W, lam`` > 0, ``d, S, A, n, T`` positive integers, ``delta`` in (0, 1/e]. Returns a regret. Errors:
    ``InputError`` outside the domain or the theorem's conditions.

    >>> setting = dict(B=0.5, W=1, lam=1, d=1, S=1, A=2, n=22, delta=0.05)
    >>> round(float(regret_known_stated.estimate(T=10**4, **setting)), 1)
    424.5
    """
    scale = 2 * kappa(m, B=B, W=W) * beta_t(m, B=B, W=W, lam=lam, d=d, t=T, delta=delta)
    width = scale + alpha_dT(m, B=B, W=W, d=d, T=T, delta=delta)
    return width * feature_difference_sum(m, B=B, lam=lam, d=d, S=S, A=A, n=n, T=T, delta=delta)


@rate(
    title="scale of the known-model regret",
    symbol=r"\Gamma",
    source="local:gamma_capital",
    group="regret",
)
def regret_known_scale(m: Arithmetic, *, B: Value, W: Value, d: Value, T: Value, delta: Value) -> Value:
    r"""Statement: :math:`\Gamma=(W\sqrt{\kappa B}+WB)\,d\log(TB/(\kappa\delta))`.

    Source: ``local:gamma_capital``; it drops ``kappa sqrt(d log)`` and fixes ``lam = B/kappa`` silently (audit A.13).
    Assumptions: none. Arguments: ``B, W`` > 0, ``d, T`` positive integers, ``delta`` in (0, 1). Returns a regret, up to
    constants; negative where T B < kappa delta. Errors: ``InputError``.

    >>> round(float(regret_known_scale.estimate(B=1, W=1, d=1, T=1000, delta=0.05)), 3)
    26.944
    """
    scale = kappa(m, B=B, W=W)
    return (W * m.sqrt(scale * B) + W * B) * d * m.log(T * B / (scale * delta))


@rate(title="regret with known dynamics, asymptotic form", symbol=r"R_T", source="thm:main_known", group="regret")
def regret_known_rate(
    m: Arithmetic, *, B: Value, W: Value, d: Value, S: Value, n: Value, T: Value, delta: Value
) -> Value:
    r"""Statement: :math:`R_T=\tilde O\bigl(\Gamma\sqrt{\log(1+T|S|/(nd))}\bigr)`.

    Source: ``thm:main_known``, second display. Assumptions: none beyond the theorem's. Arguments: as
    ``regret_known_scale``, ``S, n`` positive integers. Returns a regret, up to constants. Errors: ``InputError``.

    >>> round(float(regret_known_rate.estimate(B=1, W=1, d=1, S=5, n=100, T=1000, delta=0.05)), 3)
    53.426
    """
    return regret_known_scale(m, B=B, W=W, d=d, T=T, delta=delta) * m.sqrt(m.log1p(T * S / (n * d)))


@rate(
    title="known-model regret, small T", symbol=r"R_T", source="local:regime_small_horizon", group="regret",
    assumptions=("T S is much smaller than n d",),
)  # fmt: skip
def regret_regime_small_horizon(
    m: Arithmetic, *, B: Value, W: Value, d: Value, S: Value, n: Value, T: Value, delta: Value
) -> Value:
    r"""Statement: for :math:`T|S|\ll nd`, :math:`R_T=O(\Gamma\sqrt{T|S|/(nd)})`.

    Source: ``local:regime_small_horizon``. Assumptions: as stated. Arguments: as ``regret_known_rate``. Returns a
    regret, up to constants. Errors: ``InputError``.

    >>> round(float(regret_regime_small_horizon.estimate(B=1, W=1, d=1, S=5, n=10**6, T=1000, delta=0.05)), 3)
    1.905
    """
    return regret_known_scale(m, B=B, W=W, d=d, T=T, delta=delta) * m.sqrt(T * S / (n * d))


@rate(
    title="known-model regret, transition regime", symbol=r"R_T", source="local:regime_transition", group="regret",
    assumptions=("T S is of the order of n d",),
)  # fmt: skip
def regret_regime_transition(m: Arithmetic, *, B: Value, W: Value, d: Value, T: Value, delta: Value) -> Value:
    r"""Statement: for :math:`T|S|\approx nd`, :math:`R_T=O(\Gamma)`.

    Source: ``local:regime_transition``. Assumptions: as stated. Arguments: as ``regret_known_scale``. Returns a regret,
    up to constants. Errors: ``InputError``.

    >>> round(float(regret_regime_transition.estimate(B=1, W=1, d=1, T=1000, delta=0.05)), 3)
    26.944
    """
    return regret_known_scale(m, B=B, W=W, d=d, T=T, delta=delta)


@rate(
    title="known-model regret, large T", symbol=r"R_T", source="local:regime_large_horizon", group="regret",
    assumptions=("T S is much larger than n d",),
)  # fmt: skip
def regret_regime_large_horizon(m: Arithmetic, *, B: Value, W: Value, d: Value, T: Value, delta: Value) -> Value:
    r"""Statement: for :math:`T|S|\gg nd`, :math:`R_T=O(\Gamma\sqrt{\log T})`.

    Source: ``local:regime_large_horizon``. Assumptions: as stated. Arguments: as ``regret_known_scale``. Returns a
    regret, up to constants. Errors: ``InputError``.

    >>> round(float(regret_regime_large_horizon.estimate(B=1, W=1, d=1, T=1000, delta=0.05)), 3)
    70.815
    """
    return regret_known_scale(m, B=B, W=W, d=d, T=T, delta=delta) * m.sqrt(m.log(T))
