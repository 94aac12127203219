"""R_1: squared Hellinger error of the cloned policy under the true dynamics, as stated and as proved."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total
from bridge_theory.offline.assumptions import CLONE, DETERMINISTIC, INDEPENDENT, REALIZABLE

_WORDS = (
    "the squared Hellinger distance of the cloned policy from the expert, under the true dynamics, is at most {value}"
)
_ASSUMED = (DETERMINISTIC, INDEPENDENT, REALIZABLE, CLONE)
_FITTED = (INDEPENDENT, REALIZABLE, "the cloned policy maximises the likelihood over the class")
_POLICIES = rises("there are more policies")
_MORE_DATA = falls("n divides a nonnegative number")
_SURER = falls("log(1/delta) falls")


@bound(
    title="policy error R_1",
    symbol="R_1",
    source="local:policy_and_transition_error",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta1",),
    words=_WORDS,
    assumptions=_ASSUMED,
    monotone={"S": _POLICIES, "A": _POLICIES, "n": _MORE_DATA, "delta1": _SURER},
)
def policy_error_stated(m: Arithmetic, *, S: Value, A: Value, n: Value, delta1: Value) -> Value:
    r"""Statement: :math:`H^2(P_*^{BC},P_*^{\pi^*})\le R_1=4|S|\log(|A|/\delta_1)/n` with probability at least
    :math:`1-\delta_1`.

    Source: ``local:policy_and_transition_error``; the corollary it cites has 6, see ``policy_error_corollary``.
    Assumptions: deterministic stationary expert, independent data, realizable. Arguments: ``S, A, n`` positive
    integers, ``delta1`` in (0, 1). Returns a squared Hellinger distance; vacuous from 1 on. Errors: ``InputError``.

    >>> round(float(policy_error_stated.estimate(S=5, A=4, n=102, delta1=0.025)), 4)
    0.9951
    """
    return 4 * S * m.log(A / delta1) / n


@bound(
    title="policy error, tabular corollary",
    symbol="H^2",
    source="corr:generalization_bound_logloss_BC_deterministic_stationary_tabular_policies",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_ASSUMED,
    monotone={"S": _POLICIES, "A": _POLICIES, "n": _MORE_DATA, "delta": _SURER},
)
def policy_error_corollary(m: Arithmetic, *, S: Value, A: Value, n: Value, delta: Value) -> Value:
    r"""Statement: :math:`H^2(P_*^{BC},P_*^{\pi^*})\le 6|S|\log(|A|/\delta)/n` with probability at least
    :math:`1-\delta`.

    Source: ``corr:generalization_bound_logloss_BC_deterministic_stationary_tabular_policies``. Assumptions:
    deterministic stationary expert, independent data. Arguments: ``S, A, n`` positive integers, ``delta`` in (0, 1).
    Returns a squared Hellinger distance; vacuous from 1 on. Errors: ``InputError`` outside the domain.

    >>> round(float(policy_error_corollary.estimate(S=5, A=4, n=1000, delta=0.025)), 4)
    0.1523
    """
    return 6 * S * m.log(A / delta) / n


@bound(
    title="policy error, finite class",
    symbol="H^2",
    source="thm:generalization_bound_logloss_BC_general",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_FITTED,
    monotone={"class_size": _POLICIES, "n": _MORE_DATA, "delta": _SURER},
)
def policy_error_finite(m: Arithmetic, *, n: Value, delta: Value, class_size: Value) -> Value:
    r"""Statement: :math:`H^2(P_*^{BC},P_*^{\pi^*})\le 6\log(2|\Pi|/\delta)/n` with probability at least
    :math:`1-\delta`.

    Source: ``thm:generalization_bound_logloss_BC_general``, finite case; sharp: ``mle_finite_sharp``. Assumptions:
    independent data, expert in the class. Arguments: ``n, class_size`` positive integers, ``delta`` in (0, 1).
    Returns a squared Hellinger distance; vacuous from 1 on. Errors: ``InputError`` outside the domain.

    >>> round(float(policy_error_finite.estimate(n=1000, delta=0.05, class_size=1024)), 4)
    0.0637
    """
    return 6 * m.log(2 * class_size / delta) / n


@bound(
    title="policy error, policy cover",
    symbol="H^2",
    source="thm:generalization_bound_logloss_BC_general",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_FITTED,
    monotone={"log_covering": _POLICIES, "n": _MORE_DATA, "delta": _SURER, "epsilon": rises("it is added")},
)
def policy_error_covering(m: Arithmetic, *, n: Value, delta: Value, log_covering: Value, epsilon: Value) -> Value:
    r"""Statement: for every :math:`\varepsilon`, :math:`H^2\le 6\log(2\mathcal
    N_{pol}(\Pi,\varepsilon/H)/\delta)/n+\varepsilon`.

    Source: ``thm:generalization_bound_logloss_BC_general``; false as stated for some classes (audit O7), proved with
    ``mle_covering_repaired``. Assumptions: independent data, expert in the class; ``log_covering`` is taken at scale
    ``epsilon / H``. Arguments: ``n`` positive integer, ``delta`` in (0, 1), ``log_covering`` in nats, ``epsilon`` > 0.
    Returns a bound claimed for a squared Hellinger distance. Errors: ``InputError`` outside the domain.

    >>> round(float(policy_error_covering.estimate(n=1000, delta=0.05, log_covering=50, epsilon=0.01)), 4)
    0.3321
    """
    return total(estimation=6 * (m.log(2 / delta) + log_covering) / n, cover=epsilon)


@bound(
    title="policy error: missing mass of the cloned policy",
    symbol="R_1",
    source="audit T7(b)",
    group="offline",
    status="repaired",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(DETERMINISTIC, INDEPENDENT, CLONE),
    monotone={"S": _POLICIES, "n": _MORE_DATA, "delta": _SURER},
)
def policy_error_repaired(m: Arithmetic, *, S: Value, n: Value, delta: Value) -> Value:
    r"""Statement: :math:`H^2(P_*^{BC},P_*^{\pi^*})\le(|S|\log 2+\log(1/\delta))/n` with probability at least
    :math:`1-\delta`.

    Source: audit T7(b): the error is the probability that a fresh trajectory meets a state without data; the number of
    actions does not enter. Assumptions: deterministic stationary expert, independent data. Arguments: ``S, n`` positive
    integers, ``delta`` in (0, 1). Returns a squared Hellinger distance; vacuous from 1 on. Errors: ``InputError``.

    >>> round(float(policy_error_repaired.estimate(S=5, n=1, delta=0.025)), 3)
    7.155
    """
    return total(states=S * m.log(m.number(2)) / n, confidence=-m.log(delta) / n)


@bound(
    title="policy error: missing mass, exact tail",
    symbol="R_1",
    source="audit T7(b)",
    group="offline",
    status="sharp",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(DETERMINISTIC, INDEPENDENT, CLONE),
    monotone={"S": _POLICIES, "n": _MORE_DATA, "delta": _SURER},
)
def policy_error_sharp(m: Arithmetic, *, S: Value, n: Value, delta: Value) -> Value:
    r"""Statement: :math:`H^2(P_*^{BC},P_*^{\pi^*})\le 1-(\delta/(2^{|S|}-1))^{1/n}` with probability at least
    :math:`1-\delta`.

    Source: audit T7(b). Assumptions: deterministic stationary expert, independent data. Arguments: ``S, n`` positive
    integers, ``delta`` in (0, 1). Returns a squared Hellinger distance, below 1. Errors: ``InputError``.

    >>> round(float(policy_error_sharp.estimate(S=5, n=10, delta=0.025)), 4)
    0.5095
    """
    return m.one_minus_root(delta / (m.power(m.number(2), S) - 1), n)
