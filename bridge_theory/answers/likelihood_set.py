"""The likelihood set of the preference weights: how far below the best log-likelihood the true weights can lie."""

from __future__ import annotations

from bridge_theory.answers.assumptions import ANSWERS, PRIOR
from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total

_LOG_RISES = rises("d log(1 + c/d) rises in d for every c >= 0")
_ADDED = rises("it is added")


@bound(
    title="evidence of the answers, from any weights and a determinant",
    symbol=r"-Q_t",
    source="companion G1'",
    group="answers",
    status="sharp",
    words="the log-evidence of the answers is at least minus {value} nats",
    monotone={
        "loss": _ADDED,
        "weight_norm": rises("its square is added"),
        "lam": rises("it multiplies; the determinant is a parameter of its own"),
        "log_det_growth": _ADDED,
    },
)
def evidence_loss_logdet(m: Arithmetic, *, loss: Value, lam: Value, weight_norm: Value, log_det_growth: Value) -> Value:
    r"""Statement: with :math:`\nu=N(0,I/\lambda)` and :math:`S^{-1}=X^\top X/4+\lambda I`, for every ``m``,

    .. math:: \max_qQ_t(q)\ge Q_t(N(m,S))\ge\ell_t(m)-\tfrac\lambda2\|m\|^2
       -\tfrac12\log\det\bigl(I+X^\top X/(4\lambda)\bigr).

    Source: companion G1' (Kakade and Ng 2004). Assumptions: none, a property of the answers at hand. Arguments:
    ``loss`` = :math:`-\ell_t(m)` >= 0, ``lam`` > 0 the prior's precision, ``weight_norm`` = :math:`\|m\|` >= 0,
    ``log_det_growth`` >= 0, all at the same ``m`` and answers. Returns nats: an upper bound on :math:`-Q_t`. Errors:
    ``InputError``.

    >>> float(evidence_loss_logdet.estimate(loss=3, lam=2, weight_norm=0.5, log_det_growth=4))
    5.25
    """
    return total(answers=loss, prior=lam * weight_norm**2 / 2, dimension=log_det_growth / 2)


@bound(
    title="threshold of the likelihood set",
    symbol=r"-Q_t+\log(k/\delta)",
    source="companion G1'",
    group="answers",
    status="sharp",
    spends=("delta",),
    words="the true weights explain the answers with a log-likelihood of at least minus {value} nats",
    assumptions=(*ANSWERS, PRIOR),
    monotone={
        "evidence_loss": _ADDED,
        "scales": rises("log k is added"),
        "delta": falls("log(1/delta) falls"),
    },
)
def likelihood_threshold(m: Arithmetic, *, evidence_loss: Value, scales: Value, delta: Value) -> Value:
    r"""Statement: with probability :math:`1-\delta`, for all ``t`` and all densities ``q`` chosen after the answers,
    :math:`-\ell_t(w^*)\le-Q_t(q)+\log k+\log(1/\delta)`.

    Source: companion G1' (Gibbs and Ville): :math:`Q_t(q)=E_q\ell_t-\mathrm{KL}(q\|\nu)`, ``k`` prior scales in equal
    shares. Assumptions: Bradley-Terry answers to questions fixed before them, priors fixed before the answers.
    Arguments: ``evidence_loss`` = :math:`-Q_t` >= 0 for any one of the priors, ``scales`` = ``k`` a positive integer,
    ``delta`` in (0, 1). Returns nats: :math:`C_t` is where minus the log-likelihood is at most this. Errors:
    ``InputError``.

    >>> round(float(likelihood_threshold.estimate(evidence_loss=5.25, scales=1, delta=0.05)), 4)
    8.2457
    """
    return total(evidence=evidence_loss, scales=m.log(scales), confidence=-m.log(delta))


