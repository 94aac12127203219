"""From two estimation errors to the radius of a set that contains the expert."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total
from bridge_theory.offline.assumptions import (
    CLONE,
    DETERMINISTIC,
    FITTED,
    INDEPENDENT,
    MINIMUM_VISITATION,
    REALIZABLE,
    ROWS,
    STATIONARY,
)
from bridge_theory.offline.concentrability import concentrability_stated
from bridge_theory.offline.policy_error import policy_error_repaired, policy_error_sharp
from bridge_theory.offline.transition_error import transition_error_repaired

_WORDS = "the expert lies within Hellinger distance {value} of the cloned policy under the estimated dynamics"
_ERRORS = "R1 and R2 bound the two squared Hellinger errors"
_TWO = {"R1": rises("it is under a root"), "R2": rises("it is under a root")}
_TABULAR = (DETERMINISTIC, STATIONARY, INDEPENDENT, REALIZABLE, CLONE, FITTED, ROWS)
_COMPOSED = {
    "S": rises("both errors rise"),
    "rows": rises("the transition error rises"),
    "H": rises("the transition error rises"),
    "n": falls("both errors fall"),
    "delta": falls("both errors fall"),
}


@bound(
    title="radius from two errors",
    symbol=r"\mathrm{Radius}(R_1, R_2)",
    source="lemma:confidence_set_construction_main",
    group="offline",
    status="stated",
    trivial=1,
    words=_WORDS,
    assumptions=(_ERRORS, MINIMUM_VISITATION),
    monotone={**_TWO, "H": rises("it is under a root"), "gamma_min": falls("it divides")},
)
def confidence_set_radius(m: Arithmetic, *, R1: Value, R2: Value, H: Value, gamma_min: Value) -> Value:
    r"""Statement: :math:`H(\hat P^{\pi^*},\hat
    P^{BC})\le\sqrt{R_1}+\sqrt{R_2}\bigl(1+\sqrt{H(1+2\sqrt{R_1}/\gamma_{\min})}\bigr)`.

    Source: ``lemma:confidence_set_construction_main`` and, in the appendix, ``lemma:confidence_set_construction``.
    Assumptions: ``R1``, ``R2`` bound the squared Hellinger errors; minimum visitation. Arguments: ``R1, R2 >= 0``,
    ``H`` positive integer, ``gamma_min`` in (0, 1]. Returns a Hellinger distance; vacuous from 1 on. Errors:
    ``InputError``.

    >>> float(confidence_set_radius.estimate(R1=0.25, R2=0.25, H=1, gamma_min=1))
    1.7071067811865475
    """
    transfer = H * concentrability_stated(m, R=R1, gamma_min=gamma_min)
    return total(policy=m.sqrt(R1), transition=m.sqrt(R2), transfer=m.sqrt(R2 * transfer))


@bound(
    title="radius from two errors, any policies",
    symbol=r"\mathrm{Radius}(R_1, R_2)",
    source="audit T9",
    group="offline",
    status="repaired",
    trivial=1,
    words=_WORDS,
    assumptions=(_ERRORS,),
    monotone=_TWO,
)
def confidence_set_radius_repaired(m: Arithmetic, *, R1: Value, R2: Value) -> Value:
    r"""Statement: for all policies, :math:`H(\hat P^{\pi^*},\hat P^{BC})\le\sqrt{R_1}+2\sqrt{R_2}`.

    Source: audit T9; no horizon, no minimum visitation. Assumptions: ``R1``, ``R2`` bound the squared Hellinger errors.
    Arguments: ``R1, R2 >= 0``. Returns a Hellinger distance; vacuous from 1 on. Errors: ``InputError``.

    >>> float(confidence_set_radius_repaired.estimate(R1=0.25, R2=0.0625))
    1.0
    """
    return total(policy=m.sqrt(R1), transition=2 * m.sqrt(R2))


@bound(
    title="radius from two errors, deterministic policies",
    symbol=r"\mathrm{Radius}(R_1, R_2)",
    source="audit T9",
    group="offline",
    status="repaired",
    trivial=1,
    words=_WORDS,
    assumptions=(_ERRORS, "the expert and the cloned policy are deterministic"),
    monotone=_TWO,
)
def confidence_set_radius_deterministic(m: Arithmetic, *, R1: Value, R2: Value) -> Value:
    r"""Statement: for deterministic policies, :math:`H(\hat P^{\pi^*},\hat P^{BC})\le\sqrt{R_1}+\sqrt{2R_2}`.

    Source: audit T9; the root of 2 is tight. Assumptions: ``R1``, ``R2`` bound the squared Hellinger errors; both
    policies deterministic. Arguments: ``R1, R2 >= 0``. Returns a Hellinger distance; vacuous from 1 on. Errors:
    ``InputError``.

    >>> float(confidence_set_radius_deterministic.estimate(R1=0.25, R2=0.125))
    1.0
    """
    return total(policy=m.sqrt(R1), transition=m.sqrt(2 * R2))


@bound(
    title="radius from two errors, deterministic policies, as an angle",
    symbol=r"\mathrm{Radius}(R_1, R_2)",
    source="audit T9",
    group="offline",
    status="sharp",
    trivial=1,
    words=_WORDS,
    assumptions=(_ERRORS, "the expert and the cloned policy are deterministic"),
    monotone={
        "R1": rises("the angle rises and is cut at a right angle"),
        "R2": rises("the angle rises and is cut at a right angle"),
    },
)
def confidence_set_radius_angle(m: Arithmetic, *, R1: Value, R2: Value) -> Value:
    r"""Statement: for deterministic policies, :math:`H(\hat P^{\pi^*},\hat
    P^{BC})\le\sin\min(\pi/2,\arcsin\sqrt{R_1}+\arccos(1-R_2))`, errors above 1 counting as 1.

    Source: audit T9, by data processing to the event that the policies disagree. Assumptions: ``R1``, ``R2`` bound the
    squared Hellinger errors; both policies deterministic. Arguments: ``R1, R2 >= 0``. Returns a Hellinger distance in
    [0, 1]. Errors: ``InputError`` outside the domain.

    >>> float(confidence_set_radius_angle.estimate(R1=0, R2=1))
    1.0
    """
    overlap = m.max(0, 1 - R2)
    angle = m.arcsin(m.sqrt(m.min(1, R1))) + m.arccos(overlap)
    # the angle is a right one or wider exactly where overlap^2 <= R1; where R2 = 0 only R1 counts
    return m.if_at_most(overlap**2, R1, lambda: m.number(1), lambda: m.sin(m.min(m.pi() / 2, angle)))


@bound(
    title="radius with no appeal to gamma_min",
    symbol=r"\mathrm{Radius}",
    source="audit T9, T7(b), T6(ii), T11",
    group="offline",
    status="repaired",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_TABULAR,
    monotone=_COMPOSED,
)
def offline_radius_repaired(m: Arithmetic, *, S: Value, H: Value, n: Value, delta: Value, rows: Value) -> Value:
    r"""Statement: :math:`H(\hat P^{\pi^*},\hat P^{BC})\le\sqrt{R_1}+\sqrt{2R_2}` with probability at least
    :math:`1-\delta`, where :math:`R_1=(|S|\log2+\log(2/\delta))/n` and :math:`R_2` is ``transition_error_repaired``
    at :math:`\delta/2`.

    Source: audit T9 with T7(b), T6(ii) and T11. Assumptions: deterministic stationary expert, stationary kernel,
    independent data. Arguments: ``S, H, n`` positive integers, ``rows`` (``S`` for the expert's rows, ``S A`` for all),
    ``delta`` in (0, 1). Returns a Hellinger distance; vacuous from 1 on. Errors: ``InputError`` outside the domain.

    >>> offline_radius_repaired.estimate(S=5, H=8, n=740, delta=0.05, rows=5) < 1
    np.True_
    """
    return total(
        policy=m.sqrt(policy_error_repaired(m, S=S, n=n, delta=delta / 2)),
        transition=m.sqrt(2 * transition_error_repaired(m, S=S, H=H, n=n, delta=delta / 2, rows=rows)),
    )


@bound(
    title="radius with no appeal to gamma_min, as an angle",
    symbol=r"\mathrm{Radius}",
    source="audit T9, T7(b), T6(ii), T11",
    group="offline",
    status="sharp",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_TABULAR,
    monotone=_COMPOSED,
)
def offline_radius_repaired_angle(m: Arithmetic, *, S: Value, H: Value, n: Value, delta: Value, rows: Value) -> Value:
    r"""Statement: as ``offline_radius_repaired``, with the exact tail of T7(b) for :math:`R_1` and the angle form of
    T9.

    Source: audit T9 with T7(b), T6(ii) and T11. Assumptions: deterministic stationary expert, stationary kernel,
    independent data. Arguments: ``S, H, n`` positive integers, ``rows`` (``S`` for the expert's rows, ``S A`` for all),
    ``delta`` in (0, 1). Returns a Hellinger distance in [0, 1]; vacuous at 1. Errors: ``InputError`` outside the
    domain.

    >>> offline_radius_repaired_angle.estimate(S=5, H=8, n=400, delta=0.05, rows=5) < 1
    np.True_
    """
    return confidence_set_radius_angle(
        m,
        R1=policy_error_sharp(m, S=S, n=n, delta=delta / 2),
        R2=transition_error_repaired(m, S=S, H=H, n=n, delta=delta / 2, rows=rows),
    )
