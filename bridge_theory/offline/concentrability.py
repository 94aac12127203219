"""Concentrability: how much likelier the cloned policy can make a pair that the expert visits."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises
from bridge_theory.offline.assumptions import MINIMUM_VISITATION

_WORDS = "no pair that the expert visits becomes more than {value} times likelier under the cloned policy"
_ASSUMED = ("the squared Hellinger distance between the two trajectory laws is at most R", MINIMUM_VISITATION)
_FARTHER = rises("the laws may differ more")
_RARER = falls("pairs are likelier")


@bound(
    title="concentrability",
    symbol=r"C(\widehat\pi, \pi^*)",
    source="lem:concentrability_coefficient_bound",
    group="offline",
    status="stated",
    trivial=lambda m, gamma_min: 1 / gamma_min,
    words=_WORDS,
    assumptions=_ASSUMED,
    monotone={"R": _FARTHER, "gamma_min": _RARER},
)
def concentrability_stated(m: Arithmetic, *, R: Value, gamma_min: Value) -> Value:
    r"""Statement: :math:`C(\hat\pi,\pi^*)\le 1+2\sqrt R/\gamma_{\min}`.

    Source: ``lem:concentrability_coefficient_bound``. Assumptions: :math:`H^2\le R`, minimum visitation. Arguments:
    ``R`` in [0, 1], ``gamma_min`` in (0, 1]. Returns a ratio; vacuous from ``1 / gamma_min`` on. Errors:
    ``InputError``.

    >>> float(concentrability_stated.estimate(R=0.01, gamma_min=0.01))
    21.0
    """
    return 1 + 2 * m.sqrt(R) / gamma_min


@bound(
    title="concentrability",
    symbol=r"C(\widehat\pi, \pi^*)",
    source="audit T5",
    group="offline",
    status="sharp",
    trivial=lambda m, gamma_min: 1 / gamma_min,
    words=_WORDS,
    assumptions=_ASSUMED,
    monotone={"R": _FARTHER, "gamma_min": _RARER},
)
def concentrability_sharp(m: Arithmetic, *, R: Value, gamma_min: Value) -> Value:
    r"""Statement: :math:`C\le\bigl(1-R+\sqrt{R(2-R)(1-\gamma)/\gamma}\bigr)^2`, and :math:`C\le 1/\gamma` once
    :math:`\gamma\ge(1-R)^2`.

    Source: audit T5; attained for every ``gamma_min <= 1/2``. Assumptions: :math:`H^2\le R`, minimum visitation.
    Arguments: ``R`` in [0, 1], ``gamma_min`` in (0, 1]. Returns a ratio, at most ``1 / gamma_min``. Errors:
    ``InputError`` outside the domain.

    >>> round(float(concentrability_sharp.estimate(R=0.01, gamma_min=0.01)), 2)
    5.73
    """
    return m.if_at_most(
        (1 - R) ** 2,
        gamma_min,
        lambda: 1 / gamma_min,
        lambda: (1 - R + m.sqrt(R * (2 - R) * (1 - gamma_min) / gamma_min)) ** 2,
    )


@bound(
    title="concentrability of deterministic policies",
    symbol=r"C(\widehat\pi, \pi^*)",
    source="audit T5",
    group="offline",
    status="sharp",
    trivial=lambda m, gamma_min: 1 / gamma_min,
    words=_WORDS,
    assumptions=(*_ASSUMED, "both policies are deterministic"),
    monotone={"R": _FARTHER, "gamma_min": _RARER},
)
def concentrability_deterministic(m: Arithmetic, *, R: Value, gamma_min: Value) -> Value:
    r"""Statement: for deterministic policies :math:`C(\hat\pi,\pi^*)\le 1+R/\gamma_{\min}`.

    Source: audit T5: the two laws coincide until the policies first disagree. Assumptions: :math:`H^2\le R`, minimum
    visitation, deterministic policies. Arguments: ``R`` in [0, 1], ``gamma_min`` in (0, 1]. Returns a ratio. Errors:
    ``InputError`` outside the domain.

    >>> float(concentrability_deterministic.estimate(R=0.25, gamma_min=0.25))
    2.0
    """
    return 1 + R / gamma_min