@bound(
    title="a-priori width of the likelihood set, from the observed determinant",
    symbol=r"\max_{\|m\|\le W}\ell_t(m)-\ell_t(w^*)",
    source="companion G1'",
    group="answers",
    status="sharp",
    spends=("delta",),
    words="the true weights are at most {value} nats less likely than the likeliest weights of the ball",
    assumptions=(*ANSWERS, PRIOR),
    monotone={
        "W": rises("its square is added"),
        "lam": rises("it multiplies; the determinant is a parameter of its own"),
        "log_det_growth": _ADDED,
        "scales": rises("log k is added"),
        "delta": falls("log(1/delta) falls"),
    },
)
def likelihood_width_logdet(
    m: Arithmetic, *, W: Value, lam: Value, log_det_growth: Value, scales: Value, delta: Value
) -> Value:
    r"""Statement: with probability :math:`1-\delta`, for all ``t`` and every ``m`` with :math:`\|m\|\le W`,

    .. math:: \ell_t(m)-\ell_t(w^*)\le\tfrac\lambda2W^2+\tfrac12\log\det\bigl(I+X^\top X/(4\lambda)\bigr)
       +\log k+\log(1/\delta).

    Source: companion G1'; no curvature constant enters. Assumptions: Bradley-Terry answers to questions fixed before
    them, prior precision ``lam`` one of ``k`` fixed before the answers. Arguments: ``W, lam`` > 0, ``log_det_growth``
    >= 0, ``scales`` = ``k`` a positive integer, ``delta`` in (0, 1). Returns nats. Errors: ``InputError``.

    >>> round(float(likelihood_width_logdet.estimate(W=1, lam=2, log_det_growth=4, scales=1, delta=0.05)), 4)
    5.9957
    """
    evidence = evidence_loss_logdet(m, loss=m.number(0), lam=lam, weight_norm=W, log_det_growth=log_det_growth)
    return likelihood_threshold(m, evidence_loss=evidence, scales=scales, delta=delta)


@bound(
    title="a-priori width of the likelihood set, in closed form",
    symbol=r"\max_{\|m\|\le W}\ell_t(m)-\ell_t(w^*)",
    source="companion G1'",
    group="answers",
    status="sharp",
    spends=("delta",),
    words="the true weights are at most {value} nats less likely than the likeliest weights of the ball",
    assumptions=(*ANSWERS, PRIOR, "trajectory features have norm at most B"),
    monotone={
        "d": _LOG_RISES,
        "t": rises("the logarithm rises"),
        "B": rises("the logarithm rises"),
        "W": rises("its square is added"),
        "scales": rises("log k is added"),
        "delta": falls("log(1/delta) falls"),
    },
)
def likelihood_width(
    m: Arithmetic, *, d: Value, t: Value, B: Value, W: Value, lam: Value, scales: Value, delta: Value
) -> Value:
    r"""Statement: ``likelihood_width_logdet`` with the determinant bounded by its trace, after ``t`` answers,

    .. math:: \ell_t(m)-\ell_t(w^*)\le\tfrac\lambda2W^2+\tfrac d2\log\Bigl(1+\frac{tB^2}{\lambda d}\Bigr)
       +\log k+\log(1/\delta).

    The width without kappa, to put beside ``beta_t``: this one is in nats of log-likelihood, that one in the
    data-matrix norm before kappa multiplies it. Source: companion G1'. Assumptions: as ``likelihood_width_logdet``,
    features of norm at most ``B``, so that differences have norm at most ``2B``. Arguments: ``d, t, scales`` positive
    integers, ``B, W, lam`` > 0, ``delta`` in (0, 1). Returns nats. Errors: ``InputError``.

    >>> point = {"d": 20, "B": 1, "W": 10, "lam": "0.2", "scales": 1, "delta": "0.05"}
    >>> [round(float(likelihood_width.estimate(t=t, **point)), 1) for t in (10, 40, 140)]
    [25.5, 37.0, 48.8]
    """
    growth = d * m.log1p(t * B**2 / (lam * d))
    return likelihood_width_logdet(m, W=W, lam=lam, log_det_growth=growth, scales=scales, delta=delta)
