"""What the transition bonuses sum to over T rounds, as the paper states it; each fails off the expert's pairs."""

from __future__ import annotations

from typing import Any

from bridge_theory.core import Arithmetic, Value, bound, falls, requires, rises, total, undefined_unless
from bridge_theory.online.confidence import WITHIN_ROUNDS
from bridge_theory.online.coverage import VISITS


def _cover_is_fine(epsilon: Any, eta: Any, H: Any) -> Any:
    return epsilon <= 4 * eta * H


def _utility_cover_is_fine(epsilon: Any, B: Any, W: Any, H: Any) -> Any:
    return epsilon <= 32 * H**2 * W * B


_FINE = requires(_cover_is_fine, "epsilon <= 4 eta H (a coarser cover has a negative logarithm)")
_UTILITY_FINE = requires(_utility_cover_is_fine, "epsilon <= 32 H^2 W B (a coarser cover has a negative logarithm)")
_LOG_TERM = {
    "S": rises("the logarithmic term rises"),
    "A": rises("the logarithmic term rises"),
    "H": rises("the logarithmic term rises"),
    "epsilon": falls("the cover shrinks"),
}
_GROWTH = {
    "T": rises("both logarithms rise"),
    "n": falls("n gamma_min divides"),
    "gamma_min": falls("n gamma_min divides"),
    "S_reach": rises("it multiplies"),
}


@bound(
    title="logarithmic term of the offline-enhanced bonus, as stated",
    symbol="U",
    source="local:offline_bonus_xi",
    group="regret",
    status="stated",
    words="the logarithmic term of the bonus is {value}",
    conditions=(_FINE, undefined_unless(lambda t: t >= 2, "log(log 1)", repaired="bonus_radius")),
    monotone={
        **_LOG_TERM,
        "eta": rises("its logarithm rises"),
        "delta": falls("log(1/delta) falls"),
        "t": rises("log log t rises"),
    },
)
def offline_bonus_log_term(
    m: Arithmetic, *, S: Value, A: Value, H: Value, eta: Value, epsilon: Value, delta: Value, t: Value
) -> Value:
    r"""Statement: :math:`U=H\log(|S||A|H)+|S|\log(4\eta H/\varepsilon)+\log(6\log t/\delta)`.

    Source: ``local:offline_bonus_xi``; the bonus is :math:`\xi=\min(2\eta,4\eta\sqrt{U/(N_{off}+N_t)})`, and
    :math:`V` in the lemmas below is ``U`` at ``t = HT``. Assumptions: none, a definition. Arguments: ``S, A, H``
    positive integers, ``eta, epsilon`` > 0 with epsilon <= 4 eta H, ``delta`` in (0, 1), ``t`` an integer >= 2. Returns
    a number of nats. Errors: ``InputError``; ``UndefinedInPaperError`` at ``t`` = 1.

    >>> round(float(offline_bonus_log_term.estimate(S=5, A=4, H=8, eta=1, epsilon=0.1, delta=0.05, t=1000)), 3)
    76.163
    """
    cover = S * m.log(4 * eta * H / epsilon)
    return total(histories=H * m.log(S * A * H), cover=cover, chance=m.log(6 * m.log(t) / delta))


@bound(
    title="sum of the squared bonuses, as stated",
    symbol=r"\textstyle\sum_{t,h}\xi^2",
    source="lemma:offline_bonus_bound",
    group="regret",
    status="stated",
    trivial=lambda m, eta, T, H: 4 * eta**2 * T * (H - 1),
    spends=("delta_martingale",),
    failure=lambda m, delta_martingale: 2 * delta_martingale,
    words="the squared bonuses on one policy's trajectories sum to at most {value}",
    assumptions=VISITS,
    conditions=(
        _FINE,
        undefined_unless(lambda H, T: H * T >= 2, "log(log 1)", repaired="squared_bonus_sum_repaired"),
    ),
    monotone={
        **_LOG_TERM,
        **_GROWTH,
        "eta": rises("it multiplies"),
        "delta_martingale": falls("log(1/delta') falls"),
    },
)
def squared_bonus_sum_stated(
    m: Arithmetic, *, S: Value, A: Value, H: Value, eta: Value, epsilon: Value, n: Value, T: Value, gamma_min: Value,
    S_reach: Value, delta_martingale: Value,
) -> Value:  # fmt: skip
    r"""Statement: w.p. :math:`1-2\delta'`,
    :math:`\sum_{t\le T}\sum_{h<H}\xi^2\le32\eta^2V|S_{reach}|\log(1+T/(n\gamma_{\min}))`.

    Source: ``lemma:offline_bonus_bound``; false (audit D.3), see ``squared_bonus_sum_repaired``. Assumptions: minimum
    visitation. Arguments: as ``offline_bonus_log_term``; ``n, T, S_reach`` positive integers, ``gamma_min`` in (0, 1],
    ``delta_martingale`` in (0, 1). Returns a number in the units of ``eta`` squared. Errors: ``InputError``;
    ``UndefinedInPaperError`` for H T = 1.

    >>> setting = dict(S=5, A=4, H=8, eta=1, epsilon=0.1, n=1000, gamma_min=0.1, S_reach=5, delta_martingale=0.05)
    >>> round(float(squared_bonus_sum_stated.estimate(T=100, **setting)), 1)
    8443.1
    """
    log_term = offline_bonus_log_term(m, S=S, A=A, H=H, eta=eta, epsilon=epsilon, delta=delta_martingale, t=H * T)
    return 32 * eta**2 * log_term * S_reach * m.log1p(T / (n * gamma_min))


