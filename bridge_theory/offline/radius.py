"""The offline confidence set's radius as the paper states it: the main theorem, and with known dynamics."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total
from bridge_theory.offline.assumptions import (
    CLONE,
    DETERMINISTIC,
    FITTED,
    INDEPENDENT,
    MINIMUM_VISITATION,
    REALIZABLE,
    STATIONARY,
)
from bridge_theory.offline.confidence_set import confidence_set_radius
from bridge_theory.offline.policy_error import policy_error_corollary, policy_error_stated
from bridge_theory.offline.transition_error import transition_error_rate, transition_error_stated

_ASSUMED = (DETERMINISTIC, STATIONARY, INDEPENDENT, REALIZABLE, MINIMUM_VISITATION, CLONE, FITTED)
_WORDS = "the expert lies within Hellinger distance {value} of the cloned policy under the estimated dynamics"
_DIRECTIONS = {
    "S": rises("both errors rise"),
    "A": rises("both errors rise"),
    "H": rises("the transition error rises, and so does the factor sqrt(H ...)"),
    "n": falls("log(cn)/n falls on the integers for every c >= 2"),
    "delta": falls("both errors fall"),
    "gamma_min": falls("it divides"),
}


@bound(
    title="policy constant of the radius",
    symbol=r"\alpha",
    source="thm:tabular_confidence_set",
    group="offline",
    status="stated",
    words="alpha is {value}",
    monotone={
        "S": rises("it is under the root"),
        "A": rises("log rises"),
        "delta": falls("log(2A/delta) falls"),
    },
)
def alpha_offline(m: Arithmetic, *, S: Value, A: Value, delta: Value) -> Value:
    r"""Statement: :math:`\alpha=\sqrt{4|S|\log(2|A|/\delta)}`.

    Source: ``thm:tabular_confidence_set``. Assumptions: none, a definition. Arguments: ``S, A`` positive integers,
    ``delta`` in (0, 1). Returns a number without unit. Errors: ``InputError`` outside the domain.

    >>> round(float(alpha_offline.estimate(S=5, A=4, delta=0.05)), 4)
    10.0749
    """
    return m.sqrt(4 * S * m.log(2 * A / delta))


@bound(
    title="transition constant of the radius",
    symbol=r"\beta",
    source="thm:tabular_confidence_set",
    group="offline",
    status="stated",
    words="beta is {value}",
    monotone={
        "S": rises("it is under the root"),
        "A": rises("it is under the root"),
        "H": rises("log rises"),
        "n": rises("log rises"),
        "delta": falls("log(2nH/delta) falls"),
    },
)
def beta_offline(m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, delta: Value) -> Value:
    r"""Statement: :math:`\beta=\sqrt{4|S|^2|A|\log(2nH/\delta)}`.

    Source: ``thm:tabular_confidence_set``. Assumptions: none, a definition. Arguments: ``S, A, H, n`` positive
    integers, ``delta`` in (0, 1). Returns a number without unit. Errors: ``InputError`` outside the domain.

    >>> round(float(beta_offline.estimate(S=5, A=4, H=8, n=2, delta=0.05)), 3)
    50.839
    """
    return m.sqrt(4 * S**2 * A * m.log(2 * n * H / delta))


@bound(
    title="offline confidence-set radius",
    symbol=r"\mathrm{Radius}",
    source="thm:tabular_confidence_set",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_ASSUMED,
    monotone=_DIRECTIONS,
)
def offline_radius(m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, delta: Value, gamma_min: Value) -> Value:
    r"""Statement: with :math:`\alpha=\sqrt{4|S|\log(2|A|/\delta)}` and :math:`\beta=\sqrt{4|S|^2|A|\log(2nH/\delta)}`,

    .. math:: H(\hat P^{\pi^*},\hat P^{BC})\le\mathrm{Radius}=\frac{\alpha}{\sqrt n}+\frac{\beta}{\sqrt n}
       \Bigl(1+\sqrt{H\bigl(1+\tfrac{2\alpha}{\gamma_{\min}\sqrt n}\bigr)}\Bigr)\quad\text{w.p. }1-\delta.

    Source: ``thm:tabular_confidence_set``, repeated in the appendix's performance guarantees. Assumptions:
    deterministic stationary expert and stationary kernel, both realizable; minimum visitation ``gamma_min``.
    Arguments: ``S, A, H, n`` positive integers, ``delta`` in (0, 1), ``gamma_min`` in (0, 1]. Returns a Hellinger
    distance; vacuous from 1 on. Errors: ``InputError`` outside the domain.

    >>> round(float(offline_radius.estimate(S=5, A=4, H=8, n=2, delta=0.05, gamma_min=0.1)), 1)
    1261.0
    """
    alpha, beta, root = (
        alpha_offline(m, S=S, A=A, delta=delta),
        beta_offline(m, S=S, A=A, H=H, n=n, delta=delta),
        m.sqrt(n),
    )
    return total(
        policy=alpha / root,
        transition=beta / root,
        transfer=beta / root * m.sqrt(H * (1 + 2 * alpha / (gamma_min * root))),
    )


@bound(
    title="offline confidence-set radius, appendix version",
    symbol=r"\mathrm{Radius}",
    source="local:offline_radius_appendix",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_ASSUMED,
    monotone=_DIRECTIONS,
)
def offline_radius_appendix(
    m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, delta: Value, gamma_min: Value
) -> Value:
    r"""Statement: ``confidence_set_radius`` at :math:`R_1(\delta/2)` and :math:`R_2(\delta/2)`, the same number as
    ``offline_radius``.

    Source: ``local:offline_radius_appendix``. Assumptions: as for ``offline_radius``. Arguments:
    ``S, A, H, n`` positive integers, ``delta`` in (0, 1), ``gamma_min`` in (0, 1]. Returns a Hellinger distance;
    vacuous from 1 on. Errors: ``InputError`` outside the domain.

    >>> round(float(offline_radius_appendix.estimate(S=5, A=4, H=8, n=2, delta=0.05, gamma_min=0.1)), 1)
    1261.0
    """
    return confidence_set_radius(
        m,
        R1=policy_error_stated(m, S=S, A=A, n=n, delta1=delta / 2),
        R2=transition_error_stated(m, S=S, A=A, H=H, n=n, delta2=delta / 2),
        H=H,
        gamma_min=gamma_min,
    )


@bound(
    title="offline confidence-set radius with the corollaries' constant",
    symbol=r"\mathrm{Radius}",
    source="corr:stochastic_stationary_transition_tabular_setting",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_ASSUMED,
    monotone=_DIRECTIONS,
)
def offline_radius_corollaries(
    m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, delta: Value, gamma_min: Value
) -> Value:
    r"""Statement: ``confidence_set_radius`` with the constant 6 that the two cited corollaries have, where the
    theorem has 4.

    Source: ``corr:generalization_bound_logloss_BC_deterministic_stationary_tabular_policies`` and
    ``corr:stochastic_stationary_transition_tabular_setting`` with its :math:`C_{theory}\approx6`. Assumptions: as for
    ``offline_radius``. Arguments: ``S, A, H, n`` positive integers, ``delta`` in (0, 1), ``gamma_min`` in (0, 1].
    Returns a Hellinger distance; vacuous from 1 on. Errors: ``InputError`` outside the domain.

    >>> offline_radius_corollaries.estimate(S=5, A=4, H=8, n=229910, delta=0.05, gamma_min=0.1) < 1
    np.True_
    """
    return confidence_set_radius(
        m,
        R1=policy_error_corollary(m, S=S, A=A, n=n, delta=delta / 2),
        R2=6 * transition_error_rate(m, S=S, A=A, H=H, n=n, delta=delta / 2),
        H=H,
        gamma_min=gamma_min,
    )


@bound(
    title="offline radius under known dynamics",
    symbol=r"\mathrm{Radius}",
    source="lem:offline_CI_under_known_dyn",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words="the expert lies within Hellinger distance {value} of the cloned policy under the true dynamics",
    assumptions=(DETERMINISTIC, INDEPENDENT, CLONE, "the dynamics are known"),
    monotone={key: _DIRECTIONS[key] for key in ("S", "A", "n", "delta")},
)
def offline_radius_known(m: Arithmetic, *, S: Value, A: Value, n: Value, delta: Value) -> Value:
    r"""Statement: :math:`H(P_*^{\pi^*},P_*^{BC})\le\sqrt{6|S|\log(|A|/\delta)/n}` with probability at least
    :math:`1-\delta`.

    Source: ``lem:offline_CI_under_known_dyn``. Assumptions: deterministic stationary expert, known dynamics. Arguments:
    ``S, A, n`` positive integers, ``delta`` in (0, 1). Returns a Hellinger distance; vacuous from 1 on. Errors:
    ``InputError`` outside the domain.

    >>> round(float(offline_radius_known.estimate(S=5, A=4, n=1000, delta=0.05)), 4)
    0.3626
    """
    return m.sqrt(policy_error_corollary(m, S=S, A=A, n=n, delta=delta))
