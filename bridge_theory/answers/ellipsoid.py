"""An ellipsoid around the likelihood set, from how fast the curvature of the logistic loss can fall."""

from __future__ import annotations

from bridge_theory.answers.assumptions import BALL
from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total


@bound(
    title="share of the curvature that is left over a distance",
    symbol=r"2\frac{e^{-r}+r-1}{r^2}",
    source="companion G5",
    group="answers",
    status="sharp",
    words="within the distance the loss lies above its tangent by at least the share {at_least} of its curvature term",
    monotone={"reach": falls("it is the mean of 2 (1 - s) exp(-r s) over s in [0, 1]")},
)
def curvature_factor(m: Arithmetic, *, reach: Value) -> Value:
    r"""Statement: for all real ``z`` and :math:`|y|\le r`, the logistic loss :math:`f(z)=\log(1+e^{-z})` has

    .. math:: f(z+y)\ge f(z)+f'(z)y+\sigma'(z)\,2\frac{e^{-r}+r-1}{r^2}\cdot\frac{y^2}2.

    Source: companion G5, from :math:`\sigma'(z+y)\ge\sigma'(z)e^{-|y|}`. Assumptions: none. Arguments: ``reach`` =
    ``r`` > 0. Returns a share in (0, 1), 1 in the limit ``r`` = 0. Errors: ``InputError``.

    >>> round(float(curvature_factor.estimate(reach=1)), 4)
    0.7358
    """
    return 2 * (m.expm1(-reach) + reach) / reach**2


@bound(
    title="squared radius of the ellipsoid around the likelihood set",
    symbol=r"\rho^2",
    source="companion G5",
    group="answers",
    status="sharp",
    words="the likelihood set lies within squared distance {value} of the ellipsoid's centre; below 0 it is empty",
    assumptions=(BALL, "the curvatures are valid over the enclosure that they were computed for"),
    monotone={
        "slack": rises("it is added"),
        "W": rises("its square is multiplied by the ridge"),
        "weight_norm": falls("its square is subtracted"),
        "newton_norm": rises("its square is added"),
    },
)
def ellipsoid_radius_squared(
    m: Arithmetic, *, slack: Value, ridge: Value, W: Value, weight_norm: Value, newton_norm: Value
) -> Value:
    r"""Statement: for any :math:`\hat w` and :math:`\eta\ge0` with :math:`A=\sum_sc_sx_sx_s^\top+\eta I` positive
    definite and :math:`u=-\nabla\ell_t(\hat w)+\eta\hat w`, all weights of :math:`C_t` within the ball have

    .. math:: \|w-(\hat w-A^{-1}u)\|_A^2\le\rho^2=2b+\eta(W^2-\|\hat w\|^2)+\|u\|_{A^{-1}}^2,
       \qquad b=\ell_t(\hat w)-Q_t+\log(1/\delta).

    Source: companion G5. Assumptions: weights of norm at most ``W``, :math:`c_s` is :math:`\sigma'(z_s)` times
    ``curvature_factor`` of a reach that covers the enclosure. Arguments: ``slack`` = ``b``, ``ridge`` = :math:`\eta`
    >= 0, ``W`` > 0, ``weight_norm`` = :math:`\|\hat w\|` >= 0, ``newton_norm`` = :math:`\|u\|_{A^{-1}}` >= 0. Returns
    a squared distance in the norm of ``A``; negative, it says that the set is empty. Errors: ``InputError``.

    >>> float(ellipsoid_radius_squared.estimate(slack=6, ridge=0.5, W=3, weight_norm=1, newton_norm=0.25))
    16.0625
    """
    return total(
        likelihood=2 * slack,
        ball=ridge * (W - weight_norm) * (W + weight_norm),
        gradient=newton_norm**2,
    )
