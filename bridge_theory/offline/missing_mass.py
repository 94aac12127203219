"""How likely a fresh expert trajectory is to meet a state that no demonstration acted in."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, requires, rises, total
from bridge_theory.offline.assumptions import DETERMINISTIC, INDEPENDENT

_ASSUMED = (DETERMINISTIC, INDEPENDENT)
_WORDS = "a fresh expert trajectory meets a state without data with probability at most {value}"


@bound(
    title="expected missing mass",
    symbol=r"\mathbb{E} M",
    source="audit T7(a)",
    group="offline",
    status="sharp",
    trivial=1,
    words="on average over the demonstrations, " + _WORDS,
    assumptions=_ASSUMED,
    monotone={
        "S": rises("it multiplies"),
        "n": falls("n^n / (n+1)^(n+1) is the maximum over q of q (1-q)^n, which falls for every q"),
    },
)
def missing_mass_expected(m: Arithmetic, *, S: Value, n: Value) -> Value:
    r"""Statement: :math:`\mathbb E M\le|S|\,n^n/(n+1)^{n+1}\le|S|/(en)`.

    Source: audit T7(a), for any first state (a fixed one allows ``S - 1``). Assumptions: deterministic stationary
    expert, independent data. Arguments: ``S, n`` positive integers. Returns a probability. Errors: ``InputError``.

    >>> float(missing_mass_expected.estimate(S=4, n=1))
    1.0
    """
    return S / (n + 1) * m.power_near_one(-1 / (n + 1), n)


@bound(
    title="missing mass from the states seen",
    symbol="M",
    source="audit T7(c)",
    group="offline",
    status="sharp",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_ASSUMED,
    conditions=(requires(lambda S, unvisited: unvisited <= S, "unvisited <= S"),),
    monotone={
        "n": falls("the n-th root of a number below 1 rises"),
        "delta": falls("it is the probability that is spent"),
    },
)
def missing_mass_observed(m: Arithmetic, *, S: Value, n: Value, unvisited: Value, delta: Value) -> Value:
    r"""Statement: with :math:`k` states unseen, :math:`M\le 1-\bigl(\delta/(|S|\binom{|S|}{k})\bigr)^{1/n}` w.p.
    :math:`1-\delta`; :math:`M=0` if :math:`k=0`.

    Source: audit T7(c); it bounds the squared Hellinger error of the cloned policy. Assumptions: deterministic
    stationary expert, independent data. Arguments: ``S, n`` positive integers, ``unvisited`` from 0 to ``S``,
    ``delta`` in (0, 1). Returns a probability. Errors: ``InputError`` if more states are unseen than exist.

    >>> float(missing_mass_observed.estimate(S=5, n=10, unvisited=0, delta=0.05))
    0.0
    >>> round(float(missing_mass_observed.estimate(S=5, n=10, unvisited=2, delta=0.05)), 4)
    0.4988
    """
    return m.if_at_most(
        unvisited,
        0,
        lambda: m.number(0),
        lambda: -m.expm1((m.log(delta / S) - m.log_binomial(S, unvisited)) / n),
    )


@bound(
    title="missing mass from the demonstrations that are unlike any other",
    symbol="M",
    source="audit T7(d)",
    group="offline",
    status="repaired",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(*_ASSUMED, "the constant of McAllester and Schapire (2000) is cited, not checked here"),
    conditions=(requires(lambda n, singletons: singletons <= n, "singletons <= n"),),
    monotone={
        "singletons": rises("it is added"),
        "n": falls("n divides nonnegative numbers"),
        "delta": falls("log(3/delta) falls"),
    },
)
def missing_mass_good_turing(m: Arithmetic, *, n: Value, singletons: Value, delta: Value) -> Value:
    r"""Statement: :math:`M\le g/n+(2\sqrt2+\sqrt3)\sqrt{\log(3/\delta)/n}` with probability at least :math:`1-\delta`.

    Source: audit T7(d), Good-Turing over the set of states a trajectory visits. Assumptions: deterministic stationary
    expert, independent data; the constant is cited. Arguments: ``n`` positive integer, ``singletons`` the
    demonstrations whose visited set occurs once, ``delta`` in (0, 1). Returns a probability bound. Errors:
    ``InputError``.

    >>> round(float(missing_mass_good_turing.estimate(n=1000, singletons=3, delta=0.05)), 4)
    0.2948
    """
    deviation = (2 * m.sqrt(m.number(2)) + m.sqrt(m.number(3))) * m.sqrt(m.log(3 / delta) / n)
    return total(seen_once=singletons / n, deviation=deviation)
