"""How well n demonstrations cover what the expert visits, and what the bonuses cost when they do."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, least, rises, total

VISITS = (
    "the demonstrations are independent",
    "every state-action pair the expert visits at a step has probability at least gamma_min there",
)
_BY_N = falls("it falls in n gamma_min")


@bound(
    title="how many state-action pairs the expert can visit",
    symbol=r"|S_{\mathrm{reach}}|",
    source="audit R10",
    group="online",
    status="repaired",
    trivial=lambda m, S, A: S * A,
    words="the expert visits at most {value} state-action pairs",
    assumptions=VISITS[1:],
    monotone={
        "S": rises("S A does"),
        "A": rises("S A does"),
        "H": rises("H / gamma_min does"),
        "gamma_min": falls("it divides"),
    },
)
def reach_size(m: Arithmetic, *, S: Value, A: Value, H: Value, gamma_min: Value) -> Value:
    r"""Statement: :math:`|S_{reach}|\le\min\{|S||A|,H/\gamma_{\min}\}`.

    Source: audit R10 (at each step the visited pairs have probabilities >= gamma_min that sum to 1). Assumptions:
    minimum visitation. Arguments: ``S, A, H`` positive integers, ``gamma_min`` in (0, 1]. Returns a number of pairs.
    Errors: ``InputError``.

    >>> float(reach_size.estimate(S=50, A=4, H=8, gamma_min=0.5))
    16.0
    """
    return least(all_pairs=S * A, visited=H / gamma_min)


@bound(
    title="probability that the demonstrations miss coverage",
    symbol=r"P(\mathrm{uncovered})",
    source="audit R10",
    group="online",
    status="repaired",
    trivial=1,
    words="a pair of the expert has fewer than n gamma_min / 2 recorded transitions with probability at most {value}",
    assumptions=VISITS,
    monotone={"S_reach": rises("it multiplies"), "n": _BY_N, "gamma_min": _BY_N},
)
def coverage_failure(m: Arithmetic, *, S_reach: Value, n: Value, gamma_min: Value) -> Value:
    r"""Statement: :math:`P\bigl(\exists(s,a)\in S_{reach}:N_{off}(s,a)<n\gamma_{\min}/2\bigr)
    \le|S_{reach}|e^{-n\gamma_{\min}/8}`.

    Source: audit R10 (multiplicative Chernoff for the number of trajectories that visit the pair in steps 1 to H-1).
    Assumptions: independent demonstrations, minimum visitation. Arguments: ``S_reach`` the pairs the expert visits in
    steps 1 to H-1, ``n`` a positive integer, ``gamma_min`` in (0, 1]. Returns a probability, vacuous from 1 on.
    Errors: ``InputError``.

    >>> round(float(coverage_failure.estimate(S_reach=5, n=1000, gamma_min=0.1)), 8)
    1.863e-05
    """
    return S_reach * m.exp(-n * gamma_min / 8)


@bound(
    title="summed bonuses of any policy on the covered event",
    symbol=r"E_{P_*^\pi}\textstyle\sum_{h<H}\xi_t",
    source="audit R10",
    group="online",
    status="repaired",
    trivial=lambda m, eta, H: 2 * eta * (H - 1),
    words="the summed bonuses of a policy are at most {value} in expectation, on the covered event",
    assumptions=(
        *VISITS,
        "every pair of the expert has at least n gamma_min / 2 recorded transitions (see coverage_failure)",
    ),
    monotone={
        "H": rises("H - 1 does"),
        "eta": rises("it multiplies"),
        "log_covering": rises("it is under the root"),
        "n": falls("it divides"),
        "gamma_min": falls("it divides"),
        "Delta_n": rises("it multiplies"),
    },
)
def covered_bonus(
    m: Arithmetic, *, H: Value, eta: Value, log_covering: Value, n: Value, gamma_min: Value, Delta_n: Value
) -> Value:
    r"""Statement: :math:`E_{P_*^\pi}\sum_{h<H}\xi_t\le(H-1)4\eta\sqrt{2U/(n\gamma_{\min})}
    +2\eta(H-1)\mathrm{TV}(P_*^\pi,P_*^{\pi^*})`.

    Source: audit R10; it replaces the n-dependent bonus lemmas, which are false off the covered pairs. Assumptions:
    minimum visitation, the covered event. Arguments: ``H`` a positive integer, ``eta`` > 0, ``log_covering`` = the
    logarithmic term U >= 0 of xi, ``n`` a positive integer, ``gamma_min`` in (0, 1], ``Delta_n`` in [0, 1] a bound on
    the policy's total variation from the expert. Returns a number in the units of ``eta``. Errors: ``InputError``.

    >>> round(float(covered_bonus.estimate(H=8, eta=1, log_covering=30, n=10000, gamma_min=0.1, Delta_n=0.01)), 3)
    6.999
    """
    steps = H - 1
    return total(
        covered=steps * 4 * eta * m.sqrt(2 * log_covering / (n * gamma_min)), uncovered=2 * eta * steps * Delta_n
    )
