"""How curved the Bradley-Terry link is over the preference parameters: kappa, as stated and as used."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, rises

_EVEN = rises("cosh rises on the nonnegative reals")

NONNEGATIVE = "no coordinate of any trajectory's features is negative, so that two of them differ by at most sqrt(2) B"


@bound(
    title="curvature of the link over features",
    symbol=r"\kappa",
    source="local:kappa",
    group="online",
    status="stated",
    words="the inverse slope of the sigmoid is at most {value} on inner products of norm B W",
    monotone={"B": _EVEN, "W": _EVEN},
)
def kappa(m: Arithmetic, *, B: Value, W: Value) -> Value:
    r"""Statement: :math:`\kappa=\sup_{\|x\|\le B,\|w\|\le W}1/\sigma'(\langle w,x\rangle)=2+2\cosh(BW)`.

    Source: ``local:kappa``. Assumptions: none, a definition; as the paper uses it (on feature
    differences) it is too small, see ``kappa_differences``. Arguments: ``B, W`` > 0. Returns a number >= 4. Errors:
    ``InputError``.

    >>> round(float(kappa.estimate(B=1, W=1)), 3)
    5.086
    """
    return 2 + 2 * m.cosh(B * W)


@bound(
    title="curvature of the link over feature differences",
    symbol=r"\kappa_2",
    source="audit P3",
    group="online",
    status="repaired",
    words="the inverse slope of the sigmoid is at most {value} on feature differences",
    monotone={"B": _EVEN, "W": _EVEN},
)
def kappa_differences(m: Arithmetic, *, B: Value, W: Value) -> Value:
    r"""Statement: :math:`\kappa_2=\sup_{\|x\|\le 2B,\|w\|\le W}1/\sigma'(\langle w,x\rangle)=2+2\cosh(2BW)`.

    Source: audit P3 (the paper's kappa with the radius its proofs need). Assumptions: none. Arguments: ``B, W`` > 0.
    Returns a number >= 4. Errors: ``InputError``.

    >>> round(float(kappa_differences.estimate(B=1, W=1)), 3)
    9.524
    """
    return 2 + 2 * m.cosh(2 * B * W)


@bound(
    title="curvature of the link over differences of nonnegative features",
    symbol=r"\kappa_{\sqrt2}",
    source="audit P3",
    group="online",
    status="sharp",
    words="the inverse slope of the sigmoid is at most {value} on differences of nonnegative features",
    assumptions=(NONNEGATIVE,),
    monotone={"B": _EVEN, "W": _EVEN},
)
def kappa_nonnegative(m: Arithmetic, *, B: Value, W: Value) -> Value:
    r"""Statement: :math:`\sup_{\|x\|\le\sqrt2B,\|w\|\le W}1/\sigma'(\langle w,x\rangle)=2+2\cosh(\sqrt2BW)`.

    Source: audit P3; for a, b without negative coordinates :math:`\|a-b\|^2\le\|a\|^2+\|b\|^2\le2B^2`, attained.
    Assumptions: no feature is negative (counts and indicators are not). Arguments: ``B, W`` > 0. Returns a number >= 4.
    Errors: ``InputError``.

    >>> round(float(kappa_nonnegative.estimate(B=1, W=1)), 3)
    6.356
    """
    return kappa_differences(m, B=nonnegative_bound(m, B), W=W)


def nonnegative_bound(m: Arithmetic, B: Value) -> Value:
    """The B at which a statement about differences of norm at most 2B is one about norms of at most sqrt(2) B.

    >>> from bridge_theory.arithmetic.floats import FLOATS
    >>> round(float(nonnegative_bound(FLOATS, 1.0)), 4)
    0.7071
    """
    return B / m.sqrt(m.number(2))
