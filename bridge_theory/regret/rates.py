"""The paper's O-tilde statements with unit constants: for comparing how quantities scale, never as bounds."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, rate, requires, total
from bridge_theory.preference import kappa

_T_AT_LEAST_2 = requires(lambda T: T >= 2, "T >= 2 (log T is 0 at T = 1)")


@rate(title="main result, simplified", symbol="R_T", source="thm:main_simplified", group="regret")
def main_simplified_rate(m: Arithmetic, *, n: Value, T: Value, gamma_min: Value) -> Value:
    r"""Statement: :math:`R_T=\tilde O\bigl(\sqrt T\sqrt{\log(1+T/n)}+\sqrt T/\sqrt{n\gamma_{\min}}\bigr)`.

    Source: ``thm:main_simplified``; it does not follow from the appendix theorem, whose Term 3 has ``n^(-1/4)`` (audit
    4.1, D.1). For n >= T its first term is between 0.83 and 1 times T / sqrt(n), the order of ``regret_offline``.
    Assumptions: minimum visitation. Arguments: ``n, T`` positive integers, ``gamma_min`` in (0, 1]. Returns a regret,
    up to constants and logarithms. Errors: ``InputError``.

    >>> round(float(main_simplified_rate.estimate(n=1000, T=1000, gamma_min=0.1)), 3)
    29.49
    """
    return total(
        preference=m.sqrt(T) * m.sqrt(m.log1p(T / n)),
        dynamics=m.sqrt(T) / m.sqrt(n * gamma_min),
    )


@rate(
    title="Term 1: the multiplier", symbol=r"\gamma_T", source="lemma:term_1_asymptotic_bound", group="regret",
    conditions=(_T_AT_LEAST_2,),
)  # fmt: skip
def term_1_rate(
    m: Arithmetic, *, B: Value, W: Value, d: Value, S: Value, H: Value, n: Value, T: Value, gamma_min: Value,
    epsilon: Value,
) -> Value:  # fmt: skip
    r"""Statement: :math:`\gamma_T=\tilde O\bigl((\kappa+BW)\sqrt{d\log T}
    +H^2WB|S|\sqrt{\min\{\log T,T/(n\gamma_{\min})\}}+\sqrt{T\varepsilon H^2WB}\bigr)`.

    Source: ``lemma:term_1_asymptotic_bound``; the theorem sets epsilon = 1/T. Assumptions: minimum visitation.
    Arguments: ``B, W, epsilon`` > 0, ``d, S, H, n`` positive integers, ``T >= 2``, ``gamma_min`` in (0, 1]. Returns a
    number without unit, up to constants and logarithms. Errors: ``InputError``.

    >>> setting = dict(B=1, W=1, d=1, S=5, H=8, n=1000, gamma_min=0.1, epsilon=0.001)
    >>> round(float(term_1_rate.estimate(T=1000, **setting)), 1)
    865.0
    """
    return total(
        preference=(kappa(m, B=B, W=W) + B * W) * m.sqrt(d * m.log(T)),
        bonuses=H**2 * W * B * S * m.sqrt(_offline_growth(m, n=n, T=T, gamma_min=gamma_min)),
        cover=m.sqrt(T * epsilon * H**2 * W * B),
    )


@rate(
    title="Term 2: the potential", symbol=r"\mathrm{Term}_2", source="lemma:term_2_asymptotic_bound", group="regret",
    conditions=(_T_AT_LEAST_2,),
)  # fmt: skip
def term_2_rate(
    m: Arithmetic, *, B: Value, d: Value, S: Value, A: Value, H: Value, n: Value, T: Value, gamma_min: Value
) -> Value:
    r"""Statement: Term 2 is at most :math:`\sqrt{T\log(1+X/d)}` with
    :math:`X=\tilde O(B^2H|S|^2\min\{T/n,\log T\}+T|S|B^2\sqrt{|A|H}/\sqrt{n\gamma_{\min}})`.

    Source: ``lemma:term_2_asymptotic_bound``, false (audit D.7, D.10). Assumptions: minimum visitation. Arguments:
    ``B`` > 0, ``d, S, A, H, n`` positive integers, ``T >= 2``, ``gamma_min`` in (0, 1]. Returns a number without unit,
    up to constants and logarithms. Errors: ``InputError``.

    >>> round(float(term_2_rate.estimate(B=1, d=1, S=5, A=4, H=8, n=1000, T=1000, gamma_min=0.1)), 2)
    89.53
    """
    drift = B**2 * H * S**2 * m.min(T / n, m.log(T))
    radius = T * S * B**2 * m.sqrt(A * H) / m.sqrt(n * gamma_min)
    return m.sqrt(T * m.log1p((drift + radius) / d))


@rate(
    title="Term 3: the bonuses, as in the lemma", symbol=r"\mathrm{Term}_3", source="lemma:term_3_asymptotic_bound",
    group="regret", conditions=(_T_AT_LEAST_2,),
)  # fmt: skip
def term_3_rate(
    m: Arithmetic, *, B: Value, W: Value, S: Value, A: Value, H: Value, n: Value, T: Value, gamma_min: Value
) -> Value:
    r"""Statement: Term 3 is :math:`\tilde O\bigl(H|S|\sqrt{|A|TH/(n\gamma_{\min})}
    +H^{5/2}WB\sqrt T/\sqrt{n\gamma_{\min}}+H^2WB\,T\sqrt{\log T}\,|S|^{1/2}|A|^{1/4}n^{-1/4}\bigr)`.

    Source: ``lemma:term_3_asymptotic_bound`` (whose SB stands for WB); the theorem has ``sqrt(T)`` for
    ``T sqrt(log T)`` in the last part (audit D.15), see ``played_bonus_rate``. Assumptions: minimum visitation.
    Arguments: ``B, W`` > 0, ``S, A, H, n`` positive integers, ``T >= 2``, ``gamma_min`` in (0, 1]. Returns a regret, up
    to constants and logarithms. Errors: ``InputError``.

    >>> round(float(term_3_rate.estimate(B=1, W=1, S=5, A=4, H=8, n=1000, T=1000, gamma_min=0.1)))
    95879
    """
    return total(
        bonuses=H * S * m.sqrt(A * T * H / (n * gamma_min)),
        martingale=H**2 * W * B * m.sqrt(H * T / (n * gamma_min)),
        uncovered=H**2 * W * B * T * m.sqrt(m.log(T)) * _uncovered_decay(m, S=S, A=A, n=n),
    )


@rate(
    title="the bonuses, as in the theorem", symbol=r"\textstyle\sum_{i,t}8B_t(\pi_t^i)",
    source="lemma:offline_bonus_sum", group="regret",
)  # fmt: skip
def played_bonus_rate(
    m: Arithmetic, *, B: Value, W: Value, S: Value, A: Value, H: Value, n: Value, T: Value, gamma_min: Value
) -> Value:
    r"""Statement: :math:`\tilde O\bigl(H|S|\sqrt{|A|TH/(n\gamma_{\min})}\bigr)` plus ``martingale_rate``.

    Source: ``lemma:offline_bonus_sum``, last display, which is Term 3 of ``appdx:thm:bridge_regret``. Assumptions:
    minimum visitation. Arguments: ``B, W`` > 0, ``S, A, H, n, T`` positive integers, ``gamma_min`` in (0, 1]. Returns a
    regret, up to constants and logarithms. Errors: ``InputError``.

    >>> round(float(played_bonus_rate.estimate(B=1, W=1, S=5, A=4, H=8, n=1000, T=1000, gamma_min=0.1)), 1)
    2426.1
    """
    return total(
        bonuses=H * S * m.sqrt(A * T * H / (n * gamma_min)),
        martingale=martingale_rate(m, B=B, W=W, S=S, A=A, H=H, n=n, T=T, gamma_min=gamma_min),
    )


@rate(
    title="martingale concentration with offline data", symbol=r"|\textstyle\sum_tX_t|",
    source="lem:martingale_concentration_with_offline_data", group="regret",
)  # fmt: skip
def martingale_rate(
    m: Arithmetic, *, B: Value, W: Value, S: Value, A: Value, H: Value, n: Value, T: Value, gamma_min: Value
) -> Value:
    r"""Statement: :math:`|\sum_tX_t|\le\tilde O\bigl(H^{5/2}WB\sqrt T/\sqrt{n\gamma_{\min}}
    +H^2WB\sqrt T|S|^{1/2}|A|^{1/4}n^{-1/4}\bigr)`.

    Source: ``lem:martingale_concentration_with_offline_data``; the proof is wrong and the statement open for policies
    of the offline set, about which it is (audit D.13 with correction 9); see ``martingale_repaired``. Assumptions: as
    ``played_bonus_rate``. Arguments: as there. Errors: as there. Returns a regret, up to constants and logarithms.

    >>> round(float(martingale_rate.estimate(B=1, W=1, S=5, A=4, H=8, n=1000, T=1000, gamma_min=0.1)), 1)
    1710.5
    """
    return total(
        covered=H**2 * W * B * m.sqrt(H * T / (n * gamma_min)),
        uncovered=H**2 * W * B * m.sqrt(T) * _uncovered_decay(m, S=S, A=A, n=n),
    )


@rate(
    title="appendix theorem", symbol="R_T", source="appdx:thm:bridge_regret", group="regret",
    conditions=(_T_AT_LEAST_2,),
)  # fmt: skip
def bridge_regret_rate(
    m: Arithmetic, *, B: Value, W: Value, d: Value, S: Value, A: Value, H: Value, n: Value, T: Value, gamma_min: Value
) -> Value:
    r"""Statement: :math:`R_T\le2\cdot` Term 1 :math:`\cdot` Term 2 + Term 3 with epsilon = 1/T.

    Source: ``appdx:thm:bridge_regret``, unproved (audit D.1), see ``regret_unknown_repaired``. Assumptions: minimum
    visitation. Arguments: ``B, W`` > 0, ``d, S, A, H, n`` positive integers, ``T >= 2``, ``gamma_min`` in (0, 1].
    Returns a regret, up to constants and logarithms. Errors: ``InputError``.

    >>> round(float(bridge_regret_rate.estimate(B=1, W=1, d=1, S=5, A=4, H=8, n=1000, T=1000, gamma_min=0.1)))
    157325
    """
    multiplier = term_1_rate(m, B=B, W=W, d=d, S=S, H=H, n=n, T=T, gamma_min=gamma_min, epsilon=1 / T)
    potential = term_2_rate(m, B=B, d=d, S=S, A=A, H=H, n=n, T=T, gamma_min=gamma_min)
    return total(
        preference=2 * multiplier * potential,
        dynamics=played_bonus_rate(m, B=B, W=W, S=S, A=A, H=H, n=n, T=T, gamma_min=gamma_min),
    )


@rate(
    title="squared bonuses, asymptotic form", symbol=r"\textstyle\sum_{i,l}B_l(\pi_l^i)^2",
    source="lem:asymptotic_offline_squared_bonus", group="regret", conditions=(_T_AT_LEAST_2,),
)  # fmt: skip
def squared_bonus_rate(m: Arithmetic, *, S: Value, H: Value, eta: Value, n: Value, T: Value, gamma_min: Value) -> Value:
    r"""Statement: :math:`\sum_{i,l}B_l(\pi_l^i)^2\le\tilde O(\eta^2H^2|S|^2\min\{\log T,T/(n\gamma_{\min})\})`.

    Source: ``lem:asymptotic_offline_squared_bonus``, false: a term that never falls with n is dropped (audit D.5), see
    ``squared_true_bonus_sum_repaired``. Assumptions: minimum visitation. Arguments: ``S, H, n`` positive integers,
    ``eta`` > 0, ``T >= 2``, ``gamma_min`` in (0, 1]. Returns a number in the units of ``eta`` squared, up to constants
    and logarithms. Errors: ``InputError``.

    >>> round(float(squared_bonus_rate.estimate(S=5, H=8, eta=1, n=1000, T=1000, gamma_min=0.1)), 1)
    11052.4
    """
    return (eta * H * S) ** 2 * _offline_growth(m, n=n, T=T, gamma_min=gamma_min)


@rate(
    title="drift of expected features with online data", symbol=r"\|\phi^{\hat P_t}(\pi)-\phi^{\hat P_0}(\pi)\|_2^2",
    source="lemma:bound_on_feature_expectation_difference", group="regret",
)  # fmt: skip
def feature_drift_rate(
    m: Arithmetic, *, B: Value, S: Value, A: Value, H: Value, n: Value, t: Value, C: Value, delta: Value
) -> Value:
    r"""Statement: :math:`\|\phi^{\hat P_t}(\pi)-\phi^{\hat P_0}(\pi)\|_2^2\le O\bigl(B^2H|S|^2\log(|S||A|/\delta)C_T^2
    (\tfrac t{(n+t)^2}+\tfrac{t^2}{(n+t)^2n})\bigr)`; the last factor is :math:`t/(n(n+t))` exactly.

    Source: ``lemma:bound_on_feature_expectation_difference``; it needs data on every pair the policy uses (audit D.11).
    Assumptions: as stated there. Arguments: ``B`` > 0, ``S, A, H, n, t`` positive integers, ``C`` = C_T >= 0, ``delta``
    in (0, 1). Returns a squared feature norm, up to constants. Errors: ``InputError``.

    >>> round(float(feature_drift_rate.estimate(B=1, S=5, A=4, H=8, n=1000, t=1000, C=1, delta=0.05)), 4)
    0.5991
    """
    both = t / (n + t) ** 2 + t**2 / ((n + t) ** 2 * n)
    return B**2 * H * S**2 * m.log(S * A / delta) * C**2 * both


def _offline_growth(m: Arithmetic, *, n: Value, T: Value, gamma_min: Value) -> Value:
    return m.min(m.log(T), T / (n * gamma_min))


def _uncovered_decay(m: Arithmetic, *, S: Value, A: Value, n: Value) -> Value:
    # |S|^(1/2) |A|^(1/4) n^(-1/4)
    return m.sqrt(S * m.sqrt(A / n))
