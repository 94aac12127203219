"""The dual certificate: what the likelihood set allows in one direction, the certified gap, and the share gained."""

from __future__ import annotations

from bridge_theory.answers.assumptions import ANSWERS, BALL, LIKELIHOOD_SET, OFFLINE_SET, PRIOR
from bridge_theory.answers.likelihood_set import likelihood_threshold
from bridge_theory.core import Arithmetic, Value, bound, falls, requires, rises, total


@bound(
    title="dual certificate of one direction",
    symbol=r"\max_{w\in C_t,\|w\|\le W}\langle v,w\rangle",
    source="companion G2",
    group="answers",
    status="sharp",
    spends=("delta",),
    words="the true weights value the direction at no more than {value} nats",
    assumptions=(*ANSWERS, PRIOR, BALL),
    monotone={
        "evidence_loss": rises("it is multiplied by c >= 0"),
        "scales": rises("log k is multiplied by c >= 0"),
        "loss": falls("the log-likelihood at w0 is multiplied by c >= 0"),
        "slope": falls("it is multiplied by -c <= 0"),
        "W": rises("it multiplies a norm"),
        "dual_norm": rises("it is multiplied by W"),
        "delta": falls("log(1/delta) is multiplied by c >= 0"),
    },
)
def dual_certificate(
    m: Arithmetic, *, multiplier: Value, loss: Value, slope: Value, evidence_loss: Value, scales: Value,
    W: Value, dual_norm: Value, delta: Value,
) -> Value:  # fmt: skip
    r"""Statement: for every direction ``v``, every point :math:`w_0`, inside the ball or not, and every
    :math:`c\ge0`,

    .. math:: \max_{w\in C_t,\|w\|\le W}\langle v,w\rangle\le c\bigl(\ell_t(w_0)-\langle\nabla\ell_t(w_0),w_0\rangle
       -Q_t+\log(k/\delta)\bigr)+W\|v+c\nabla\ell_t(w_0)\|_2.

    Source: companion G2; with the cones of the demonstrations ``v`` is replaced by
    :math:`v+\sum_k\mu_k(\phi(\pi)-\phi(\pi_k))`, :math:`\mu_k\ge0`. Assumptions: those of the likelihood set, weights
    of norm at most ``W``; no trust in whoever found :math:`w_0` and ``c``. Arguments: ``multiplier`` = ``c`` >= 0,
    ``loss`` = :math:`-\ell_t(w_0)` >= 0, ``slope`` = :math:`\langle\nabla\ell_t(w_0),w_0\rangle`, ``evidence_loss`` =
    :math:`-Q_t` >= 0, ``scales`` = ``k`` a positive integer, ``W`` > 0, ``dual_norm`` =
    :math:`\|v+c\nabla\ell_t(w_0)\|` >= 0, ``delta`` in (0, 1). Returns nats. Errors: ``InputError``.

    >>> values = {"loss": 7, "slope": "0.5", "evidence_loss": 12, "scales": 1, "W": 10, "delta": "0.05"}
    >>> round(float(dual_certificate.estimate(multiplier=0.01, dual_norm=0.02, **values)), 4)
    0.275
    """
    threshold = likelihood_threshold(m, evidence_loss=evidence_loss, scales=scales, delta=delta)
    return total(likelihood=multiplier * (threshold - loss - slope), ball=W * dual_norm)


@bound(
    title="certified gap of a recommendation",
    symbol=r"G_t",
    source="companion G3",
    group="answers",
    status="sharp",
    words="the recommended policy is at most {value} nats below the best one",
    assumptions=(LIKELIHOOD_SET, BALL, OFFLINE_SET, "the likelihood set meets the ball (if not, the model is refuted)"),
    monotone={"advantage": rises("the larger of it and zero rises")},
)
def certified_gap(m: Arithmetic, *, advantage: Value) -> Value:
    r"""Statement: on the events of the offline set and of the likelihood set, whatever the recommendation and whenever
    asking stops,

    .. math:: U(\pi^*)-U(\hat\pi)\le G_t=\max\Bigl(0,\max_{\pi\in\Pi_{off}}\max_{w\in C_t,\|w\|\le W}
       \langle\phi(\pi)-\phi(\hat\pi),w\rangle\Bigr).

    Source: companion G3. Assumptions: the true weights lie in the likelihood set and the ball, the best policy is a
    candidate, the set is not empty. Arguments: ``advantage``, the largest bound of ``dual_certificate`` over **all**
    candidates. Returns nats. Errors: ``InputError``.

    >>> float(certified_gap.estimate(advantage=0.25)), float(certified_gap.estimate(advantage=-3))
    (0.25, 0.0)
    """
    return m.max(advantage, 0)


