"""Features from rollouts: how far sample means are off, and what that adds to a certified gap."""

from __future__ import annotations

from bridge_theory.answers.assumptions import BALL
from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total

_FRESH = "the rollouts are independent, their number was fixed, and coordinates lie in sure ranges"
_N = falls("it divides")
_DELTA = falls("the logarithm falls")


@bound(
    title="error of a mean of rollouts, from its sample variance",
    symbol=r"\varepsilon_j(\pi)",
    source="companion G7",
    group="answers",
    status="sharp",
    spends=("delta_phi",),
    words="each coordinate of each candidate's mean features is off by at most {value}",
    assumptions=(_FRESH, "the candidates were fixed before the rollouts"),
    monotone={
        "rollouts": _N,
        "sample_variance": rises("it is under the root"),
        "spread": rises("it multiplies"),
        "d": rises("the logarithm rises"),
        "candidates": rises("the logarithm rises"),
        "delta_phi": _DELTA,
    },
)
def bernstein_radius(
    m: Arithmetic, *, rollouts: Value, sample_variance: Value, spread: Value, d: Value, candidates: Value,
    delta_phi: Value,
) -> Value:  # fmt: skip
    r"""Statement: with probability :math:`1-\delta_\phi`, for all coordinates of all candidates at once,

    .. math:: |\hat\phi_j-\phi_j|\le\sqrt{\frac{2V_jL}N}+\frac{7R_jL}{3(N-1)},\qquad
       L=\log\frac{4d|\Pi|}{\delta_\phi}.

    Source: companion G7 (Maurer and Pontil 2009, two-sided). Assumptions: candidates fixed before ``N`` independent
    rollouts each. Arguments: ``rollouts`` = ``N`` >= 2, ``sample_variance`` = :math:`V_j` >= 0 with divisor ``N - 1``,
    ``spread`` = :math:`R_j` > 0 the length of the coordinate's sure range, ``d, candidates`` positive integers,
    ``delta_phi`` in (0, 1). Returns feature units. Errors: ``InputError``.

    >>> point = {"sample_variance": 0.25, "spread": 1, "d": 20, "candidates": 16, "delta_phi": 0.05}
    >>> [round(float(bernstein_radius.estimate(rollouts=N, **point)), 4) for N in (2000, 100000)]
    [0.0622, 0.0074]
    """
    level = m.log(4 * d * candidates / delta_phi)
    return total(
        variance=m.sqrt(2 * sample_variance * level / rollouts),
        range=7 * spread * level / (3 * (rollouts - 1)),
    )


@bound(
    title="what errors of the features add to a certified gap",
    symbol=r"W\|\varepsilon(\pi)+\varepsilon(\hat\pi)\|_2",
    source="companion G7",
    group="answers",
    status="sharp",
    words="errors of the features add at most {value} nats to the certified gap",
    assumptions=(BALL, "every coordinate is within its error"),
    monotone={"W": rises("it multiplies"), "error_norm": rises("it is multiplied by W")},
)
def rollout_gap(m: Arithmetic, *, W: Value, error_norm: Value) -> Value:
    r"""Statement: :math:`\langle\phi(\pi)-\phi(\hat\pi),w\rangle\le\langle\hat\phi(\pi)-\hat\phi(\hat\pi),w\rangle
    +W\|\varepsilon(\pi)+\varepsilon(\hat\pi)\|_2` for every ``w`` of norm at most ``W``.

    Source: companion G7 (Cauchy and Schwarz). Assumptions: every coordinate is within its ``bernstein_radius``.
    Arguments: ``W`` > 0, ``error_norm`` >= 0 the norm of the sum of both error vectors. Returns nats. Errors:
    ``InputError``.

    >>> float(rollout_gap.estimate(W=10, error_norm=0.125))
    1.25
    """
    return W * error_norm


