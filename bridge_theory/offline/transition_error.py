"""R_2: squared Hellinger error of the estimated dynamics under the expert, as stated and as proved a priori."""

from __future__ import annotations

import numpy as np

from bridge_theory.arithmetic.protocol import FloatArray
from bridge_theory.core import Arithmetic, Value, bound, falls, rate, rises, total
from bridge_theory.offline.assumptions import FITTED, INDEPENDENT, REALIZABLE, ROWS, STATIONARY

_WORDS = (
    "the squared Hellinger distance between the estimated and the true dynamics, under the expert, is at most {value}"
)
_ASSUMED = (STATIONARY, INDEPENDENT, REALIZABLE, FITTED)
_LARGER = rises("there are more kernels to tell apart")
_MORE_DATA = falls("for every cover the bound falls, hence so does the infimum")
_SURER = falls("log(1/delta) falls")
_LONGER = rises("for every cover the bound rises, hence so does the infimum")


@bound(
    title="transition error R_2",
    symbol="R_2",
    source="local:policy_and_transition_error",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta2",),
    words=_WORDS,
    assumptions=_ASSUMED,
    monotone={
        "S": _LARGER,
        "A": _LARGER,
        "H": rises("log rises"),
        "n": falls("log(cn)/n falls on the integers for c >= 2", where=lambda H, delta2: 2 * delta2 <= H),
        "delta2": _SURER,
    },
)
def transition_error_stated(m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, delta2: Value) -> Value:
    r"""Statement: :math:`H^2(\hat P^{\pi^*},P_*^{\pi^*})\le R_2=4|S|^2|A|\log(nH/\delta_2)/n` w.p. at least
    :math:`1-\delta_2`.

    Source: ``local:policy_and_transition_error``. Assumptions: stationary kernel in the class, independent data; true
    for ``delta2 <= 1/2`` or ``n H >= 2`` (audit O17). Arguments: ``S, A, H, n`` positive integers, ``delta2`` in (0,
    1). Returns a squared Hellinger distance; vacuous from 1 on. Errors: ``InputError`` outside the domain.

    >>> round(float(transition_error_stated.estimate(S=5, A=4, H=8, n=5772, delta2=0.025)), 4)
    0.9999
    """
    return 4 * S**2 * A * m.log(n * H / delta2) / n


@bound(
    title="transition error at a cover",
    symbol="H^2",
    source="local:transition_generalization",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_ASSUMED,
    monotone={"n": falls("n divides"), "delta": _SURER, "log_covering": _LARGER, "epsilon": rises("it is added")},
)
def transition_error_covering(m: Arithmetic, *, n: Value, delta: Value, log_covering: Value, epsilon: Value) -> Value:
    r"""Statement: for every :math:`\varepsilon`, :math:`H^2\le 6\log(2\mathcal
    N_{trans}(\varepsilon/H)/\delta)/n+\varepsilon`.

    Source: ``local:transition_generalization``; false as stated for some classes (audit O10), proved with
    ``mle_covering_repaired``. Assumptions: stationary kernel in the class, independent data; ``log_covering`` at scale
    ``epsilon / H``. Arguments: ``n`` positive integer, ``delta`` in (0, 1), ``log_covering`` in nats, ``epsilon`` > 0.
    Returns a bound claimed for a squared Hellinger distance. Errors: ``InputError`` outside the domain.

    >>> round(float(transition_error_covering.estimate(n=1000, delta=0.05, log_covering=50, epsilon=0.01)), 4)
    0.3321
    """
    return total(estimation=6 * (m.log(2 / delta) + log_covering) / n, cover=epsilon)


@bound(
    title="transition error at the best cover of the paper",
    symbol="H^2",
    source="local:transition_generalization",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=_ASSUMED,
    monotone={"S": _LARGER, "A": _LARGER, "H": _LONGER, "n": _MORE_DATA, "delta": _SURER},
)
def transition_error_infimum(m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, delta: Value) -> Value:
    r"""Statement: with :math:`D=|S||A|(|S|-1)`,

    .. math:: H^2\le\inf_{\varepsilon>0}\Bigl\{\tfrac{6(\log
    2+D\log(H/\varepsilon+1)+\log(1/\delta))}{n}+\varepsilon\Bigr\}.

    Source: ``local:transition_generalization`` and the covering lemma after it put together; the infimum is attained
    where :math:`\varepsilon^2+H\varepsilon=6DH/n`. Assumptions: as for the theorem; its covering lemma is false for
    three or more states. Arguments: ``S, A, H, n`` positive integers, ``delta`` in (0, 1). Returns a bound claimed
    for a squared Hellinger distance. Errors: ``InputError`` outside the domain.

    >>> round(float(transition_error_infimum.estimate(S=5, A=4, H=8, n=5000, delta=0.05)), 4)
    0.5262
    """
    dimension = S * A * (S - 1)
    product = 6 * dimension * H / n
    epsilon = 2 * product / (H + m.sqrt(H**2 + 4 * product))
    # at S = 1 the minimiser is 0 and nothing is covered
    nats = m.if_at_most(S, 1, lambda: m.number(0), lambda: dimension * m.log1p(H / epsilon))
    return total(estimation=6 * nats / n, confidence=6 * m.log(2 / delta) / n, cover=epsilon)


