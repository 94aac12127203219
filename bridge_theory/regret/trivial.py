"""What is true of every algorithm: regret bounds that need no learning."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, rises

BOUNDED = "trajectory features have norm at most B and the preference weights norm at most W"
IN_SET = "the policies played and the best policy lie in the offline set"


def twice_range(m: Arithmetic, B: Value, W: Value, T: Value) -> Value:
    r""":math:`2BWT`, the regret that no bound may usefully exceed.

    >>> from bridge_theory.arithmetic.floats import FLOATS
    >>> twice_range(FLOATS, B=1.0, W=0.5, T=10.0)
    10.0
    """
    return 2 * B * W * T


@bound(
    title="trivial regret bound",
    symbol=r"2BWT",
    source="audit R4(i)",
    group="regret",
    status="repaired",
    words="the regret is at most {value}, whatever is played",
    assumptions=(BOUNDED,),
    monotone={"B": rises("it multiplies"), "W": rises("it multiplies"), "T": rises("it multiplies")},
)
def regret_trivial(m: Arithmetic, *, B: Value, W: Value, T: Value) -> Value:
    r"""Statement: :math:`R_T\le2BWT`.

    Source: audit R4(i). Assumptions: bounded features and weights. Arguments: ``B, W`` > 0, ``T`` a positive integer.
    Returns a regret. Errors: ``InputError``.

    >>> float(regret_trivial.estimate(B=1, W=0.5, T=1000))
    1000.0
    """
    return twice_range(m, B, W, T)


@bound(
    title="regret bound from the diameter of the offline set",
    symbol=r"TWD",
    source="audit R4(i)",
    group="regret",
    status="repaired",
    words="the regret is at most {value}, whatever is played inside the offline set",
    assumptions=(BOUNDED, IN_SET, "the dynamics are known"),
    monotone={"W": rises("it multiplies"), "T": rises("it multiplies"), "diameter": rises("it multiplies")},
)
def regret_diameter(m: Arithmetic, *, W: Value, T: Value, diameter: Value) -> Value:
    r"""Statement: :math:`R_T\le TW\max_{\pi,\pi'\in\Pi_{off}}\|\phi(\pi)-\phi(\pi')\|_2`.

    Source: audit R4(i). Assumptions: known dynamics, everything played inside the offline set, which contains the best
    policy. Arguments: ``W`` > 0, ``T`` a positive integer, ``diameter`` >= 0 in feature norm. Returns a regret. Errors:
    ``InputError``.

    >>> float(regret_diameter.estimate(W=0.5, T=1000, diameter=0.25))
    125.0
    """
    return T * W * diameter


@bound(
    title="regret bound from the total variation to the expert",
    symbol=r"2BWT\Delta_n",
    source="audit R8",
    group="regret",
    status="repaired",
    trivial=twice_range,
    words="the regret is at most {value}, whatever is played inside the offline set",
    assumptions=(
        BOUNDED,
        IN_SET,
        "every policy of the offline set is within Delta_n of the best one in total variation",
    ),
    monotone={
        "B": rises("it multiplies"),
        "W": rises("it multiplies"),
        "T": rises("it multiplies"),
        "Delta_n": rises("it multiplies"),
    },
)
def regret_offline(m: Arithmetic, *, B: Value, W: Value, T: Value, Delta_n: Value) -> Value:
    r"""Statement: :math:`R_T\le2BWT\Delta_n`, :math:`\Delta_n=\max_{\pi\in\Pi_{off}}\mathrm{TV}(P_*^\pi,P_*^{\pi^*})`.

    Source: audit R8(c): this alone makes the regret vanish as n grows, for any algorithm. Assumptions: bounded features
    and weights; everything played lies in the offline set. Arguments: ``B, W`` > 0, ``T`` a positive integer,
    ``Delta_n`` in [0, 1] (the ``delta_n_...`` bounds). Returns a regret. Errors: ``InputError``.

    >>> float(regret_offline.estimate(B=1, W=0.5, T=1000, Delta_n=0.01))
    10.0
    """
    return twice_range(m, B, W, T) * Delta_n


@bound(
    title="regret bound from the uncertainty actually played",
    symbol=r"B_{\mathrm{width}}",
    source="audit R4(ii)",
    group="regret",
    status="repaired",
    words="the regret is at most {value}",
    assumptions=(
        "the best policy is in every round's set, and so is everything played",
        "each round plays the exact arg-max pair of the uncertainty",
    ),
    monotone={"width_sum": rises("it multiplies"), "bonus_sum": rises("it multiplies")},
)
def regret_width(m: Arithmetic, *, width_sum: Value, bonus_sum: Value) -> Value:
    r"""Statement: :math:`R_T\le\sum_t2\bigl(\rho_t\|\hat\phi_t(\pi_t^1)-\hat\phi_t(\pi_t^2)\|_{V_t^{-1}}
    +b_t(\pi_t^1)+b_t(\pi_t^2)\bigr)`.

    Source: audit R4(ii), from containment alone: no further failure probability. Assumptions: containment (events of
    the offline set, of R1 and, with unknown dynamics, of R6) and exact arg-max pairs. Arguments: ``width_sum`` =
    :math:`\sum_t\rho_t\|\cdot\|_{V_t^{-1}}` >= 0, ``bonus_sum`` = :math:`\sum_{i,t}b_t(\pi_t^i)` >= 0 (0 for known
    dynamics). Returns a regret. Errors: ``InputError``.

    >>> float(regret_width.estimate(width_sum=10, bonus_sum=2.5))
    25.0
    """
    return 2 * width_sum + 2 * bonus_sum


@bound(
    title="loss against one candidate best policy in one round",
    symbol=r"U_t(\pi,\pi')",
    source="audit R4(ii)",
    group="regret",
    status="repaired",
    words="if this candidate is the best policy, playing the other loses at most {value}",
    assumptions=("the true weights are in the round's ellipsoid",),
    monotone={
        "optimism": rises("it is one of two candidates for the minimum"),
        "W": rises("it multiplies"),
        "norm": rises("it multiplies"),
        "bonus_sum": rises("it is added"),
    },
)
def regret_optimism(m: Arithmetic, *, W: Value, optimism: Value, norm: Value, bonus_sum: Value) -> Value:
    r"""Statement: :math:`\langle\phi(\pi)-\phi(\pi'),w^*\rangle\le U_t(\pi,\pi')`, with
    :math:`\Delta=\hat\phi_t(\pi)-\hat\phi_t(\pi')`,

    .. math:: U_t(\pi,\pi')=\min\{\langle\Delta,w_t\rangle+\rho_t\|\Delta\|_{V_t^{-1}},W\|\Delta\|_2\}
       +\bigl(b_t(\pi)+b_t(\pi')\bigr)1\{\pi\ne\pi'\}.

    Source: audit R4(ii): :math:`R_T\le B_{ucb}=\tfrac12\sum_{t,i}\max_{\pi\in\Pi_t}U_t(\pi,\pi_t^i)`; the caller takes
    the maximum over candidates and the sum (correction 2). Assumptions: the ellipsoid of R1, the event of R6 with
    unknown dynamics; containment in :math:`\Pi_t` for the sum. Arguments: ``W`` > 0, ``optimism`` the first argument
    of the minimum, >= 0 for the maximising candidate, ``norm`` = :math:`\|\Delta\|_2`, ``bonus_sum`` =
    :math:`b_t(\pi)+b_t(\pi')` (0 for known dynamics or equal policies), both >= 0. Returns a utility. Errors:
    ``InputError``.

    >>> float(regret_optimism.estimate(W=0.5, optimism=10, norm=12, bonus_sum=3))
    9.0
    """
    return m.min(optimism, W * norm) + bonus_sum


@bound(
    title="regret bound in hindsight, for one candidate best policy",
    symbol=r"B_{\mathrm{hind}}(\pi)",
    source="audit R4(iii)",
    group="regret",
    status="repaired",
    words="if this candidate is the best policy, the regret is at most {value}",
    assumptions=("the best policy is in the offline set", "the true weights are in the last round's ellipsoid"),
    monotone={
        "optimism": rises("it is one of two candidates for the minimum"),
        "W": rises("it multiplies"),
        "norm": rises("it multiplies"),
        "bonus_sum": rises("it is added"),
    },
)
def regret_hindsight(m: Arithmetic, *, W: Value, optimism: Value, norm: Value, bonus_sum: Value) -> Value:
    r"""Statement: :math:`R_T\le\max_{\pi\in\Pi_{off}}B_{hind}(\pi)`, with
    :math:`m_\pi=\sum_t\bigl(\hat\phi(\pi)-\tfrac12(\hat\phi(\pi_t^1)+\hat\phi(\pi_t^2))\bigr)`,

    .. math:: B_{hind}(\pi)=\min\{\langle m_\pi,w_{T+1}\rangle+\rho_{T+1}\|m_\pi\|_{V_{T+1}^{-1}},W\|m_\pi\|_2\}
       +\tfrac12\sum_{t,i}\bigl(b(\pi)+b(\pi_t^i)\bigr)1\{\pi\ne\pi_t^i\}.

    Source: audit R4(iii); the caller takes the maximum over candidates (correction 2). Assumptions: containment in the
    offline set, the ellipsoid of R1, the event of R6 with unknown dynamics. Arguments: ``W`` > 0, ``optimism`` the
    first argument of the minimum, >= 0 for the maximising candidate (0 stands for a negative one), ``norm`` =
    :math:`\|m_\pi\|_2`, ``bonus_sum`` the double sum (0 for known dynamics), both >= 0. Returns a regret. Errors:
    ``InputError``.

    >>> float(regret_hindsight.estimate(W=0.5, optimism=10, norm=12, bonus_sum=3))
    7.5
    """
    return m.min(optimism, W * norm) + bonus_sum / 2
