"""Without a model of utility: how well the answers about one pair fix how often it is preferred."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises


@bound(
    title="width of the betting confidence sequence of a pair",
    symbol=r"|\hat p_t(i,j)-p(i,j)|",
    source="companion G10",
    group="answers",
    status="sharp",
    trivial=1,
    spends=("delta",),
    words="each pair's observed frequency of preference is off by at most {value} at all times",
    assumptions=(
        "both trajectories are fresh draws in random position, and preference between two candidates is stationary",
    ),
    monotone={"pairs": rises("the logarithm rises"), "delta": falls("the logarithm falls")},
)
def preference_width(m: Arithmetic, *, t: Value, pairs: Value, delta: Value) -> Value:
    r"""Statement: with probability :math:`1-\delta`, for all pairs at all times, after ``t`` answers about the pair,

    .. math:: |\hat p_t-p|\le\sqrt{\frac{\log(t+1)+\log(\text{pairs}/\delta)}{2t}}.

    Source: companion G10, the uniform mixture of bets in closed form: :math:`\int_0^1\theta^s(1-\theta)^{t-s}d\theta
    /(p^s(1-p)^{t-s})` is a martingale of mean 1 and at least :math:`e^{t\,\mathrm{kl}(\hat p,p)}/(t+1)`; then Pinsker.
    Assumptions: fresh draws, random position, stationary preference; any adaptive asking. Arguments: ``t, pairs``
    positive integers, ``delta`` in (0, 1). Returns a probability. Errors: ``InputError``.

    >>> [round(float(preference_width.estimate(t=t, pairs=3, delta=0.05)), 4) for t in (100, 1000)]
    [0.2087, 0.0742]
    """
    return m.sqrt((m.log(t + 1) + m.log(pairs / delta)) / (2 * t))