@rate(
    title="transition error, O-form",
    symbol=r"H^2(\hat P^{\pi^*}, P_*^{\pi^*})",
    source="corr:stochastic_stationary_transition_tabular_setting",
    group="offline",
)
def transition_error_rate(m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, delta: Value) -> Value:
    r"""Statement: :math:`O(|S|^2|A|\log(nH/\delta)/n)`; leading expression with unit constant, for scaling only.

    Source: ``corr:stochastic_stationary_transition_tabular_setting``. Assumptions: as for the theorem. Arguments:
    ``S, A, H, n`` positive integers, ``delta`` in (0, 1). Returns a scale, not a bound. Errors: ``InputError``.

    >>> round(float(transition_error_rate.estimate(S=5, A=4, H=8, n=1000, delta=0.05)), 3)
    1.198
    """
    return S**2 * A * m.log(n * H / delta) / n


def _best_denominator(S: FloatArray, rows: FloatArray, H: FloatArray, n: FloatArray) -> FloatArray:
    # Newton on n-independent stationarity: M (M+S-1) (psi(M+2S-1) - psi(M+S)) / (S-1) = n H / rows
    goal = n * H / rows
    others = np.maximum(S - 1, 1.0)
    guess = goal + others
    for _ in range(5):
        low, high = guess + S - 0.5, guess + 2 * S - 1.5
        harmonic = np.log1p(others / low) + (1 / high**2 - 1 / low**2) / 24
        product = guess * (guess + others)
        slope = (2 * guess + others) * harmonic - product * others / (low * high)
        guess = np.maximum(guess - (product * harmonic - goal * others) / slope, 0.5)
    return np.asarray(guess)


@bound(
    title="transition error at the best lattice cover",
    symbol="R_2",
    source="audit T6(ii), T11",
    group="offline",
    status="repaired",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(*_ASSUMED, ROWS),
    monotone={"S": _LARGER, "rows": _LARGER, "H": _LONGER, "n": _MORE_DATA, "delta": _SURER},
)
def transition_error_repaired(m: Arithmetic, *, S: Value, H: Value, n: Value, delta: Value, rows: Value) -> Value:
    r"""Statement: :math:`H^2(\hat P^{\pi^*},P_*^{\pi^*})\le\inf_{\varepsilon>0}\{2\log(\mathcal
    N(\varepsilon/H)/\delta)/n+2\varepsilon\}` with the lattice cover of T11. The covering number only changes where
    :math:`\varepsilon/H=\log(1+(|S|-1)/k)`, so the infimum is exactly

    .. math::
    \min_{k\ge1}\Bigl\{\tfrac{2\,\mathrm{rows}}{n}\log\tbinom{k+2|S|-2}{|S|-1}+2H\log\bigl(1+\tfrac{|S|-1}{k}\bigr)\Bigr\}
       +\tfrac{2\log(1/\delta)}{n}.

    The bracket strictly falls and then strictly rises in ``k`` (the sign of its slope is that of an increasing
    function), so two neighbours certify the minimum. Source: audit T6(ii) with T11. Assumptions: stationary kernel,
    independent data; ``rows = S`` only suffices for a deterministic stationary expert. Arguments: ``S, H, n, rows``
    positive integers, ``delta`` in (0, 1). Returns a squared Hellinger distance; vacuous from 1 on. Errors:
    ``InputError`` outside the domain.

    >>> round(float(transition_error_repaired.estimate(S=5, H=8, n=736, delta=0.025, rows=5)), 4)
    0.4057
    """
    covering = m.if_at_most(
        S,
        1,
        lambda: m.number(0),
        lambda: m.minimum_over_integers(
            lambda k: 2 * rows / n * m.log_binomial(k + 2 * S - 2, S - 1) + 2 * H * m.log1p((S - 1) / k),
            lambda k: 2 * rows / n * m.log1p((S - 1) / (k + S)) + 2 * H * m.log1p(-(S - 1) / ((k + 1) * (k + S - 1))),
            _best_denominator,
            S,
            rows,
            H,
            n,
        ),
    )
    return total(covering=covering, confidence=-2 * m.log(delta) / n)


@bound(
    title="transition error, closed form",
    symbol="R_2",
    source="audit T11, corollary",
    group="offline",
    status="repaired",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(*_ASSUMED, ROWS),
    monotone={
        "H": rises("log rises"),
        "n": falls("log(a n + 3)/n and 1/n fall"),
        "delta": _SURER,
        "rows": rises("D (log(nH/D + 3) + 2) has slope at least 1 + log 3 > 0 in D"),
        "S": rises("as in rows: D rises with S"),
    },
)
def transition_error_closed_form(m: Arithmetic, *, S: Value, H: Value, n: Value, delta: Value, rows: Value) -> Value:
    r"""Statement: with :math:`D=\mathrm{rows}(|S|-1)`,
    :math:`H^2\le\frac{2D}{n}\bigl[\log(nH/D+3)+2\bigr]+\frac{2\log(1/\delta)}{n}`.

    Source: corollary of audit T11, at :math:`\varepsilon=D/n`. Assumptions: stationary kernel, independent data;
    ``rows`` as in ``transition_error_repaired``. Arguments: ``S, H, n, rows`` positive integers, ``delta`` in (0, 1).
    Returns a squared Hellinger distance; vacuous from 1 on. Errors: ``InputError`` outside the domain.

    >>> round(float(transition_error_closed_form.estimate(S=5, H=8, n=736, delta=0.025, rows=5)), 4)
    0.4282
    """
    dimension = rows * (S - 1)
    nats = m.if_at_most(S, 1, lambda: m.number(0), lambda: dimension * (m.log(n * H / dimension + 3) + 2))
    return total(covering=2 * nats / n, confidence=-2 * m.log(delta) / n)
