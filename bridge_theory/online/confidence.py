"""Confidence ellipsoids for the preference weights: the paper's, and a certified one with a sharper radius."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, requires, rises, total
from bridge_theory.preference import NONNEGATIVE, kappa, kappa_differences, nonnegative_bound

MODEL = (
    "trajectory features have norm at most B and the preference weights norm at most W",
    "preferences follow the Bradley-Terry model of the sampled trajectories",
)
WITHIN_ROUNDS = requires(lambda t, T: t <= T, "t <= T (one of the T rounds)")
_LOG_RISES = rises("d log(1 + c/d) rises in d for every c >= 0")
_ANY_WEIGHTS = "the chosen weights have norm at most W; nothing is assumed about how they were found"
_RADIUS_MONOTONE = {
    "residual": rises("it is added"),
    "log_det_ratio": rises("beta_t rises"),
    "delta_w": falls("beta_t falls"),
    "lam": rises("beta_t rises at a fixed determinant ratio"),
    "B": rises("kappa and sqrt(kappa) rise"),
    "W": rises("kappa, sqrt(kappa) and W rise"),
}


@bound(
    title="preference confidence width, as stated",
    symbol=r"\beta_t(\delta)",
    source="local:beta_t",
    group="online",
    status="stated",
    words="the estimating equation is off by at most {value} in the data-matrix norm",
    spends=("delta",),
    assumptions=MODEL,
    monotone={"t": rises("the logarithm rises"), "d": _LOG_RISES, "delta": falls("log(1/delta) falls")},
)
def beta_t(m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, t: Value, delta: Value) -> Value:
    r"""Statement: :math:`\beta_t(\delta)=\sqrt\lambda W+\sqrt{\log(1/\delta)+2d\log(1+tB^2/(\kappa\lambda d))}`.

    Source: ``local:beta_t`` (below the definition of the ellipsoid), with the paper's ``kappa = 2 + 2 cosh(BW)``.
    Assumptions: bounded features and weights, Bradley-Terry model. The paper's proof uses ``kappa`` on feature
    differences, where it is too small; ``beta_repaired`` has a proof. Arguments: ``B, W, lam`` > 0, ``d, t`` positive
    integers, ``delta`` in (0, 1). Returns a number without unit. Errors: ``InputError``.

    >>> round(float(beta_t.estimate(B=1, W=1, lam=1, d=1, t=1, delta=0.05)), 4)
    2.8316
    """
    growth = m.log1p(t * B**2 / (kappa(m, B=B, W=W) * lam * d))
    return total(prior=m.sqrt(lam) * W, noise=m.sqrt(2 * d * growth - m.log(delta)))


@bound(
    title="radius of the preference ellipsoid, as stated",
    symbol=r"2\kappa\beta_t(\delta)",
    source="lemma:confidence_set_w_star",
    group="online",
    status="stated",
    trivial=None,
    words="in every round the true weights lie within {value} of the projected ones in the data-matrix norm",
    spends=("delta",),
    assumptions=MODEL,
    monotone={
        "t": rises("beta_t rises"),
        "d": _LOG_RISES,
        "delta": falls("log(1/delta) falls"),
        "B": rises("kappa rises, and kappa^2 log(1 + c/kappa) rises in c and in kappa"),
        "W": rises("kappa and W rise, and kappa^2 log(1 + c/kappa) rises in kappa"),
    },
)
def confidence_radius(m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, t: Value, delta: Value) -> Value:
    r"""Statement: :math:`\|w^*-w_t^{proj}\|_{V_t}\le2\kappa\beta_t(\delta)` for all ``t``, w.p. :math:`1-\delta`.

    Source: ``lemma:confidence_set_w_star``. Assumptions: as ``beta_t``. Arguments: as there. Errors: as there.
    Returns a distance in the norm of :math:`V_t`.

    >>> round(float(confidence_radius.estimate(B=1, W=1, lam=1, d=1, t=1, delta=0.05)), 3)
    28.804
    """
    return 2 * kappa(m, B=B, W=W) * beta_t(m, B=B, W=W, lam=lam, d=d, t=t, delta=delta)


@bound(
    title="preference confidence width, from the observed determinant",
    symbol=r"\beta_t",
    source="audit R1",
    group="online",
    status="repaired",
    words="the estimating equation is off by at most {value} in the data-matrix norm",
    spends=("delta_w",),
    assumptions=(*MODEL, "V_t sums over every comparison made, with exact features"),
    monotone={
        "log_det_ratio": rises("it is under the root"),
        "delta_w": falls("log(1/delta_w) falls"),
        "lam": rises("sqrt(lam) rises; the determinant ratio is a parameter of its own"),
    },
)
def beta_repaired_logdet(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, delta_w: Value, log_det_ratio: Value
) -> Value:
    r"""Statement: with :math:`\kappa=2+2\cosh(2BW)` and :math:`V_t=\kappa\lambda I+\sum_{l<t}x_lx_l^T`,

    .. math:: \|g_t(w^*)-s_t\|_{V_t^{-1}}\le\beta_t=\sqrt{\lambda/\kappa}\,W
       +\tfrac12\sqrt{2\log(1/\delta_w)+\log\det V_t/(\kappa\lambda)^d}\quad\text{for all }t.

    Source: audit R1 (Abbasi-Yadkori et al. 2011, Theorem 1, with 1/2-sub-Gaussian noise). Assumptions: bounded
    features and weights, Bradley-Terry model; any number of comparisons a round, all of them in :math:`V_t`.
    Arguments: ``B, W, lam`` > 0, ``delta_w`` in (0, 1), ``log_det_ratio`` = :math:`\log\det V_t/(\kappa\lambda)^d`
    >= 0. Returns a number without unit. Errors: ``InputError``.

    >>> round(float(beta_repaired_logdet.estimate(B=1, W=1, lam=1, delta_w=0.05, log_det_ratio=0)), 4)
    1.5479
    """
    return total(
        prior=m.sqrt(lam / kappa_differences(m, B=B, W=W)) * W,
        noise=m.sqrt(log_det_ratio - 2 * m.log(delta_w)) / 2,
    )


@bound(
    title="preference confidence width, in closed form",
    symbol=r"\beta_t",
    source="audit R1",
    group="online",
    status="repaired",
    words="the estimating equation is off by at most {value} in the data-matrix norm",
    spends=("delta_w",),
    assumptions=(*MODEL, "V_t sums over every comparison made, with exact features"),
    monotone={
        "t": rises("the logarithm rises"),
        "K": rises("the logarithm rises"),
        "d": _LOG_RISES,
        "delta_w": falls("log(1/delta_w) falls"),
    },
)
def beta_repaired(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, t: Value, K: Value, delta_w: Value
) -> Value:
    r"""Statement: ``beta_repaired_logdet`` with the determinant bounded by its trace,

    .. math:: \beta_t\le\sqrt{\lambda/\kappa}\,W+\tfrac12\sqrt{2\log(1/\delta_w)
       +d\log\bigl(1+4K(t-1)B^2/(\kappa\lambda d)\bigr)},\qquad\kappa=2+2\cosh(2BW).

    Source: audit R1 and its correction 6 (``K`` comparisons a round). Assumptions: as ``beta_repaired_logdet``.
    Arguments: ``B, W, lam`` > 0, ``d, t, K`` positive integers, ``delta_w`` in (0, 1). Returns a number without unit.
    Errors: ``InputError``.

    >>> round(float(beta_repaired.estimate(B=1, W=1, lam=1, d=1, t=1, K=1, delta_w=0.05)), 4)
    1.5479
    """
    growth = d * m.log1p(4 * K * (t - 1) * B**2 / (kappa_differences(m, B=B, W=W) * lam * d))
    return beta_repaired_logdet(m, B=B, W=W, lam=lam, delta_w=delta_w, log_det_ratio=growth)


@bound(
    title="radius of the preference ellipsoid around any weights",
    symbol=r"\rho_t",
    source="audit R1",
    group="online",
    status="repaired",
    words="in every round the true weights lie within {value} of the chosen ones in the data-matrix norm",
    spends=("delta_w",),
    assumptions=(*MODEL, _ANY_WEIGHTS),
    monotone=_RADIUS_MONOTONE,
)
def confidence_radius_repaired(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, delta_w: Value, log_det_ratio: Value, residual: Value
) -> Value:
    r"""Statement: for all ``t`` and every ``w`` with :math:`\|w\|\le W`, :math:`\|w-w^*\|_{V_t}\le\kappa(\beta_t+e_t)`,

    where :math:`e_t=\|g_t(w)-s_t\|_{V_t^{-1}}` is computable: a solver's error enters here and needs no trust.

    Source: audit R1. Assumptions: as ``beta_repaired_logdet``. Arguments: those of ``beta_repaired_logdet``, and
    ``residual`` = :math:`e_t` >= 0 (0 when the maximum-likelihood estimate lies in the ball; at most ``beta_t`` after
    an exact projection). Returns a distance in the norm of :math:`V_t`. Errors: ``InputError``.

    >>> radius = confidence_radius_repaired.estimate(B=1, W=1, lam=1, delta_w=0.05, log_det_ratio=0, residual=0)
    >>> round(float(radius), 3)
    14.743
    """
    scale = kappa_differences(m, B=B, W=W)
    width = beta_repaired_logdet(m, B=B, W=W, lam=lam, delta_w=delta_w, log_det_ratio=log_det_ratio)
    return total(statistical=scale * width, solver=scale * residual)


@bound(
    title="radius of the preference ellipsoid, nonnegative features",
    symbol=r"\rho_t",
    source="audit R1",
    group="online",
    status="sharp",
    words="in every round the true weights lie within {value} of the chosen ones in the data-matrix norm",
    spends=("delta_w",),
    assumptions=(*MODEL, NONNEGATIVE, _ANY_WEIGHTS),
    monotone=_RADIUS_MONOTONE,
)
def confidence_radius_nonnegative(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, delta_w: Value, log_det_ratio: Value, residual: Value
) -> Value:
    r"""Statement: ``confidence_radius_repaired`` with :math:`\kappa=2+2\cosh(\sqrt2BW)`, also in :math:`V_t`.

    Source: audit R1 with ``kappa_nonnegative``: its proof needs B only through :math:`\|x_l\|\le2B`. Assumptions: as
    there, and no feature is negative. Arguments: as ``confidence_radius_repaired``; ``log_det_ratio`` and ``residual``
    belong to the data matrix with this kappa. Returns a distance in the norm of :math:`V_t`. Errors: ``InputError``.

    >>> radius = confidence_radius_nonnegative.estimate(B=1, W=1, lam=1, delta_w=0.05, log_det_ratio=0, residual=0)
    >>> round(float(radius), 3)
    10.301
    """
    return confidence_radius_repaired.function(
        m, B=nonnegative_bound(m, B), W=W, lam=lam, delta_w=delta_w, log_det_ratio=log_det_ratio, residual=residual
    )