@bound(
    title="failure probability of one of many looks",
    symbol=r"\frac{\delta_\phi}{k(k+1)}",
    source="companion G7",
    group="answers",
    status="sharp",
    words="the look may fail with probability {value}, and all looks together with no more than was planned",
    monotone={"delta_phi": rises("it multiplies"), "look": falls("it divides")},
)
def look_delta(m: Arithmetic, *, look: Value, delta_phi: Value) -> Value:
    r"""Statement: :math:`\sum_{k\ge1}\frac{\delta_\phi}{k(k+1)}=\delta_\phi`, so that the ``k``-th look with more
    rollouts may spend :math:`\delta_\phi/(k(k+1))`.

    Source: companion G7. Assumptions: none. Arguments: ``look`` = ``k`` a positive integer, ``delta_phi`` in (0, 1).
    Returns a probability. Errors: ``InputError``.

    >>> float(look_delta.estimate(look=3, delta_phi=0.06))
    0.005
    """
    return delta_phi / look / (look + 1)


@bound(
    title="what fresh rollouts add to the nominal advantage of a contender",
    symbol=r"\mathrm{EB}+\frac{\rho b}{\sqrt N}(1+\sqrt{2\log(2/\delta')})",
    source="companion G7'",
    group="answers",
    status="sharp",
    spends=("delta_phi",),
    words="the advantage of the contender exceeds the one of its sample mean by at most {value} nats",
    assumptions=(
        "the likelihood set, its ellipsoid, the recommendation and the contender were fixed before the rollouts",
        "the rollouts are independent and their number was fixed",
    ),
    monotone={
        "rollouts": _N,
        "sample_variance": rises("it is under the root"),
        "spread": rises("it multiplies"),
        "ellipsoid_radius": rises("it multiplies"),
        "feature_reach": rises("it multiplies"),
        "delta_phi": _DELTA,
    },
)
def fresh_rollout_gap(
    m: Arithmetic, *, rollouts: Value, sample_variance: Value, spread: Value, ellipsoid_radius: Value,
    feature_reach: Value, delta_phi: Value,
) -> Value:  # fmt: skip
    r"""Statement: for an ellipsoid :math:`\|w-m\|_A\le\rho` around :math:`C_t` and ``N`` fresh pairs of rollouts with
    differences :math:`y_i` of mean ``v``, with probability :math:`1-\delta'`

    .. math:: \max_{w\in C_t}\langle v,w\rangle\le\max_{w\in C_t}\langle\bar y,w\rangle+\sqrt{\frac{2VL}N}
       +\frac{7RL}{3(N-1)}+\frac{\rho b}{\sqrt N}\bigl(1+\sqrt{2\log(2/\delta')}\bigr),\qquad L=\log(4/\delta').

    Source: companion G7' (Maurer and Pontil 2009 for the middle, bounded differences for the rest). Assumptions:
    everything but the rollouts was fixed before them. Arguments: ``rollouts`` = ``N`` >= 2, ``sample_variance`` =
    ``V`` >= 0 of :math:`\langle y_i,m\rangle`, ``spread`` = ``R`` > 0 its sure range, ``ellipsoid_radius`` =
    :math:`\rho` >= 0, ``feature_reach`` = ``b`` >= 0 with :math:`\|y_i\|_{A^{-1}}\le b` surely, ``delta_phi`` =
    :math:`\delta'` in (0, 1). Returns nats. Errors: ``InputError``.

    >>> point = {"sample_variance": 4, "spread": 10, "ellipsoid_radius": 12, "feature_reach": 1.5, "delta_phi": 0.05}
    >>> round(float(fresh_rollout_gap.estimate(rollouts=2000, **point)), 4)
    1.6793
    """
    level = m.log(4 / delta_phi)
    return total(
        variance=m.sqrt(2 * sample_variance * level / rollouts),
        range=7 * spread * level / (3 * (rollouts - 1)),
        set=ellipsoid_radius * feature_reach * (1 + m.sqrt(2 * m.log(2 / delta_phi))) / m.sqrt(rollouts),
    )
