"""Regret with unknown dynamics, proved: what the transition bonuses sum to, and the a-priori bound they give."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, least, rises, total
from bridge_theory.offline.assumptions import DETERMINISTIC
from bridge_theory.online.confidence import MODEL, beta_repaired
from bridge_theory.online.coverage import VISITS, coverage_failure
from bridge_theory.online.l1_bonus import EVENT
from bridge_theory.online.norm_relation import supermartingale_factor
from bridge_theory.preference import kappa_differences
from bridge_theory.regret.known_repaired import regret_known_apriori
from bridge_theory.regret.offline_gain import delta_n_version_space_sharp
from bridge_theory.regret.trivial import IN_SET, twice_range

_PLAY = (IN_SET, "each round plays the exact arg-max pair, after an exact projection, with exact features")
_COVERED = "every pair of the expert has at least n gamma_min / 2 recorded transitions (see coverage_failure)"
_P_FALLS, _M_FALLS = falls("L_T falls"), falls("log(1/delta_M) falls")
_SUM_MONOTONE = {
    "S": rises("the number of cells and L_T rise"),
    "A": rises("the number of cells and L_T rise"),
    "H": rises("the number of transitions rises"),
    "n": rises("L_T rises: the union over counts grows"),
    "T": rises("the number of transitions rises"),
    "delta_P": _P_FALLS,
    "delta_M": _M_FALLS,
}


def _count_log_term(
    m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, T: Value, K: Value, delta_P: Value
) -> Value:
    # L_T, with at least one transition so that a horizon of 1 has a value (its sums are empty anyway)
    most = m.max(m.number(1), (n + 2 * K * T) * (H - 1))
    return 2 * (S * m.log(m.number(2)) + m.log(S * A * most * (most + 1) / delta_P))


@bound(
    title="sum of the expected L1 radii",
    symbol=r"\Gamma_T",
    source="audit R7",
    group="regret",
    status="repaired",
    trivial=lambda m, T, H: 4 * T * (H - 1),
    spends=("delta_P", "delta_M"),
    words="the L1 radii of the policies played sum to at most {value} in expectation",
    assumptions=EVENT,
    monotone=_SUM_MONOTONE,
)
def radius_sum(
    m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, T: Value, K: Value, delta_P: Value, delta_M: Value
) -> Value:
    r"""Statement: :math:`\sum_{t\le T}\sum_iE_{P_*^{\pi_t^i}}\sum_{h<H}\epsilon_{N_t}\le\Gamma_T`, where
    :math:`N_{\max}=(n+2KT)(H-1)`, :math:`L_T=2(|S|\log2+\log(|S||A|N_{\max}(N_{\max}+1)/\delta_P))`,

    .. math:: \Gamma_T=\tfrac e{e-1}\Bigl[8(H-1)|S||A|+2\sqrt{2L_T}\sqrt{2|S||A|T(H-1)/K}
       +4(H-1)\log(1/\delta_M)\Bigr].

    Source: audit R7 with m = 2(H-1); 0 when H = 1. For ``K`` comparisons a round the supermartingale averages the K
    pairs of rollouts, whose conditional means agree: the batch is m = 2K(H-1), the sum over all 2KT(H-1) visits is at
    most :math:`4m|S||A|+2\sqrt{2L_T}\sqrt{2K|S||A|T(H-1)}`, and dividing by K gives the display. Assumptions: as
    ``bonus_radius``. Arguments: ``S, A, H, n, T, K`` positive integers, ``delta_P, delta_M`` in (0, 1). Returns a sum
    of L1 distances, at most 4T(H-1) in any case. Errors: ``InputError``.

    >>> setting = dict(S=5, A=4, H=8, n=100, K=1, delta_P=0.05, delta_M=0.05)
    >>> round(float(radius_sum.estimate(T=10**6, **setting)))
    691112
    """
    steps, cells = H - 1, S * A
    width = m.sqrt(2 * _count_log_term(m, S=S, A=A, H=H, n=n, T=T, K=K, delta_P=delta_P))
    factor = supermartingale_factor(m)
    return total(
        first_visits=factor * 8 * steps * cells,
        later_visits=factor * 2 * width * m.sqrt(2 * cells * T * steps / K),
        deviation=-factor * 4 * steps * m.log(delta_M),
    )


@bound(
    title="sum of the expected L1 radii, with coverage",
    symbol=r"\Gamma_T",
    source="audit R7, R10",
    group="regret",
    status="repaired",
    trivial=lambda m, T, H: 4 * T * (H - 1),
    spends=("delta_P", "delta_M"),
    failure=lambda m, delta_P, delta_M, S_reach, n, gamma_min: (
        delta_P + delta_M + coverage_failure(m, S_reach=S_reach, n=n, gamma_min=gamma_min)
    ),
    words="the L1 radii of the policies played sum to at most {value} in expectation",
    assumptions=(*EVENT, *VISITS, "every policy of the offline set is within Delta_n of the expert"),
    monotone={
        **{name: why for name, why in _SUM_MONOTONE.items() if name != "n"},
        "gamma_min": falls("it divides"),
        "Delta_n": rises("it multiplies"),
    },
)
def radius_sum_covered(
    m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, T: Value, K: Value, gamma_min: Value, S_reach: Value,
    Delta_n: Value, delta_P: Value, delta_M: Value,
) -> Value:  # fmt: skip
    r"""Statement: on the coverage event of R10,

    .. math:: \sum_{t,i}E_{P_*^{\pi_t^i}}\sum_{h<H}\epsilon_{N_t}\le\min\Bigl\{\Gamma_T,
       2T(H-1)\bigl(\sqrt{2L_T/(n\gamma_{\min})}+2\Delta_n\bigr)\Bigr\}.

    Source: audit R7, last line, with correction 4: the failure probability includes
    :math:`|S_{reach}|e^{-n\gamma_{\min}/8}`. Assumptions: as ``radius_sum``; minimum visitation; ``Delta_n`` holds on
    its own event. Arguments: as ``radius_sum``; ``gamma_min`` in (0, 1], ``S_reach`` the pairs visited in steps 1 to
    H-1, ``Delta_n`` in [0, 1]. Returns a sum of L1 distances. Errors: ``InputError``.

    >>> setting = dict(S=5, A=4, H=8, K=1, gamma_min=0.1, S_reach=5, Delta_n=0.0, delta_P=0.05, delta_M=0.05)
    >>> round(float(radius_sum_covered.estimate(n=10**6, T=1000, **setting)), 1)
    566.8
    """
    log_term = _count_log_term(m, S=S, A=A, H=H, n=n, T=T, K=K, delta_P=delta_P)
    return least(
        online=radius_sum(m, S=S, A=A, H=H, n=n, T=T, K=K, delta_P=delta_P, delta_M=delta_M),
        offline=2 * T * (H - 1) * (m.sqrt(2 * log_term / (n * gamma_min)) + 2 * Delta_n),
    )


def _with_radius_sum(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, H: Value, T: Value, K: Value, delta_w: Value,
    delta_F: Value, radii: Value,
) -> Value:  # fmt: skip
    scale = kappa_differences(m, B=B, W=W)
    after = beta_repaired(m, B=B, W=W, lam=lam, d=d, t=T + 1, K=K, delta_w=delta_w)
    features = 4 * scale * after * B / m.sqrt(scale * lam)
    preference = regret_known_apriori(m, B=B, W=W, lam=lam, d=d, T=T, K=K, delta_w=delta_w, delta_F=delta_F)
    return preference + (features + 2 * B * W * H) * radii


@bound(
    title="regret with unknown dynamics",
    symbol=r"R_T",
    source="audit R7",
    group="regret",
    status="repaired",
    trivial=twice_range,
    spends=("delta_w", "delta_F", "delta_P", "delta_M"),
    words="the regret is at most {value}",
    assumptions=(*MODEL, *EVENT, *_PLAY, "Delta_n holds for the offline set"),
    monotone={
        **{name: rises(f"Gamma_T rises: {why.because}") for name, why in _SUM_MONOTONE.items() if name in "SAHn"},
        "T": rises("each part rises"),
        "d": rises("beta_T and Psi_T rise"),
        "delta_w": falls("beta_T falls"),
        "delta_F": falls("Psi_T falls"),
        "delta_P": _P_FALLS,
        "delta_M": _M_FALLS,
        "Delta_n": rises("it multiplies"),
    },
)
def regret_unknown_repaired(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, S: Value, A: Value, H: Value, n: Value, T: Value,
    K: Value, delta_w: Value, delta_F: Value, delta_P: Value, delta_M: Value, Delta_n: Value,
) -> Value:  # fmt: skip
    r"""Statement: with :math:`\kappa=2+2\cosh(2BW)`, R5's :math:`\beta_T,\Psi_T`, and ``radius_sum`` :math:`\Gamma_T`,

    .. math:: R_T\le\min\Bigl\{2BWT\min(1,\Delta_n),\ 4\kappa\beta_T\sqrt{T\Psi_T}
       +\bigl(4\kappa\beta_TB/\sqrt{\kappa\lambda}+2BWH\bigr)\Gamma_T\Bigr\}.

    Source: audit R7 (Theorem U), corrections 1, 4 and 6; its data-dependent parts are ``regret_width`` and
    ``regret_hindsight``. The failure probability of the offline set comes on top. Assumptions: R1's model, R6's event,
    exact arg-max pairs and projection. Arguments: ``B, W, lam`` > 0, ``d, S, A, H, n, T, K`` positive integers,
    ``delta_w, delta_F, delta_P, delta_M`` in (0, 1), ``Delta_n`` in [0, 1] (1 if nothing is known). Returns a regret.
    Errors: ``InputError``.

    >>> setting = dict(B=1, W=0.5, lam=8, d=1, S=5, A=4, H=8, n=100, K=1, T=1000, Delta_n=0.02)
    >>> float(regret_unknown_repaired.estimate(delta_w=0.01, delta_F=0.01, delta_P=0.01, delta_M=0.01, **setting))
    20.0
    """
    radii = radius_sum(m, S=S, A=A, H=H, n=n, T=T, K=K, delta_P=delta_P, delta_M=delta_M)
    return least(
        offline=twice_range(m, B, W, T) * Delta_n,
        online=_with_radius_sum(
            m, B=B, W=W, lam=lam, d=d, H=H, T=T, K=K, delta_w=delta_w, delta_F=delta_F, radii=radii
        ),
    )


@bound(
    title="regret with unknown dynamics, with coverage",
    symbol=r"R_T",
    source="audit R7, R10",
    group="regret",
    status="repaired",
    trivial=twice_range,
    spends=("delta_w", "delta_F", "delta_P", "delta_M"),
    failure=lambda m, delta_w, delta_F, delta_P, delta_M, S_reach, n, gamma_min: (
        delta_w + delta_F + delta_P + delta_M + coverage_failure(m, S_reach=S_reach, n=n, gamma_min=gamma_min)
    ),
    words="the regret is at most {value}",
    assumptions=(*MODEL, *EVENT, *_PLAY, *VISITS, "Delta_n holds for the offline set"),
    monotone={
        "S": rises("Gamma_T rises"),
        "A": rises("Gamma_T rises"),
        "H": rises("Gamma_T rises"),
        "T": rises("each part rises"),
        "d": rises("beta_T and Psi_T rise"),
        "gamma_min": falls("Gamma_T falls"),
        "delta_w": falls("beta_T falls"),
        "delta_F": falls("Psi_T falls"),
        "delta_P": _P_FALLS,
        "delta_M": _M_FALLS,
        "Delta_n": rises("it multiplies"),
    },
)
def regret_unknown_covered(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, S: Value, A: Value, H: Value, n: Value, T: Value,
    K: Value, gamma_min: Value, S_reach: Value, delta_w: Value, delta_F: Value, delta_P: Value, delta_M: Value,
    Delta_n: Value,
) -> Value:  # fmt: skip
    r"""Statement: ``regret_unknown_repaired`` with ``radius_sum_covered`` in place of ``radius_sum``.

    Source: audit R7, last line, and correction 4. Assumptions: as ``regret_unknown_repaired``, and minimum visitation
    with the coverage event of R10. Arguments: as there; ``gamma_min`` in (0, 1], ``S_reach`` a positive integer.
    Returns a regret. Errors: ``InputError``.

    >>> setting = dict(B=1, W=0.5, lam=8, d=1, S=5, A=4, H=8, n=10**6, K=1, T=10, gamma_min=0.1, S_reach=5)
    >>> chances = dict(delta_w=0.01, delta_F=0.01, delta_P=0.01, delta_M=0.01)
    >>> float(regret_unknown_covered.estimate(Delta_n=1, **chances, **setting))
    10.0
    """
    radii = radius_sum_covered(
        m, S=S, A=A, H=H, n=n, T=T, K=K, gamma_min=gamma_min, S_reach=S_reach, Delta_n=Delta_n,
        delta_P=delta_P, delta_M=delta_M,
    )  # fmt: skip
    return least(
        offline=twice_range(m, B, W, T) * Delta_n,
        online=_with_radius_sum(
            m, B=B, W=W, lam=lam, d=d, H=H, T=T, K=K, delta_w=delta_w, delta_F=delta_F, radii=radii
        ),
    )


@bound(
    title="regret with unknown dynamics from demonstrations of a deterministic expert",
    symbol=r"R_T",
    source="audit R7, R8(c)",
    group="regret",
    status="repaired",
    trivial=twice_range,
    spends=("delta_off", "delta_w", "delta_F", "delta_P", "delta_M"),
    words="the regret is at most {value}",
    assumptions=(
        *MODEL,
        *EVENT,
        _PLAY[1],
        DETERMINISTIC,
        "the expert is the best policy, and all policies are deterministic and stationary",
        "the offline set is every policy that agrees with all n independent demonstrations",
    ),
    monotone={
        "A": rises("Gamma_T rises"),
        "S": rises("Delta_n and Gamma_T rise"),
        "H": rises("Gamma_T rises"),
        "T": rises("each part rises"),
        "d": rises("beta_T and Psi_T rise"),
        "delta_off": falls("Delta_n falls"),
        "delta_w": falls("beta_T falls"),
        "delta_F": falls("Psi_T falls"),
        "delta_P": _P_FALLS,
        "delta_M": _M_FALLS,
    },
)
def regret_unknown_version_space(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, S: Value, A: Value, H: Value, n: Value, T: Value,
    K: Value, delta_off: Value, delta_w: Value, delta_F: Value, delta_P: Value, delta_M: Value,
) -> Value:  # fmt: skip
    r"""Statement: ``regret_unknown_repaired`` at :math:`\Delta_n=1-(\delta_{off}/(2^{|S|}-1))^{1/n}`.

    Source: audit R7 with the version space of R8(c) and T7(b), which needs no estimate of the dynamics. Assumptions: as
    ``regret_unknown_repaired`` and ``delta_n_version_space_sharp``. Arguments: as ``regret_unknown_repaired``, with
    ``delta_off`` in (0, 1) for ``Delta_n``. Returns a regret. Errors: ``InputError``.

    >>> setting = dict(B=1, W=0.5, lam=8, d=1, S=5, A=4, H=8, n=1000, K=1, T=1000, delta_off=0.05)
    >>> chances = dict(delta_w=0.01, delta_F=0.01, delta_P=0.01, delta_M=0.01)
    >>> round(float(regret_unknown_version_space.estimate(**chances, **setting)), 3)
    6.409
    """
    # the undecorated function, because it keeps the names of the terms
    return regret_unknown_repaired.function(
        m, B=B, W=W, lam=lam, d=d, S=S, A=A, H=H, n=n, T=T, K=K, delta_w=delta_w, delta_F=delta_F, delta_P=delta_P,
        delta_M=delta_M, Delta_n=delta_n_version_space_sharp(m, S=S, n=n, delta_off=delta_off),
    )  # fmt: skip
