"""The repaired bonus: an L1 ball around every estimated transition row, valid for all policies and random functions."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises
from bridge_theory.online.bonus import SAME_CELLS

EVENT = (
    "transitions come from the real, stationary environment",
    "given the past and the first trajectory of a round, the second still follows the real dynamics "
    "(no common random numbers)",
)


@bound(
    title="L1 radius of an estimated transition row",
    symbol=r"\epsilon_N",
    source="audit R6",
    group="online",
    status="repaired",
    trivial=2,
    spends=("delta_P",),
    words="every estimated transition row is within {value} of the true one in L1, at its count",
    assumptions=EVENT,
    monotone={
        "N": falls("it is 2 at N = 0, and (c + log N(N+1))/N falls on the integers N >= 1 for every c >= log 2"),
        "S": rises("it is under the root"),
        "A": rises("log rises"),
        "delta_P": falls("log(1/delta_P) falls"),
    },
)
def bonus_radius(m: Arithmetic, *, S: Value, A: Value, delta_P: Value, N: Value) -> Value:
    r"""Statement: for all cells and all counts at once, :math:`\|\hat P_N-P^*\|_1\le\epsilon_N`, :math:`\epsilon_0=2`,

    .. math:: \epsilon_N=\min\Bigl(2,\sqrt{\tfrac2N\bigl(|S|\log2+\log(|S||A|N(N+1)/\delta_P)\bigr)}\Bigr).

    Source: audit R6 (Weissman's inequality, a union over cells and over N with weights 1/(N(N+1))). Assumptions: real
    stationary transitions, the two rollouts of a round independent given the past. Arguments: ``S, A`` positive
    integers, ``delta_P`` in (0, 1), ``N`` a count >= 0. Returns an L1 distance in [0, 2]. Errors: ``InputError``.

    >>> round(float(bonus_radius.estimate(S=5, A=4, delta_P=0.05, N=1000)), 4)
    0.2157
    >>> float(bonus_radius.estimate(S=5, A=4, delta_P=0.05, N=0))
    2.0
    """

    def from_data() -> Value:
        return m.min(m.number(2), m.sqrt(2 * (S * m.log(m.number(2)) + m.log(S * A * N * (N + 1) / delta_P)) / N))

    return m.if_at_most(N, m.number(0), lambda: m.number(2), from_data)


@bound(
    title="transition bonus of a policy",
    symbol=r"b_t(\pi)",
    source="audit R6",
    group="online",
    status="repaired",
    trivial=lambda m, eta: 2 * eta,
    spends=("delta_P",),
    words="the estimated dynamics change every policy's expectation by at most {value}",
    assumptions=(*EVENT, "the function varies by at most 2 eta; it may be random and depend on the data"),
    conditions=(SAME_CELLS,),
    monotone={
        "eta": rises("it multiplies"),
        "S": rises("every epsilon_N rises"),
        "A": rises("every epsilon_N rises"),
        "delta_P": falls("every epsilon_N falls"),
    },
)
def transition_bonus(
    m: Arithmetic, *, S: Value, A: Value, eta: Value, delta_P: Value, occupancy: Value, counts: Value
) -> Value:
    r"""Statement: for every policy, round and function ``f`` with values in an interval of length :math:`2\eta`,

    .. math:: |E_{P_*^\pi}f-E_{\hat P_t^\pi}f|\le b_t(\pi)
       =\eta\min\Bigl(2,\sum_{s,a}q(s,a)\,\epsilon_{N(s,a)}\Bigr).

    Source: audit R6 (hybrid argument). Assumptions: as ``bonus_radius``. Arguments: ``S, A`` positive integers, ``eta``
    > 0 (``B W`` for utilities), ``delta_P`` in (0, 1), ``occupancy`` q the expected uses of each cell in steps 1 to H-1
    under either dynamics, any shape, ``counts`` the transitions seen out of each cell, same shape, zeros allowed.
    Returns a number in the units of ``eta``. Errors: ``InputError``.

    >>> round(float(transition_bonus.estimate(S=5, A=4, eta=1, delta_P=0.05, occupancy=[6, 1], counts=[1000, 0])), 3)
    2.0
    """
    expected = m.sum(lambda q, N: q * bonus_radius(m, S=S, A=A, delta_P=delta_P, N=N), occupancy, counts)
    return eta * m.min(m.number(2), expected)


@bound(
    title="estimated bonus in terms of the true one",
    symbol=r"E_{\hat P^\pi}\textstyle\sum\epsilon",
    source="audit R6",
    group="online",
    status="repaired",
    spends=("delta_P",),
    words="the summed L1 radii expected under the estimated dynamics are at most {value}",
    assumptions=EVENT,
    monotone={"H": rises("it multiplies"), "true_bonus": rises("it multiplies")},
)
def estimated_radius_sum(m: Arithmetic, *, H: Value, delta_P: Value, true_bonus: Value) -> Value:
    r"""Statement: :math:`E_{\hat P^\pi}\sum_{h<H}\epsilon\le H\,E_{P_*^\pi}\sum_{h<H}\epsilon`.

    Source: audit R6, last line. Assumptions: as ``bonus_radius``. Arguments: ``H`` a positive integer, ``delta_P`` in
    (0, 1), ``true_bonus`` = :math:`E_{P_*^\pi}\sum_{h<H}\epsilon` >= 0. Returns an L1 distance. Errors: ``InputError``.

    >>> float(estimated_radius_sum.estimate(H=8, delta_P=0.05, true_bonus=0.5))
    4.0
    """
    return H * true_bonus
