"""What a Hellinger ball says about means and covariances of features, and about pairs of policies in it."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises
from bridge_theory.offline.assumptions import BOUNDED_FEATURES

_MEAN = "the expected features of the two laws differ by at most {value} in Euclidean norm"
_COVARIANCE = "the covariances of the features differ by at most {value} in operator norm"
_PAIR = "the expected features of two policies of the set differ by at most {value} in Euclidean norm"
_CLOSE = "the squared Hellinger distance of the two laws is at most R"
_SUP = "every coordinate of the features is at most B in absolute value"
_BALL = "both policies lie within Hellinger distance radius of the cloned policy"
_LARGER = rises("it multiplies")
_FARTHER = rises("the laws may differ more")


@bound(
    title="mean of features in a Hellinger ball",
    symbol=r"\|\mathbb{E}_P f - \mathbb{E}_Q f\|_2",
    source="lem:hellinger_to_moment",
    group="offline",
    status="stated",
    trivial=lambda m, B, d: 2 * B * m.sqrt(d),
    words=_MEAN,
    assumptions=(_CLOSE, _SUP),
    monotone={"B": _LARGER, "d": _LARGER, "R": _FARTHER},
)
def mean_difference_stated(m: Arithmetic, *, B: Value, d: Value, R: Value) -> Value:
    r"""Statement: :math:`\|\mathbb E_Pf-\mathbb E_Qf\|_2\le2\sqrt2\,B\sqrt{dR}` for :math:`\|f\|_\infty\le B`.

    Source: ``lem:hellinger_to_moment``. Assumptions: :math:`H^2\le R`, coordinates bounded by ``B``. Arguments: ``B``
    > 0, ``d`` positive integer, ``R`` in [0, 1]. Returns a feature norm. Errors: ``InputError`` outside the domain.

    >>> float(mean_difference_stated.estimate(B=1, d=2, R=0.25))
    2.0
    """
    return 2 * B * m.sqrt(2 * d * R)


@bound(
    title="mean of features in a Hellinger ball",
    symbol=r"\|\mathbb{E}_P f - \mathbb{E}_Q f\|_2",
    source="audit T12",
    group="offline",
    status="sharp",
    trivial=lambda m, B: 2 * B,
    words=_MEAN,
    assumptions=(_CLOSE, BOUNDED_FEATURES),
    monotone={"B": _LARGER, "R": _FARTHER},
)
def mean_difference_sharp(m: Arithmetic, *, B: Value, R: Value) -> Value:
    r"""Statement: :math:`\|\mathbb E_Pf-\mathbb E_Qf\|_2\le2B\sqrt{R(2-R)}` for :math:`\|f\|_2\le B`.

    Source: audit T12, tight. Assumptions: :math:`H^2\le R`, Euclidean norm bounded by ``B`` (``B sqrt(d)`` where
    coordinates are). Arguments: ``B`` > 0, ``R`` in [0, 1]. Returns a feature norm. Errors: ``InputError``.

    >>> float(mean_difference_sharp.estimate(B=1, R=1))
    2.0
    """
    return 2 * B * m.sqrt(R * (2 - R))


@bound(
    title="covariance of features in a Hellinger ball",
    symbol=r"\|\mathrm{Cov}_P f - \mathrm{Cov}_Q f\|_{op}",
    source="lem:hellinger_to_moment",
    group="offline",
    status="stated",
    trivial=lambda m, B, d: d * B**2,
    words=_COVARIANCE,
    assumptions=(_CLOSE, _SUP),
    monotone={"B": _LARGER, "d": _LARGER, "R": _FARTHER},
)
def covariance_difference_stated(m: Arithmetic, *, B: Value, d: Value, R: Value) -> Value:
    r"""Statement: :math:`\|\mathrm{Cov}_Pf-\mathrm{Cov}_Qf\|_{op}\le6dB^2\sqrt{2R}` for :math:`\|f\|_\infty\le B`.

    Source: ``lem:hellinger_to_moment``. Assumptions: :math:`H^2\le R`, coordinates bounded by ``B``. Arguments: ``B``
    > 0, ``d`` positive integer, ``R`` in [0, 1]. Returns a squared feature norm. Errors: ``InputError``.

    >>> float(covariance_difference_stated.estimate(B=1, d=1, R=0.5))
    6.0
    """
    return 6 * d * B**2 * m.sqrt(2 * R)


@bound(
    title="covariance of features in a Hellinger ball",
    symbol=r"\|\mathrm{Cov}_P f - \mathrm{Cov}_Q f\|_{op}",
    source="audit T12",
    group="offline",
    status="sharp",
    trivial=lambda m, B: B**2,
    words=_COVARIANCE,
    assumptions=(_CLOSE, BOUNDED_FEATURES),
    monotone={"B": _LARGER, "R": _FARTHER},
)
def covariance_difference_sharp(m: Arithmetic, *, B: Value, R: Value) -> Value:
    r"""Statement: with :math:`t=\sqrt{R(2-R)}`, :math:`\|\mathrm{Cov}_Pf-\mathrm{Cov}_Qf\|_{op}\le4B^2t(1-t)` for
    :math:`t\le1/2` and :math:`\le B^2` beyond, for :math:`\|f\|_2\le B`.

    Source: audit T12, sharp in the total variation ``t``. Assumptions: :math:`H^2\le R`, Euclidean norm bounded by
    ``B``. Arguments: ``B`` > 0, ``R`` in [0, 1]. Returns a squared feature norm. Errors: ``InputError`` outside the
    domain.

    >>> float(covariance_difference_sharp.estimate(B=2, R=1))
    4.0
    """
    variation = m.sqrt(R * (2 - R))
    return B**2 * m.if_at_most(2 * variation, 1, lambda: 4 * variation * (1 - variation), lambda: m.number(1))


@bound(
    title="features of two policies in the set",
    symbol=r"\|\phi(\pi_1)-\phi(\pi_2)\|_2",
    source="local:feature_difference_main",
    group="offline",
    status="stated",
    trivial=lambda m, B: 2 * B,
    words=_PAIR,
    assumptions=("both policies are in the offline confidence set",),
    monotone={"B": _LARGER, "n": falls("it divides")},
)
def feature_difference_stated(m: Arithmetic, *, B: Value, n: Value) -> Value:
    r"""Statement: :math:`\|\phi^{\hat P}(\pi_1)-\phi^{\hat P}(\pi_2)\|_2\le4\sqrt2B/\sqrt n` for policies of the
    confidence set.

    Source: ``local:feature_difference_main``; false (M9), see ``feature_difference_repaired``. Assumptions: bounded
    features. Arguments: ``B`` > 0, ``n`` positive integer. Returns a bound claimed for a feature norm. Errors:
    ``InputError``.

    >>> float(feature_difference_stated.estimate(B=1, n=32))
    1.0
    """
    return 4 * B * m.sqrt(2 / n)


@bound(
    title="features of two policies in the set, known dynamics",
    symbol=r"\|\phi(\pi_1)-\phi(\pi_2)\|_2^2",
    source="lemma:feature_diff_bound",
    group="offline",
    status="stated",
    trivial=lambda m, B: 4 * B**2,
    spends=("delta",),
    words="the expected features of two policies of the set differ by at most {value} in squared Euclidean norm",
    assumptions=("both policies are in the offline confidence set for known dynamics", BOUNDED_FEATURES),
    monotone={
        "B": _LARGER,
        "S": _LARGER,
        "A": rises("log rises"),
        "n": falls("it divides"),
        "delta": falls("log(A/delta) falls"),
    },
)
def feature_difference_squared_stated(m: Arithmetic, *, B: Value, S: Value, A: Value, n: Value, delta: Value) -> Value:
    r"""Statement: :math:`\|\phi(\pi_1)-\phi(\pi_2)\|_2^2\le192B^2|S|\log(|A|/\delta)/n` for policies of the
    known-dynamics set.

    Source: the display in the proof of ``lemma:feature_diff_bound`` (:math:`8B^2\cdot24|S|\log(|A|/\delta)/n`); true.
    Assumptions: bounded features, both policies in the set. Arguments: ``B`` > 0, ``S, A, n`` positive integers,
    ``delta`` in (0, 1). Returns a squared feature norm. Errors: ``InputError`` outside the domain.

    >>> round(float(feature_difference_squared_stated.estimate(B=1, S=5, A=4, n=10000, delta=0.05)), 4)
    0.4207
    """
    return 192 * B**2 * S * m.log(A / delta) / n


@bound(
    title="features of two policies in a Hellinger ball",
    symbol=r"\|\phi(\pi_1)-\phi(\pi_2)\|_2",
    source="audit T12",
    group="offline",
    status="repaired",
    trivial=lambda m, B: 2 * B,
    words=_PAIR,
    assumptions=(_BALL, BOUNDED_FEATURES),
    monotone={"B": _LARGER, "radius": rises("the angle rises and is cut at a right angle")},
)
def feature_difference_repaired(m: Arithmetic, *, B: Value, radius: Value) -> Value:
    r"""Statement: :math:`\|\phi(\pi_1)-\phi(\pi_2)\|_2\le2B\sin\min(\pi/2,2\arccos(1-r^2))\le4\sqrt2Br`, ``r`` above
    1 counting as 1.

    Source: audit T12. Assumptions: both policies in the ball, bounded features. Arguments: ``B`` > 0, ``radius >= 0``.
    Returns a feature norm, at most ``2 B``. Errors: ``InputError`` outside the domain.

    >>> float(feature_difference_repaired.estimate(B=1, radius=1))
    2.0
    """
    overlap = m.max(0, 1 - radius**2)
    # twice the angle is a right one or wider exactly where 2 overlap^2 <= 1
    sine = m.if_at_most(2 * overlap**2, 1, lambda: m.number(1), lambda: m.sin(m.min(m.pi() / 2, 2 * m.arccos(overlap))))
    return 2 * B * sine


@bound(
    title="features of two deterministic policies in a Hellinger ball",
    symbol=r"\|\phi(\pi_1)-\phi(\pi_2)\|_2",
    source="audit T12",
    group="offline",
    status="sharp",
    trivial=lambda m, B: 2 * B,
    words=_PAIR,
    assumptions=(_BALL, BOUNDED_FEATURES, "both policies and the cloned policy are deterministic"),
    monotone={"B": _LARGER, "radius": rises("it is squared and cut at 1")},
)
def feature_difference_deterministic(m: Arithmetic, *, B: Value, radius: Value) -> Value:
    r"""Statement: for deterministic policies, :math:`\|\phi(\pi_1)-\phi(\pi_2)\|_2\le2B\min(1,2r^2)`.

    Source: audit T12: total variation is the squared Hellinger distance. Assumptions: both policies in the ball,
    bounded features, deterministic policies. Arguments: ``B`` > 0, ``radius >= 0``. Returns a feature norm. Errors:
    ``InputError`` outside the domain.

    >>> float(feature_difference_deterministic.estimate(B=1, radius=0.5))
    1.0
    """
    return 2 * B * m.min(1, 2 * radius**2)