@bound(
    title="sum of the squared true bonuses, as stated",
    symbol=r"\textstyle\sum_{i,l}B_l(\pi_l^i)^2",
    source="lemma:offline_squared_bonus_bound",
    group="regret",
    status="stated",
    spends=("delta_martingale",),
    failure=lambda m, delta_martingale: 2 * delta_martingale,
    words="the squared true bonuses of both policies sum to at most {value}",
    assumptions=VISITS,
    conditions=(
        WITHIN_ROUNDS,
        undefined_unless(lambda H, T: H * T >= 2, "log(log 1)", repaired="squared_true_bonus_sum_repaired"),
    ),
    monotone={
        **_LOG_TERM,
        **_GROWTH,
        "eta": rises("it multiplies"),
        "t": rises("log log t rises"),
        "delta": falls("log(1/delta) falls"),
        "delta_martingale": falls("log(1/delta') falls"),
    },
)
def squared_true_bonus_sum_stated(
    m: Arithmetic, *, S: Value, A: Value, H: Value, eta: Value, epsilon: Value, n: Value, t: Value, T: Value,
    gamma_min: Value, S_reach: Value, delta: Value, delta_martingale: Value,
) -> Value:  # fmt: skip
    r"""Statement: w.p. :math:`1-2\delta'`, for all ``t``, :math:`\sum_{i,l<t}B_l(\pi_l^i,\eta,\delta/l^3)^2` is at most

    .. math:: 12\eta^2H^2\bigl(1.4\ln\ln(2\max(4\eta^2Ht,1))+\ln\tfrac{5.2}{\delta'}+1\bigr)
       +64\eta^2H|S_{reach}|\log\bigl(1+\tfrac T{n\gamma_{\min}}\bigr)V,

    with :math:`V=H\log(|S||A|H)+|S|\log\lceil4\eta H/\varepsilon\rceil+\log(6\log(HT)/\delta)`.

    Source: ``lemma:offline_squared_bonus_bound``; the proof is wrong (audit D.4). Assumptions: minimum visitation.
    Arguments: as ``squared_bonus_sum_stated``; ``t <= T`` a positive integer, ``delta`` in (0, 1). Returns a number in
    the units of ``eta`` squared. Errors: as there.

    >>> setting = dict(S=5, A=4, H=8, eta=1, epsilon=0.1, n=1000, gamma_min=0.1, S_reach=5, delta=0.05)
    >>> round(float(squared_true_bonus_sum_stated.estimate(t=100, T=100, delta_martingale=0.05, **setting)))
    141759
    """
    inner = m.log(m.log(2 * m.max(4 * eta**2 * H * t, m.number(1))))
    cover = S * m.log(m.ceil(4 * eta * H / epsilon))
    log_term = H * m.log(S * A * H) + cover + m.log(6 * m.log(H * T) / delta)
    martingale = 7 * inner / 5 + m.log(m.number(26) / 5 / delta_martingale) + 1
    return total(
        martingale=12 * eta**2 * H**2 * martingale,
        visits=64 * eta**2 * H * S_reach * m.log1p(T / (n * gamma_min)) * log_term,
    )


