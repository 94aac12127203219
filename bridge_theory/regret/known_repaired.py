"""Regret with known dynamics, proved: an a-priori bound without hidden constants, and what the offline set adds."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, least, rises, total
from bridge_theory.offline.assumptions import DETERMINISTIC
from bridge_theory.online.confidence import MODEL, beta_repaired
from bridge_theory.online.norm_relation import norm_relation, supermartingale_factor
from bridge_theory.preference import kappa_differences
from bridge_theory.regret.offline_gain import delta_n_version_space_sharp
from bridge_theory.regret.potential import elliptical_norm_sum, elliptical_potential
from bridge_theory.regret.trivial import IN_SET, twice_range

_PLAY = (
    "the dynamics are known and both trajectories of a round follow them",
    "the best policy lies in the offline set",
    "each round plays the exact arg-max pair, after an exact projection, with exact policy features",
)
_D_RISES = rises("d log(1 + c/d) rises in d for every c >= 0")
_W_FALLS = falls("beta_T falls")
_F_FALLS = falls("log(1/delta_F) falls")


@bound(
    title="expected elliptical potential",
    symbol=r"\Psi_T",
    source="audit R5",
    group="regret",
    status="repaired",
    spends=("delta_F",),
    words="the squared norms of the expected feature differences sum to at most {value} in the observed data matrix",
    assumptions=MODEL[:1],
    monotone={"T": rises("the logarithm rises"), "d": _D_RISES, "delta_F": _F_FALLS, "lam": falls("a and c(a) fall")},
)
def expected_potential(m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, T: Value, delta_F: Value) -> Value:
    r"""Statement: for all ``T``, with :math:`a=4B^2/(\kappa\lambda)` and expected feature differences :math:`D_t`,

    .. math:: \sum_{t\le T}\|D_t\|^2_{V_t^{-1}}\le\Psi_T=\tfrac
    e{e-1}\bigl[c(a)\,d\log(1+4TB^2/(d\kappa\lambda))+a\log(1/\delta_F)\bigr].

    Source: audit R5 (a supermartingale for variables in [0, 1], then R3). With several comparisons a round the first
    of each round gives it. Assumptions: bounded features. Arguments: ``B, W, lam`` > 0, ``d, T`` positive integers,
    ``delta_F`` in (0, 1). Returns a number without unit. Errors: ``InputError``.

    >>> round(float(expected_potential.estimate(B=1, W=0.5, lam=1, d=3, T=1000, delta_F=0.05)), 3)
    39.575
    """
    start = kappa_differences(m, B=B, W=W) * lam
    potential = elliptical_potential(m, L=2 * B, v=start, d=d, square_sum=4 * T * B**2)
    factor = supermartingale_factor(m)
    return total(determinant=factor * potential, deviation=-factor * 4 * B**2 / start * m.log(delta_F))


@bound(
    title="a-priori regret with known dynamics",
    symbol=r"4\kappa\beta_T\sqrt{T\Psi_T}",
    source="audit R5",
    group="regret",
    status="repaired",
    trivial=twice_range,
    spends=("delta_w", "delta_F"),
    words="the regret is at most {value}",
    assumptions=(*MODEL, *_PLAY),
    monotone={
        "T": rises("beta_T and T Psi_T rise"),
        "K": rises("beta_T rises"),
        "d": rises("beta_T and Psi_T rise"),
        "delta_w": _W_FALLS,
        "delta_F": _F_FALLS,
    },
)
def regret_known_apriori(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, T: Value, K: Value, delta_w: Value, delta_F: Value
) -> Value:
    r"""Statement: :math:`R_T\le4\kappa\beta_T\sqrt{T\Psi_T}` for all ``T``, with :math:`\kappa=2+2\cosh(2BW)` and

    .. math:: \beta_T=\sqrt{\lambda/\kappa}\,W+\tfrac12\sqrt{2\log(1/\delta_w)+d\log(1+4KTB^2/(\kappa\lambda d))}.

    Source: audit R5 (Theorem K), corrections 3 and 6. Assumptions: R1's model; exact arg-max pairs and projection; the
    best policy in the offline set. Arguments: ``B, W, lam`` > 0, ``d, T, K`` positive integers, ``delta_w, delta_F`` in
    (0, 1). Returns a regret; it needs ``T`` near 4e4 (d = 1) to 8e6 (d = 20) to beat ``2BWT`` at BW = 1/2. Errors:
    ``InputError``.

    >>> setting = dict(B=1, W=0.5, lam=8, d=1, K=1, delta_w=0.025, delta_F=0.025)
    >>> round(float(regret_known_apriori.estimate(T=10**5, **setting)))
    68132
    """
    after = beta_repaired(m, B=B, W=W, lam=lam, d=d, t=T + 1, K=K, delta_w=delta_w)
    potential = expected_potential(m, B=B, W=W, lam=lam, d=d, T=T, delta_F=delta_F)
    return 4 * kappa_differences(m, B=B, W=W) * after * m.sqrt(T * potential)


@bound(
    title="regret with known dynamics",
    symbol=r"R_T",
    source="audit R5",
    group="regret",
    status="repaired",
    trivial=twice_range,
    spends=("delta_w", "delta_F"),
    words="the regret is at most {value}",
    assumptions=(*MODEL, *_PLAY, "the diameter and Delta_n hold for the offline set"),
    monotone={
        "T": rises("each part rises"),
        "K": rises("beta_T rises"),
        "d": rises("beta_T and Psi_T rise"),
        "delta_w": _W_FALLS,
        "delta_F": _F_FALLS,
        "diameter": rises("it multiplies"),
        "Delta_n": rises("it multiplies"),
    },
)
def regret_known_repaired(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, T: Value, K: Value, delta_w: Value, delta_F: Value,
    diameter: Value, Delta_n: Value,
) -> Value:  # fmt: skip
    r"""Statement: for all ``T``, :math:`R_T\le\min\{TWD_{off},2BWT\Delta_n,4\kappa\beta_T\sqrt{T\Psi_T}\}`.

    Source: audit R5; its fourth, data-dependent part is ``regret_width``. The failure probability of the offline set
    comes on top. Assumptions: as ``regret_known_apriori``. Arguments: as there; ``diameter`` >= 0 the largest
    :math:`\|\phi(\pi)-\phi(\pi')\|_2` in the offline set (at most 2B), ``Delta_n`` in [0, 1] (1 if nothing is known).
    Returns a regret. Errors: ``InputError``.

    >>> setting = dict(B=1, W=0.5, lam=8, d=1, K=1, delta_w=0.025, delta_F=0.025, diameter=2)
    >>> float(regret_known_repaired.estimate(T=1000, Delta_n=0.01, **setting))
    10.0
    """
    return least(
        diameter=T * W * diameter,
        offline=twice_range(m, B, W, T) * Delta_n,
        elliptical=regret_known_apriori(m, B=B, W=W, lam=lam, d=d, T=T, K=K, delta_w=delta_w, delta_F=delta_F),
    )


@bound(
    title="regret with known dynamics from demonstrations of a deterministic expert",
    symbol=r"R_T",
    source="audit R5, R8(c)",
    group="regret",
    status="repaired",
    trivial=twice_range,
    spends=("delta_off", "delta_w", "delta_F"),
    words="the regret is at most {value}",
    assumptions=(
        *MODEL,
        *_PLAY[::2],
        DETERMINISTIC,
        "the expert is the best policy, and all policies are deterministic and stationary",
        "the offline set is every policy that agrees with all n independent demonstrations",
    ),
    monotone={
        "T": rises("each part rises"),
        "n": falls("Delta_n falls"),
        "S": rises("Delta_n rises"),
        "K": rises("beta_T rises"),
        "d": rises("beta_T and Psi_T rise"),
        "delta_off": falls("Delta_n falls"),
        "delta_w": _W_FALLS,
        "delta_F": _F_FALLS,
    },
)
def regret_known_version_space(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, S: Value, n: Value, T: Value, K: Value,
    delta_off: Value, delta_w: Value, delta_F: Value,
) -> Value:  # fmt: skip
    r"""Statement: :math:`R_T\le\min\{2BWT,2BWT\Delta_n,4\kappa\beta_T\sqrt{T\Psi_T}\}` with
    :math:`\Delta_n=1-(\delta_{off}/(2^{|S|}-1))^{1/n}`.

    Source: audit R5 with the version space of R8(c) and T7(b): the trade-off between ``n`` demonstrations and ``T``
    queries. Assumptions: as ``regret_known_apriori`` and ``delta_n_version_space_sharp``. Arguments: ``B, W, lam`` > 0,
    ``d, S, n, T, K`` positive integers, ``delta_off, delta_w, delta_F`` in (0, 1). Returns a regret. Errors:
    ``InputError``.

    >>> setting = dict(B=1, W=0.5, lam=8, d=1, S=5, K=1, delta_off=0.05, delta_w=0.025, delta_F=0.025)
    >>> round(float(regret_known_version_space.estimate(n=1000, T=1000, **setting)), 3)
    6.409
    """
    return least(
        trivial=twice_range(m, B, W, T),
        offline=twice_range(m, B, W, T) * delta_n_version_space_sharp(m, S=S, n=n, delta_off=delta_off),
        elliptical=regret_known_apriori(m, B=B, W=W, lam=lam, d=d, T=T, K=K, delta_w=delta_w, delta_F=delta_F),
    )


@bound(
    title="regret with known dynamics, offline data inside the logarithm",
    symbol=r"Q",
    source="audit R5",
    group="regret",
    status="repaired",
    trivial=twice_range,
    spends=("delta_w", "delta_V"),
    words="the regret is at most {value}",
    assumptions=(*MODEL, IN_SET, "the policy sets and the arg-max use the expected data matrix", *_PLAY[::2]),
    monotone={
        "T": rises("both factors rise"),
        "d": rises("both factors rise"),
        "diameter": rises("c and the logarithm rise"),
        "delta_w": falls("gamma_T falls"),
        "delta_V": falls("gamma_T falls"),
    },
)
def regret_known_log(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, T: Value, delta_w: Value, delta_V: Value,
    diameter: Value,
) -> Value:  # fmt: skip
    r"""Statement: with :math:`\gamma_T=2\sqrt2\kappa\beta_T+\alpha'_T` and D the diameter of the offline set,

    .. math:: R_T\le2\gamma_T\sqrt{T\,c(D^2/(\kappa\lambda))\,d\log\bigl(1+TD^2/(d\kappa\lambda)\bigr)}.

    Source: audit R5 (the version for :math:`\overline V_t`), which repairs ``thm:main_known`` in its own form; it is
    never below ``elliptical_floor``. Assumptions: as ``norm_relation``; an algorithm whose sets and arg-max use
    :math:`\overline V_t`. Arguments: ``B, W, lam`` > 0, ``d, T`` positive integers, ``delta_w, delta_V`` in (0, 1),
    ``diameter`` >= 0 (``feature_difference_repaired``). Returns a regret. Errors: ``InputError``.

    >>> setting = dict(B=1, W=0.5, lam=1, d=3, delta_w=0.025, delta_V=0.025)
    >>> round(float(regret_known_log.estimate(T=1000, diameter=0.1, **setting)), 1)
    5348.3
    """
    multiplier = norm_relation(m, B=B, W=W, lam=lam, d=d, t=T, T=T, delta_w=delta_w, delta_V=delta_V)
    start = kappa_differences(m, B=B, W=W) * lam
    return 2 * multiplier * elliptical_norm_sum(m, L=diameter, v=start, d=d, T=T, square_sum=T * diameter**2)
