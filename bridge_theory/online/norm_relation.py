"""From the observed data matrix to the expected one: what it costs to bound the weights in the latter's norm."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total
from bridge_theory.online.confidence import MODEL, WITHIN_ROUNDS, beta_repaired, beta_t
from bridge_theory.preference import kappa, kappa_differences

_PRECISION_EVENT = ("the expected data matrix is at most 2 V_T + 84 B^2 d log((1+2T)/delta) I",)
_BY_KAPPA = rises("kappa rises, and kappa^2 log(1 + c/kappa) rises in c and in kappa")
_LOG_RISES = rises("d log(1 + c/d) rises in d for every c >= 0")


@bound(
    title="shift between the data matrices, as stated",
    symbol=r"84B^2d\log\frac{1+2T}{\delta}",
    source="local:precision_event",
    group="online",
    status="stated",
    spends=("delta",),
    words="the expected data matrix is at most twice the observed one plus {value} times the identity",
    assumptions=("trajectory features have norm at most B",),
    monotone={
        "B": rises("it multiplies"),
        "d": rises("it multiplies"),
        "T": rises("the logarithm rises"),
        "delta": falls("log(1/delta) falls"),
    },
)
def matrix_shift(m: Arithmetic, *, B: Value, d: Value, T: Value, delta: Value) -> Value:
    r"""Statement: :math:`\overline V_T^{P^*}\preceq2V_T+84B^2d\log((1+2T)/\delta)I`; this is the coefficient of ``I``.

    Source: ``local:precision_event``, from Saha et al. 2023. Assumptions: bounded features. Arguments: ``B`` > 0, ``d,
    T`` positive integers, ``delta`` in (0, 1). Returns a squared feature norm. Errors: ``InputError``.

    >>> round(float(matrix_shift.estimate(B=1, d=1, T=1, delta=0.05)), 2)
    343.92
    """
    return 84 * B**2 * d * m.log((1 + 2 * T) / delta)


@bound(
    title="cost of the expected data matrix, as stated",
    symbol=r"\alpha_{d,T}(\delta)",
    source="lem:norm_relation_known_dyn",
    group="online",
    status="stated",
    spends=("delta",),
    failure=lambda m, T, delta: delta + delta * m.log(T) / m.log(m.number(2)),
    words="passing to the expected data matrix costs at most {value}",
    assumptions=(*MODEL, *_PRECISION_EVENT, "delta <= 1/e"),
    monotone={
        "B": rises("it multiplies"),
        "W": rises("it multiplies"),
        "d": rises("it is under the root"),
        "T": rises("the logarithm rises"),
        "delta": falls("log(1/delta) falls"),
    },
)
def alpha_dT(m: Arithmetic, *, B: Value, W: Value, d: Value, T: Value, delta: Value) -> Value:
    r"""Statement: :math:`\alpha_{d,T}(\delta)=20BW\sqrt{d\log(T(1+2T)/\delta)}`.

    Source: ``lem:norm_relation_known_dyn``. Assumptions: bounded features and weights, the precision event; the paper
    spends :math:`\delta+\delta\log_2T`. Arguments: ``B, W`` > 0, ``d, T`` positive integers, ``delta`` in (0, 1).
    Returns a number without unit. Errors: ``InputError``.

    >>> round(float(alpha_dT.estimate(B=1, W=1, d=1, T=1, delta=0.05)), 3)
    40.469
    """
    return 20 * B * W * m.sqrt(d * m.log(T * (1 + 2 * T) / delta))


@bound(
    title="preference multiplier with known dynamics, as stated",
    symbol=r"\gamma^{\mathrm{known}}_t",
    source="local:gamma_known",
    group="online",
    status="stated",
    spends=("delta",),
    failure=lambda m, T, delta: delta + delta * m.log(T) / m.log(m.number(2)),
    words="the true weights lie within {value} of the projected ones in the norm of the expected data matrix",
    assumptions=(*MODEL, *_PRECISION_EVENT, "delta <= 1/e"),
    conditions=(WITHIN_ROUNDS,),
    monotone={
        "t": rises("beta_t rises"),
        "T": rises("alpha rises"),
        "d": rises("beta_t and alpha rise"),
        "delta": falls("beta_t and alpha fall"),
        "B": _BY_KAPPA,
        "W": _BY_KAPPA,
    },
)
def gamma_known(m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, t: Value, T: Value, delta: Value) -> Value:
    r"""Statement: :math:`\|w^*-w_t\|_{\overline V_t^{P^*}}\le\gamma_t=4\kappa\beta_t(\delta)+\alpha_{d,T}(\delta)`.

    Source: ``local:gamma_known`` and ``lem:norm_relation_known_dyn``; audit C.5: for ``t < T`` it is not implied by the
    event the paper conditions on; ``norm_relation`` holds for all ``t``. Assumptions: as ``alpha_dT``. Arguments: ``B,
    W, lam`` > 0, ``d, t, T`` positive integers with ``t <= T``, ``delta`` in (0, 1). Returns a number without unit.
    Errors: ``InputError``.

    >>> round(float(gamma_known.estimate(B=1, W=1, lam=1, d=1, t=1, T=1, delta=0.05)), 3)
    98.077
    """
    return total(
        confidence=4 * kappa(m, B=B, W=W) * beta_t(m, B=B, W=W, lam=lam, d=d, t=t, delta=delta),
        sampling=alpha_dT(m, B=B, W=W, d=d, T=T, delta=delta),
    )


@bound(
    title="preference multiplier for the expected data matrix",
    symbol=r"\gamma_t",
    source="audit R9",
    group="online",
    status="repaired",
    spends=("delta_w", "delta_V"),
    words="in every round the true weights lie within {value} of the projected ones in the norm of the expected matrix",
    assumptions=(*MODEL, "the projection is exact", "one comparison a round"),
    conditions=(WITHIN_ROUNDS,),
    monotone={
        "t": rises("beta_t rises"),
        "T": rises("the logarithm rises"),
        "d": rises("both terms rise"),
        "delta_w": falls("beta_t falls"),
        "delta_V": falls("log(1/delta_V) falls"),
        "B": _BY_KAPPA,
        "W": _BY_KAPPA,
    },
)
def norm_relation(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, t: Value, T: Value, delta_w: Value, delta_V: Value
) -> Value:
    r"""Statement: for all ``t <= T``,

    .. math:: \|w_t-w^*\|_{\overline V_t}\le2\sqrt2\,\kappa\beta_t+\alpha'_T,\qquad
       \alpha'_T=2W\sqrt{27B^2d\log((1+2T)/\delta_V)}.

    Source: audit R9, which replaces Saha et al. 2023, Corollary 1. Assumptions: bounded features and weights,
    Bradley-Terry model, ``w_t`` an exact projection. Arguments: ``B, W, lam`` > 0, ``d, t, T`` positive integers with
    ``t <= T``, ``delta_w, delta_V`` in (0, 1). Returns a number without unit. Errors: ``InputError``.

    >>> round(float(norm_relation.estimate(B=1, W=1, lam=1, d=1, t=1, T=1, delta_w=0.05, delta_V=0.05)), 3)
    62.727
    """
    width = beta_repaired(m, B=B, W=W, lam=lam, d=d, t=t, K=m.number(1), delta_w=delta_w)
    return total(
        confidence=m.sqrt(m.number(8)) * kappa_differences(m, B=B, W=W) * width,
        sampling=2 * W * B * m.sqrt(27 * d * m.log((1 + 2 * T) / delta_V)),
    )


@bound(
    title="preference multiplier for the expected data matrix, before rounding its constants",
    symbol=r"\gamma_t",
    source="audit R9",
    group="online",
    status="sharp",
    spends=("delta_w", "delta_V"),
    words="in every round the true weights lie within {value} of the projected ones in the norm of the expected matrix",
    assumptions=(*MODEL, "the projection is exact", "one comparison a round"),
    conditions=(WITHIN_ROUNDS,),
    monotone={
        "t": rises("beta_t rises"),
        "T": rises("the logarithm rises"),
        "d": rises("both terms rise"),
        "delta_w": falls("beta_t falls"),
        "delta_V": falls("log(1/delta_V) falls"),
        "B": _BY_KAPPA,
        "W": _BY_KAPPA,
    },
)
def norm_relation_sharp(
    m: Arithmetic, *, B: Value, W: Value, lam: Value, d: Value, t: Value, T: Value, delta_w: Value, delta_V: Value
) -> Value:
    r"""Statement: with :math:`c=e/(e-1)`, for all ``t <= T``, :math:`\|w_t-w^*\|_{\overline V_t}` is at most

    .. math:: 2\sqrt c\,\kappa\beta_t+2W\sqrt{4cB^2(d\log(1+2T)+\log(1/\delta_V))+8(1+c)B^2}.

    Source: audit R9, the constants before they are rounded to 2 and 27. Assumptions: as
    ``norm_relation``. Arguments: as there. Errors: as there. Returns a number without unit.

    >>> round(float(norm_relation_sharp.estimate(B=1, W=1, lam=1, d=1, t=1, T=1, delta_w=0.05, delta_V=0.05)), 3)
    50.734
    """
    c = supermartingale_factor(m)
    width = beta_repaired(m, B=B, W=W, lam=lam, d=d, t=t, K=m.number(1), delta_w=delta_w)
    shift = 4 * c * (d * m.log(1 + 2 * T) - m.log(delta_V)) + 8 * (1 + c)
    return total(
        confidence=2 * m.sqrt(c) * kappa_differences(m, B=B, W=W) * width,
        sampling=2 * W * B * m.sqrt(shift),
    )


def supermartingale_factor(m: Arithmetic) -> Value:
    r""":math:`e/(e-1)`: sums of conditional means are at most this times the sum plus ``log(1/delta)`` (audit R5).

    >>> from bridge_theory.arithmetic.floats import FLOATS
    >>> round(float(supermartingale_factor(FLOATS)), 4)
    1.582
    """
    return -1 / m.expm1(m.number(-1))