@bound(
    title="sum of the bonuses, as stated",
    symbol=r"\textstyle\sum_{t,h}\xi",
    source="thm:offline_nonsquared_bound",
    group="regret",
    status="stated",
    trivial=lambda m, B, W, T, H: 16 * H * W * B * T * (H - 1),
    spends=("delta",),
    words="the bonuses on one policy's trajectories sum to at most {value}",
    assumptions=VISITS,
    conditions=(
        _UTILITY_FINE,
        undefined_unless(lambda H, T: H * T >= 2, "log(log 1)", repaired="bonus_sum_repaired"),
    ),
    monotone={
        **_LOG_TERM,
        **_GROWTH,
        "B": rises("it multiplies"),
        "W": rises("it multiplies"),
        "delta": falls("log(1/delta) falls"),
    },
)
def bonus_sum_stated(
    m: Arithmetic, *, B: Value, W: Value, S: Value, A: Value, H: Value, epsilon: Value, n: Value, T: Value,
    gamma_min: Value, S_reach: Value, delta: Value,
) -> Value:  # fmt: skip
    r"""Statement: :math:`\sum_{t\le T}\sum_{h<H}\xi(\varepsilon,8HWB,\delta)\le64HWB\sqrt V\,|S_{reach}|\,
    2\sqrt{T/(n\gamma_{\min})}` with ``V`` = ``offline_bonus_log_term`` at eta = 8HWB and ``t = HT``.

    Source: ``thm:offline_nonsquared_bound``, whose letter S in SB stands for W; false (audit D.12), see
    ``bonus_sum_repaired``. Assumptions: minimum visitation. Arguments: ``B, W, epsilon`` > 0 (epsilon at most
    32 H^2 W B), ``S, A, H, n, T, S_reach`` positive integers, ``gamma_min`` in (0, 1], ``delta`` in (0, 1). Returns a
    regret. Errors: ``InputError``; ``UndefinedInPaperError`` for H T = 1.

    >>> setting = dict(B=1, W=0.5, S=5, A=4, H=8, epsilon=0.1, n=1000, gamma_min=0.1, S_reach=5, delta=0.05)
    >>> round(float(bonus_sum_stated.estimate(T=100, **setting)), 1)
    24748.6
    """
    eta = 8 * H * W * B
    log_term = offline_bonus_log_term(m, S=S, A=A, H=H, eta=eta, epsilon=epsilon, delta=delta, t=H * T)
    return 8 * eta * m.sqrt(log_term) * S_reach * 2 * m.sqrt(T / (n * gamma_min))


@bound(
    title="covered part of the played bonuses, as stated",
    symbol=r"\textstyle\sum_{i,t}8B_t(\pi_t^i)",
    source="lemma:offline_bonus_sum",
    group="regret",
    status="stated",
    spends=("delta",),
    failure=lambda m, delta: 2 * delta,
    words="the true bonuses of the policies played sum to at most {value}, plus a rate",
    assumptions=VISITS,
    conditions=(
        _UTILITY_FINE,
        undefined_unless(lambda H, T: H * T >= 2, "log(log 1)", repaired="bonus_sum_repaired"),
    ),
    monotone={
        **_LOG_TERM,
        **_GROWTH,
        "B": rises("it multiplies"),
        "W": rises("it multiplies"),
        "delta": falls("log(1/delta) falls"),
    },
)
def played_bonus_sum_stated(
    m: Arithmetic, *, B: Value, W: Value, S: Value, A: Value, H: Value, epsilon: Value, n: Value, T: Value,
    gamma_min: Value, S_reach: Value, delta: Value,
) -> Value:  # fmt: skip
    r"""Statement: :math:`\sum_t8B_t(\pi_t^1)+8B_t(\pi_t^2)\le2048HWB\sqrt V\,|S_{reach}|\sqrt{T/(n\gamma_{\min})}`

    plus the rate ``martingale_rate``; this is the explicit part, 16 times ``bonus_sum_stated``.

    Source: ``lemma:offline_bonus_sum``, unproved (audit D.14). Assumptions: as
    ``bonus_sum_stated``. Arguments: as there. Errors: as there.
    Returns a regret.

    >>> setting = dict(B=1, W=0.5, S=5, A=4, H=8, epsilon=0.1, n=1000, gamma_min=0.1, S_reach=5, delta=0.05)
    >>> round(float(played_bonus_sum_stated.estimate(T=100, **setting)))
    395977
    """
    return 16 * bonus_sum_stated(
        m, B=B, W=W, S=S, A=A, H=H, epsilon=epsilon, n=n, T=T, gamma_min=gamma_min, S_reach=S_reach, delta=delta
    )
