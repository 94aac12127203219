"""The preference multiplier gamma_t with unknown dynamics, and the failure probabilities its parts are given."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total
from bridge_theory.online.confidence import MODEL, WITHIN_ROUNDS
from bridge_theory.online.norm_relation import gamma_known, norm_relation
from bridge_theory.preference import kappa

_BONUS_RISES = rises("it is under the root")


@bound(
    title="preference multiplier with unknown dynamics, as stated",
    symbol=r"\gamma_t",
    source="local:gamma_unknown",
    group="online",
    status="stated",
    spends=("delta",),
    failure=lambda m, delta: 5 * delta,
    words="the true weights lie within {value} of the projected ones in the norm of the estimated data matrix",
    assumptions=(*MODEL, "the five events of the containment proof hold together"),
    conditions=(WITHIN_ROUNDS,),
    monotone={
        "bonus_square_sum": _BONUS_RISES,
        "T": rises("alpha rises"),
        "d": rises("beta_t and alpha rise"),
        "delta": falls("beta_t and alpha fall; the bonus sum is a parameter of its own"),
        "B": rises("gamma_known rises"),
        "W": rises("gamma_known rises"),
    },
)
def gamma_unknown(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, t: Value, T: Value, delta: Value,
    bonus_square_sum: Value,
) -> Value:  # fmt: skip
    r"""Statement: :math:`\gamma_t=\sqrt2(4\kappa\beta_t+\alpha_{d,T})
    +2\sqrt{\sum_i\sum_{l<t}\widehat B_l(\pi_l^i,2WB,\delta'/(8l^3|A|^{|S|}))^2}+1/t`.

    Source: ``local:gamma_unknown`` (appendix, the policy set); the norm relation ``lem:estimated_norm_relation`` leaves
    its policy free, which this sum repairs (audit C.6). Assumptions: the events of the containment proof. Arguments:
    ``B, W, lam`` > 0, ``d, t, T`` positive integers with ``t <= T``, ``delta`` in (0, 1), ``bonus_square_sum`` >= 0
    the sum of the squared empirical bonuses at the failure probabilities ``step_bonus_delta``. Returns a number without
    unit. Errors: ``InputError``.

    >>> round(float(gamma_unknown.estimate(B=1, W=1, lam=1, d=1, t=1, T=1, delta=0.05, bonus_square_sum=0)), 3)
    139.701
    """
    known = gamma_known(m, B=B, W=W, lam=lam, d=d, t=t, T=T, delta=delta)
    return total(preference=m.sqrt(m.number(2)) * known, dynamics=2 * m.sqrt(bonus_square_sum), net=1 / t)


@bound(
    title="preference multiplier with unknown dynamics",
    symbol=r"\gamma_t",
    source="audit C.6",
    group="online",
    status="repaired",
    spends=("delta_w", "delta_V", "delta_P"),
    words="the true weights lie within {value} of the projected ones in the norm of the estimated data matrix",
    assumptions=(
        *MODEL,
        "the projection is exact",
        "one comparison a round",
        "transitions come from the real dynamics",
    ),
    conditions=(WITHIN_ROUNDS,),
    monotone={
        "bonus_square_sum": _BONUS_RISES,
        "t": rises("norm_relation rises"),
        "T": rises("norm_relation rises"),
        "d": rises("norm_relation rises"),
        "delta_w": falls("norm_relation falls"),
        "delta_V": falls("norm_relation falls"),
        "B": rises("norm_relation rises"),
        "W": rises("norm_relation rises"),
    },
)
def gamma_unknown_repaired(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, t: Value, T: Value, delta_w: Value, delta_V: Value,
    delta_P: Value, bonus_square_sum: Value,
) -> Value:  # fmt: skip
    r"""Statement: for all ``t <= T``, :math:`\|w_t-w^*\|_{\overline V_t}\le\sqrt2\,(2\sqrt2\kappa\beta_t+\alpha'_T)
    +2\sqrt{\sum_i\sum_{l<t}b_l(\pi_l^i)^2}`.

    Source: audit C.6 with R9 and R6: on the L1 event the inequality holds for every vector of norm at most ``2W``, so
    no net and no ``1/t``. Assumptions: as ``norm_relation`` and ``bonus_radius``. Arguments: as ``norm_relation``;
    ``delta_P`` in (0, 1), and ``bonus_square_sum`` >= 0 the sum of the squared ``transition_bonus`` at ``eta`` = 2WB.
    Returns a number without unit. Errors: ``InputError``.

    >>> gamma = gamma_unknown_repaired.estimate(
    ...     B=1, W=1, lam=1, d=1, t=1, T=1, delta_w=0.05, delta_V=0.05, delta_P=0.05, bonus_square_sum=4)
    >>> round(float(gamma), 3)
    92.71
    """
    known = norm_relation(m, B=B, W=W, lam=lam, d=d, t=t, T=T, delta_w=delta_w, delta_V=delta_V)
    return total(preference=m.sqrt(m.number(2)) * known, dynamics=2 * m.sqrt(bonus_square_sum))


@bound(
    title="failure probability of each bonus in the policy set",
    symbol=r"\delta'",
    source="lem:online_confidence_set",
    group="online",
    status="stated",
    words="each bonus of the policy set may fail with probability {value}",
    monotone={"delta": rises("it multiplies"), "A": falls("it divides"), "S": falls("the power of A divides")},
)
def online_bonus_delta(m: Arithmetic, *, S: Value, A: Value, delta: Value) -> Value:
    r"""Statement: :math:`\delta'=\delta^{online}/(2|A|^{|S|})`.

    Source: ``lem:online_confidence_set``. Assumptions: none, a definition. Arguments: ``S, A`` positive integers,
    ``delta`` in (0, 1). Returns a probability. Errors: ``InputError``.

    >>> float(online_bonus_delta.estimate(S=2, A=4, delta=0.5))
    0.015625
    """
    return delta / (2 * m.power(A, S))


@bound(
    title="scale of the net in the norm relation",
    symbol=r"\varepsilon_t",
    source="lem:estimated_norm_relation",
    group="online",
    status="stated",
    words="the net of weights in round t has scale {value}",
    monotone={
        "t": falls("it divides"),
        "lam": falls("it divides"),
        "B": falls("B and kappa divide"),
        "W": falls("kappa divides"),
    },
)
def net_scale(m: Arithmetic, *, B: Value, W: Value, lam: Value, t: Value) -> Value:
    r"""Statement: :math:`\varepsilon=1/(t^2\kappa\lambda+4B^2t^3)`.

    Source: ``lem:estimated_norm_relation``. Assumptions: none, a definition. Arguments: ``B, W, lam`` > 0, ``t`` a
    positive integer. Returns a weight norm. Errors: ``InputError``.

    >>> round(float(net_scale.estimate(B=1, W=1, lam=1, t=1)), 5)
    0.11006
    """
    return 1 / (t**2 * kappa(m, B=B, W=W) * lam + 4 * B**2 * t**3)


@bound(
    title="failure probability left after the net",
    symbol=r"\delta'",
    source="lem:estimated_norm_relation",
    group="online",
    status="stated",
    words="each point of the net may fail with probability {value}",
    monotone={
        "delta": rises("it multiplies"),
        "epsilon": rises("the net shrinks"),
        "W": falls("the net grows"),
        "d": falls("the net grows"),
    },
)
def net_delta(m: Arithmetic, *, W: Value, d: Value, epsilon: Value, delta: Value) -> Value:
    r"""Statement: :math:`\delta'=\delta/(1+4W/\varepsilon)^d`.

    Source: ``lem:estimated_norm_relation``. Assumptions: none, a definition. Arguments: ``W`` > 0, ``d`` a positive
    integer, ``epsilon`` > 0 (``net_scale``), ``delta`` in (0, 1). Returns a probability. Errors: ``InputError``.

    >>> float(net_delta.estimate(W=1, d=2, epsilon=4, delta=0.5))
    0.125
    """
    return delta / m.power(1 + 4 * W / epsilon, d)


@bound(
    title="failure probability of one step's bonus",
    symbol=r"\delta'/(8t^3|\mathcal A|^{|\mathcal S|})",
    source="lem:estimated_norm_relation",
    group="online",
    status="stated",
    words="the bonus of round t may fail with probability {value}",
    monotone={
        "delta": rises("it multiplies"),
        "t": falls("it divides"),
        "A": falls("it divides"),
        "S": falls("the power of A divides"),
    },
)
def step_bonus_delta(m: Arithmetic, *, S: Value, A: Value, t: Value, delta: Value) -> Value:
    r"""Statement: :math:`\delta'/(8l^3|A|^{|S|})`, the failure probability given to round ``l`` (here ``t``).

    Source: ``lem:estimated_norm_relation``. Assumptions: none, a definition. Arguments: ``S, A, t`` positive integers,
    ``delta`` in (0, 1) (``net_delta``). Returns a probability. Errors: ``InputError``.

    >>> float(step_bonus_delta.estimate(S=1, A=2, t=2, delta=0.5))
    0.00390625
    """
    return delta / (8 * t**3 * m.power(A, S))