@bound(
    title="share of the possible gain over a reference policy",
    symbol=r"\frac{U(\hat\pi)-U(\pi_0)}{U(\pi^*)-U(\pi_0)}",
    source="companion G3'",
    group="answers",
    status="sharp",
    words="the recommended policy gains at least the share {at_least} of what there is to gain over the reference",
    assumptions=(LIKELIHOOD_SET, OFFLINE_SET, "the best policy is better than the reference"),
    monotone={"shortfall": falls("it divides")},
)
def share_gained(m: Arithmetic, *, shortfall: Value) -> Value:
    r"""Statement: if :math:`\max_{w}\langle\phi(\pi)-\phi(\hat\pi)-\rho(\phi(\hat\pi)-\phi(\pi_0)),w\rangle\le0` for
    every candidate, then :math:`U(\hat\pi)-U(\pi_0)\ge\frac1{1+\rho}(U(\pi^*)-U(\pi_0))`.

    Source: companion G3'; the conclusion has no scale. Assumptions: the true weights lie in the likelihood set, the
    best policy is a candidate and better than the reference. Arguments: ``shortfall`` = :math:`\rho` > 0. Returns a
    share in (0, 1). Errors: ``InputError``.

    >>> float(share_gained.estimate(shortfall=0.25))
    0.8
    """
    return 1 / (1 + shortfall)


@bound(
    title="likelihood at a distance, below which the ball is not needed",
    symbol=r"b+\|\nabla\ell_t\|r-\frac{r^2}2\lambda_{\min}(A_r)",
    source="companion G3'",
    group="answers",
    status="repaired",
    words="at this distance the log-likelihood exceeds the threshold by at most {value}; below 0 the set ends there",
    assumptions=("the weights in the middle lie in the likelihood set themselves",),
    conditions=(requires(lambda slack: slack >= 0, "slack >= 0, weights that lie in the likelihood set themselves"),),
    monotone={
        "slack": rises("it is added"),
        "gradient_norm": rises("it is multiplied by r"),
        "least_curvature": falls("it is subtracted"),
    },
)
def confinement_margin(
    m: Arithmetic, *, slack: Value, gradient_norm: Value, reach: Value, least_curvature: Value
) -> Value:
    r"""Statement: for :math:`\hat w\in C_t`, so that :math:`b=\ell_t(\hat w)-Q_t+\log(1/\delta)\ge0`, and one
    ``r`` with

    .. math:: b+\|\nabla\ell_t(\hat w)\|r-\tfrac{r^2}2\lambda_{\min}(A_r)<0,\qquad
       A_r=\sum_s\sigma'(z_s)\,2\frac{e^{-r\|x_s\|}+r\|x_s\|-1}{(r\|x_s\|)^2}x_sx_s^\top,

    all of :math:`C_t` lies within ``r`` of :math:`\hat w`, and no bound on the weights is needed. Source: companion
    G3', with the hypothesis :math:`\hat w\in C_t` that its text leaves out (for :math:`b<0` it is false). Assumptions:
    the middle lies in the likelihood set. Arguments: ``slack`` = ``b`` >= 0, ``gradient_norm`` >= 0, ``reach`` = ``r``
    > 0, ``least_curvature`` >= 0. Returns nats; only the sign matters. Errors: ``InputError`` if ``slack`` < 0.

    >>> float(confinement_margin.estimate(slack=6, gradient_norm=0, reach=4, least_curvature=1))
    -2.0
    """
    return total(middle=slack, gradient=gradient_norm * reach, curvature=-(least_curvature * reach**2 / 2))
