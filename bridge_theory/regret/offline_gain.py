"""What n demonstrations buy before anything is learned online: how far from the expert the offline set can reach."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, least, rises
from bridge_theory.offline.assumptions import DETERMINISTIC
from bridge_theory.online.coverage import VISITS
from bridge_theory.regret.trivial import BOUNDED, IN_SET, twice_range

_CONTAINED = "the best policy lies within the radius of the cloned policy under the true dynamics"
_CONTAINED_ESTIMATED = "the best policy lies within the radius of the cloned policy under the estimated dynamics"
_DETERMINISTIC = "all policies and the cloned policy are deterministic"
_R2_EVENT = "the transition error of the best policy is at most R2 in squared Hellinger distance"
_VERSION_SPACE = (DETERMINISTIC, "the offline set is every deterministic policy that agrees with all demonstrations")
_BY_RADIUS = rises("it multiplies")
_WITHIN = "every policy of the offline set is within {value} of the expert in total variation"


@bound(
    title="total variation to the expert, known dynamics",
    symbol=r"\Delta_n",
    source="audit R8(c)",
    group="regret",
    status="repaired",
    trivial=1,
    words=_WITHIN,
    assumptions=("the dynamics are known", _CONTAINED),
    monotone={"radius": _BY_RADIUS},
)
def delta_n_known(m: Arithmetic, *, radius: Value) -> Value:
    r"""Statement: :math:`\Delta_n\le\min(1,2\sqrt2\,\rho)`.

    Source: audit R8(c) (TV <= sqrt2 H and two radii). Assumptions: known dynamics; Hellinger ball of radius rho that
    contains the best policy. Arguments: ``radius`` >= 0. Returns a total variation in [0, 1]. Errors: ``InputError``.

    >>> round(float(delta_n_known.estimate(radius=0.1)), 4)
    0.2828
    """
    return m.min(m.number(1), m.sqrt(m.number(8)) * radius)


@bound(
    title="total variation to the expert, known dynamics and deterministic policies",
    symbol=r"\Delta_n",
    source="audit R8(c)",
    group="regret",
    status="sharp",
    trivial=1,
    words=_WITHIN,
    assumptions=("the dynamics are known", _CONTAINED, _DETERMINISTIC),
    monotone={"radius": _BY_RADIUS},
)
def delta_n_known_deterministic(m: Arithmetic, *, radius: Value) -> Value:
    r"""Statement: for deterministic policies :math:`\Delta_n\le\min(1,2\rho^2)`: total variation is squared Hellinger.

    Source: audit R8(a, c), correction 5. Assumptions: as ``delta_n_known``, everything deterministic. Arguments:
    ``radius`` >= 0. Returns a total variation in [0, 1]. Errors: ``InputError``.

    >>> round(float(delta_n_known_deterministic.estimate(radius=0.1)), 4)
    0.02
    """
    return m.min(m.number(1), 2 * radius**2)


@bound(
    title="total variation to the expert, unknown dynamics",
    symbol=r"\Delta_n",
    source="audit R8(c)",
    group="regret",
    status="repaired",
    trivial=1,
    words=_WITHIN,
    assumptions=(_CONTAINED_ESTIMATED, _R2_EVENT),
    monotone={"radius": _BY_RADIUS, "R2": rises("it is under the root")},
)
def delta_n_unknown(m: Arithmetic, *, radius: Value, R2: Value) -> Value:
    r"""Statement: :math:`\Delta_n\le\min(1,2\sqrt2\,\rho+\sqrt{2R_2})`.

    Source: audit R8(b, c): total variation between two policies transfers between kernels at the cost of one policy's
    transition error. Assumptions: the ball under the estimated dynamics contains the best policy; the R_2 event.
    Arguments: ``radius`` >= 0, ``R2`` >= 0. Returns a total variation in [0, 1]. Errors: ``InputError``.

    >>> round(float(delta_n_unknown.estimate(radius=0.1, R2=0.005)), 4)
    0.3828
    """
    return m.min(m.number(1), m.sqrt(m.number(8)) * radius + m.sqrt(2 * R2))


@bound(
    title="total variation to the expert, unknown dynamics and deterministic policies",
    symbol=r"\Delta_n",
    source="audit R8(c)",
    group="regret",
    status="sharp",
    trivial=1,
    words=_WITHIN,
    assumptions=(_CONTAINED_ESTIMATED, _R2_EVENT, _DETERMINISTIC),
    monotone={"radius": _BY_RADIUS, "R2": rises("it is under the root")},
)
def delta_n_unknown_deterministic(m: Arithmetic, *, radius: Value, R2: Value) -> Value:
    r"""Statement: for deterministic policies :math:`\Delta_n\le\min(1,2\rho^2+\sqrt{2R_2})`.

    Source: audit R8(a, b, c), correction 5. Assumptions: as ``delta_n_unknown``, everything deterministic. Arguments:
    ``radius`` >= 0, ``R2`` >= 0. Returns a total variation in [0, 1]. Errors: ``InputError``.

    >>> round(float(delta_n_unknown_deterministic.estimate(radius=0.1, R2=0.005)), 4)
    0.12
    """
    return m.min(m.number(1), 2 * radius**2 + m.sqrt(2 * R2))


@bound(
    title="total variation to the expert in the version space",
    symbol=r"\Delta_n",
    source="audit R8(c)",
    group="regret",
    status="repaired",
    trivial=1,
    spends=("delta_off",),
    words=_WITHIN,
    assumptions=(*_VERSION_SPACE, VISITS[0]),
    monotone={
        "S": rises("it multiplies"),
        "A": rises("log rises"),
        "n": falls("it divides"),
        "delta_off": falls("log(1/delta_off) falls"),
    },
)
def delta_n_version_space(m: Arithmetic, *, S: Value, A: Value, n: Value, delta_off: Value) -> Value:
    r"""Statement: over policies that agree with all demonstrations, :math:`\Delta_n\le(|S|\log|A|+\log(1/\delta))/n`.

    Source: audit R8(c): :math:`|A|^{|S|}(1-\theta)^n`. The expert is in the set surely; no kernel, no gamma_min.
    Assumptions: deterministic stationary expert, independent demonstrations. Arguments: ``S, A, n`` positive integers,
    ``delta_off`` in (0, 1). Returns a total variation in [0, 1]. Errors: ``InputError``.

    >>> round(float(delta_n_version_space.estimate(S=5, A=4, n=1000, delta_off=0.05)), 6)
    0.009927
    """
    return m.min(m.number(1), (S * m.log(A) - m.log(delta_off)) / n)


@bound(
    title="total variation to the expert in the version space, without the actions",
    symbol=r"\Delta_n",
    source="audit R8(c), T7(b)",
    group="regret",
    status="sharp",
    trivial=1,
    spends=("delta_off",),
    words=_WITHIN,
    assumptions=(*_VERSION_SPACE, VISITS[0]),
    monotone={
        "S": rises("there are more sets of states"),
        "n": falls("the root of a number below 1 rises"),
        "delta_off": falls("its root rises"),
    },
)
def delta_n_version_space_sharp(m: Arithmetic, *, S: Value, n: Value, delta_off: Value) -> Value:
    r"""Statement: over policies that agree with all demonstrations, :math:`\Delta_n\le1-(\delta/(2^{|S|}-1))^{1/n}`.

    Source: audit R8(c) with T7(b): such a policy errs only in states without data, and there are :math:`2^{|S|}-1`
    nonempty sets of states, whatever the number of actions. Assumptions: as ``delta_n_version_space``. Arguments: ``S,
    n`` positive integers, ``delta_off`` in (0, 1). Returns a total variation in [0, 1]. Errors: ``InputError``.

    >>> round(float(delta_n_version_space_sharp.estimate(S=5, n=1000, delta_off=0.05)), 6)
    0.006409
    """
    two = m.number(2)
    return m.one_minus_root(delta_off / (m.power(two, S) - 1), n)


@bound(
    title="probability of any regret in the version space",
    symbol=r"P(\Delta_n>0)",
    source="audit R8(c)",
    group="regret",
    status="repaired",
    trivial=1,
    words="some policy that agrees with all demonstrations differs from the expert with probability at most {value}",
    assumptions=(*_VERSION_SPACE, *VISITS),
    monotone={
        "S_reach": rises("it multiplies"),
        "n": falls("a power of a number below 1"),
        "gamma_min": falls("1 - gamma_min falls"),
    },
)
def exact_recovery_failure(m: Arithmetic, *, S_reach: Value, n: Value, gamma_min: Value) -> Value:
    r"""Statement: :math:`P(\max_{\Pi_0}\mathrm{TV}>0)\le|S_{reach}|(1-\gamma_{\min})^n`; otherwise the regret is 0.

    Source: audit R8(c), correction 5 (here the pairs of step H count). Assumptions: version space, independent
    demonstrations, minimum visitation. Arguments: ``S_reach, n`` positive integers, ``gamma_min`` in (0, 1]. Returns a
    probability, vacuous from 1 on. Errors: ``InputError``.

    >>> round(float(exact_recovery_failure.estimate(S_reach=5, n=100, gamma_min=0.1)), 8)
    0.00013281
    """
    return S_reach * m.power(1 - gamma_min, n)


@bound(
    title="regret bound from the stated offline radius, deterministic policies",
    symbol=r"R_T",
    source="audit correction 8",
    group="regret",
    status="repaired",
    trivial=twice_range,
    spends=("delta_off",),
    words="the regret is at most {value}, whatever is played inside the offline set",
    assumptions=(
        BOUNDED,
        IN_SET,
        DETERMINISTIC,
        _DETERMINISTIC,
        "the dynamics are known",
        "the offline set is the ball of lem:offline_CI_under_known_dyn, radius sqrt(6 S log(A / delta_off) / n)",
    ),
    monotone={
        "B": rises("it multiplies"),
        "W": rises("it multiplies"),
        "T": rises("it multiplies"),
        "S": rises("it multiplies"),
        "A": rises("log rises"),
        "n": falls("it divides"),
        "delta_off": falls("log(1/delta_off) falls"),
    },
)
def regret_known_deterministic(
    m: Arithmetic, *, B: Value, W: Value, S: Value, A: Value, n: Value, T: Value, delta_off: Value
) -> Value:
    r"""Statement: :math:`R_T\le\min\{2BWT,24BWT|S|\log(|A|/\delta)/n\}`.

    Source: audit correction 8: ``delta_n_known_deterministic`` at the paper's radius
    :math:`\rho^2=6|S|\log(|A|/\delta)/n`. Assumptions: known dynamics, deterministic policies, play inside the offline
    set. Arguments: ``B, W`` > 0, ``S, A, n, T`` positive integers, ``delta_off`` in (0, 1). Returns a regret. Errors:
    ``InputError``.

    >>> round(float(regret_known_deterministic.estimate(B=1, W=0.5, S=5, A=4, n=10**5, T=1000, delta_off=0.05)), 3)
    2.629
    """
    ball = 12 * S * m.log(A / delta_off) / n
    return least(trivial=twice_range(m, B, W, T), offline=twice_range(m, B, W, T) * ball)


@bound(
    title="floor of the offline-enhanced elliptical bound",
    symbol=r"Q",
    source="audit R11",
    group="regret",
    status="sharp",
    words="the elliptical bound with offline data cannot be below {at_least}",
    assumptions=("the multiplier is at least 2W sqrt(kappa lam), as the paper's and the repaired one are",),
    monotone={
        "W": rises("it multiplies"),
        "d": rises("it is under the root"),
        "T": rises("it multiplies"),
        "gamma": rises("it multiplies"),
        "diameter": rises("it multiplies"),
    },
)
def elliptical_floor(m: Arithmetic, *, W: Value, d: Value, T: Value, gamma: Value, diameter: Value) -> Value:
    r"""Statement: :math:`Q=2\gamma\sqrt{Tc\,d\log(1+TD^2/(d\kappa\lambda))}\ge\min\{4\sqrt{\log2}\,TWD,
    2\gamma\sqrt{dT\log2}\}`: beyond the trivial bound ``TWD`` the offline data gain only inside a logarithm.

    Source: audit R11 (it rounds :math:`4\sqrt{\log2}=3.33` down to 3.3). Assumptions:
    :math:`\gamma\ge2W\sqrt{\kappa\lambda}`. Arguments: ``W, gamma`` > 0, ``d, T`` positive integers, ``diameter`` D >=
    0. Returns a lower bound of ``regret_known_log`` with that multiplier. Errors: ``InputError``.

    >>> round(float(elliptical_floor.estimate(W=1, d=1, T=1, gamma=10, diameter=1)), 4)
    3.3302
    """
    log2 = m.log(m.number(2))
    return least(small_diameter=4 * m.sqrt(log2) * T * W * diameter, large_diameter=2 * gamma * m.sqrt(d * T * log2))
