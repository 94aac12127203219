"""Regret with unknown dynamics as the paper states it: the explicit lemma, with its bonus sums as arguments."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total
from bridge_theory.online.multiplier import gamma_unknown
from bridge_theory.online.norm_relation import gamma_known
from bridge_theory.regret.trivial import BOUNDED, twice_range

_EVENTS = (BOUNDED, "the five events of the containment proof hold together")
_GAMMA = {
    "d": rises("gamma_T rises"),
    "delta": falls("gamma_T falls at fixed bonus sums"),
    "B": rises("gamma_T rises"),
    "W": rises("gamma_T rises"),
    "bonus_square_sum": rises("gamma_T rises"),
}


@bound(
    title="preference multiplier from the true bonuses, as stated (Term 1)",
    symbol=r"\gamma_T",
    source="local:three_terms",
    group="regret",
    status="stated",
    spends=("delta",),
    failure=lambda m, delta: 5 * delta,
    words="the true weights lie within {value} of the projected ones in the norm of the estimated data matrix",
    assumptions=_EVENTS,
    monotone={
        **{name: rises("gamma_known rises") for name in ("d", "B", "W")},
        "H": rises("it multiplies"),
        "delta": falls("gamma_known falls; the bonus sum is a parameter of its own"),
        "epsilon": rises("it is added"),
        "bonus_square_sum": rises("it is under the root"),
    },
)
def gamma_true_bonus(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, H: Value, T: Value, delta: Value, epsilon: Value,
    bonus_square_sum: Value,
) -> Value:  # fmt: skip
    r"""Statement: :math:`\gamma_T=\sqrt2(4\kappa\beta_T+\alpha_{d,T})+\tfrac1T
    +4\sqrt{\sum_{i,t}B_t(\pi_t^i,4HWB,\delta,\varepsilon)^2+24T\varepsilon H^2WB}`.

    Source: ``local:three_terms`` (Term 1) and ``lemma:regret_analysis``. Assumptions: the events of the lemma.
    Arguments: ``B, W, lam, epsilon`` > 0, ``d, H, T`` positive integers, ``delta`` in (0, 1), ``bonus_square_sum`` >= 0
    the sum of the squared true bonuses. Returns a number without unit. Errors: ``InputError``.

    >>> setting = dict(B=1, W=1, lam=1, d=1, H=2, T=1, delta=0.05, epsilon=0.125, bonus_square_sum=4)
    >>> round(float(gamma_true_bonus.estimate(**setting)), 3)
    155.701
    """
    known = gamma_known(m, B=B, W=W, lam=lam, d=d, t=T, T=T, delta=delta)
    return total(
        preference=m.sqrt(m.number(2)) * known,
        net=1 / T,
        dynamics=4 * m.sqrt(bonus_square_sum + 24 * T * epsilon * H**2 * W * B),
    )


@bound(
    title="regret with unknown dynamics from the sums played, as stated",
    symbol=r"R_T",
    source="lemma:regret_analysis",
    group="regret",
    status="stated",
    trivial=twice_range,
    spends=("delta",),
    failure=lambda m, delta: 5 * delta,
    words="the regret is at most {value}",
    assumptions=_EVENTS,
    monotone={
        **_GAMMA,
        "H": rises("gamma_T rises"),
        "epsilon": rises("gamma_T rises"),
        "norm_sum": rises("it is under the root"),
        "bonus_sum": rises("it is added"),
    },
)
def regret_unknown_stated(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, H: Value, T: Value, delta: Value, epsilon: Value,
    bonus_square_sum: Value, norm_sum: Value, bonus_sum: Value,
) -> Value:  # fmt: skip
    r"""Statement: :math:`R_T\le2\gamma_T\sqrt{T\sum_t\|\hat\phi_t(\pi_t^1)-\hat\phi_t(\pi_t^2)\|_{\overline V_t^{-1}}}
    +\sum_{i,t}\widehat B_t(\pi_t^i,4WB,\delta)`.

    Source: ``lemma:regret_analysis``. The norm is not squared there, which is false unless the sum is at most ``T``
    (audit C.16); ``regret_unknown_squared`` has the square. Assumptions: the five events. Arguments: as
    ``gamma_true_bonus``; ``norm_sum`` >= 0 the sum of the unsquared norms, ``bonus_sum`` >= 0 the last sum. Returns a
    regret. Errors: ``InputError``.

    >>> setting = dict(B=1, W=1, lam=1, d=1, H=2, T=1, delta=0.05, epsilon=0.125, bonus_square_sum=4)
    >>> round(float(regret_unknown_stated.estimate(norm_sum=0.25, bonus_sum=3, **setting)), 3)
    158.701
    """
    multiplier = gamma_true_bonus(
        m, B=B, W=W, lam=lam, d=d, H=H, T=T, delta=delta, epsilon=epsilon, bonus_square_sum=bonus_square_sum
    )
    return total(preference=2 * multiplier * m.sqrt(T * norm_sum), dynamics=bonus_sum)


@bound(
    title="regret with unknown dynamics from the sums played, with the missing square",
    symbol=r"R_T",
    source="audit C.16",
    group="regret",
    status="stated",
    trivial=twice_range,
    spends=("delta",),
    failure=lambda m, T, delta: 4 * delta + delta * m.log(T) / m.log(m.number(2)),
    words="the regret is at most {value}",
    assumptions=(*_EVENTS, "the multiplier and the bonuses are those of the policy sets"),
    monotone={**_GAMMA, "potential": rises("it is under the root"), "bonus_sum": rises("it is added")},
)
def regret_unknown_squared(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, T: Value, delta: Value, bonus_square_sum: Value,
    potential: Value, bonus_sum: Value,
) -> Value:  # fmt: skip
    r"""Statement: :math:`R_T\le2\gamma_T
    \sqrt{T\sum_t\|\hat\phi_t(\pi_t^1)-\hat\phi_t(\pi_t^2)\|^2_{\overline V_t^{-1}}}
    +\sum_{i,t}\widehat B_t(\pi_t^i,4WB,\delta')` with ``gamma_unknown`` at ``T``.

    Source: audit C.16: from :math:`2r_t\le4\gamma_t\|\cdot\|+4\widehat B(1)+4\widehat B(2)` at eta = 2WB, and
    linearity in eta. Only the square is repaired: the multiplier is the paper's, whose events spend
    :math:`\delta(4+\log_2T)` where the paper counts :math:`5\delta` (audit C.12) and whose ``kappa`` and norm relation
    are not proved; ``regret_unknown_repaired`` is. Assumptions: the five events. Arguments: as ``gamma_unknown``;
    ``potential`` >= 0 the sum of the squared norms, ``bonus_sum`` >= 0 the last sum. Returns a regret. Errors:
    ``InputError``.

    >>> setting = dict(B=1, W=1, lam=1, d=1, T=1, delta=0.05, bonus_square_sum=0)
    >>> round(float(regret_unknown_squared.estimate(potential=0.25, bonus_sum=3, **setting)), 3)
    142.701
    """
    multiplier = gamma_unknown(m, B=B, W=W, lam=lam, d=d, t=T, T=T, delta=delta, bonus_square_sum=bonus_square_sum)
    return total(preference=2 * multiplier * m.sqrt(T * potential), dynamics=bonus_sum)
