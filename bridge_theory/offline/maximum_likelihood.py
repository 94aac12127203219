"""Squared Hellinger error of the maximum-likelihood density: finite classes, covers, misspecification."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, requires, rises, total
from bridge_theory.offline.assumptions import INDEPENDENT, REALIZABLE

_WORDS = "the squared Hellinger error of the maximum-likelihood estimate is at most {value}"
_COVER = rises("more elements to tell apart")
_MORE_DATA = falls("n divides a nonnegative number")
_SURER = falls("log(1/delta) falls")
_SCALE = rises("it is added")
_MISFIT = rises("log(1 + chi2) rises")


@bound(
    title="maximum likelihood over a cover, as typeset",
    symbol=r"H^2(\hat g, g^*)",
    source="lemma:fostermle",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(INDEPENDENT,),
    monotone={
        "log_covering": _COVER,
        "epsilon": _SCALE,
        "chi2": _MISFIT,
        "delta": rises("the text typesets log(2 N / (1/delta)) = log(2 N delta)"),
    },
)
def mle_covering_stated(
    m: Arithmetic, *, n: Value, delta: Value, log_covering: Value, epsilon: Value, chi2: Value
) -> Value:
    r"""Statement, to the letter: for every :math:`\varepsilon>0`, with :math:`\mathcal N=\mathcal N_{\log}(\mathcal
    G,\varepsilon)`,

    .. math:: H^2(\hat g,g^*)\le\frac{6\log(2\mathcal N/\delta^{-1})}{n}+4\varepsilon+2\log(1+\chi^2)\quad\text{w.p.
    }1-\delta.

    Source: ``lemma:fostermle``; false as typeset (``delta^{-1}`` in the denominator gives negative bounds), repaired by
    ``mle_misspecified_repaired``. Assumptions: independent data; ``chi2`` is the divergence from the truth to the
    class. Arguments: ``n`` integer, ``delta`` in (0, 1), ``log_covering`` in nats at scale ``epsilon``, ``chi2 >=
    0``. Returns a bound claimed for a squared Hellinger distance. Errors: ``InputError`` outside the domain.

    >>> mle_covering_stated.estimate(n=10, delta=0.25, log_covering=0, epsilon=0.001, chi2=0) < 0
    np.True_
    """
    return total(
        estimation=6 * (m.log(2 * delta) + log_covering) / n, cover=4 * epsilon, misspecification=2 * m.log1p(chi2)
    )


@bound(
    title="maximum likelihood over a finite class, as typeset",
    symbol=r"H^2(\hat g, g^*)",
    source="lemma:fostermle",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(INDEPENDENT,),
    monotone={
        "class_size": _COVER,
        "chi2": _MISFIT,
        "delta": rises("the text typesets log(2 |G| / (1/delta)) = log(2 |G| delta)"),
    },
)
def mle_finite_stated(m: Arithmetic, *, n: Value, delta: Value, class_size: Value, chi2: Value) -> Value:
    r"""Statement, to the letter: :math:`H^2(\hat g,g^*)\le 6\log(2|\mathcal G|/\delta^{-1})/n+2\log(1+\chi^2)` w.p.
    :math:`1-\delta`.

    Source: ``lemma:fostermle``, finite case; false as typeset, repaired by ``mle_finite_repaired`` (realizable) and
    ``mle_misspecified_repaired``. Assumptions: independent data. Arguments: ``n, class_size`` integers, ``delta`` in
    (0, 1), ``chi2 >= 0``. Returns a bound claimed for a squared Hellinger distance. Errors: ``InputError``.

    >>> round(float(mle_finite_stated.estimate(n=100, delta=0.5, class_size=1024, chi2=0)), 4)
    0.4159
    """
    return total(estimation=6 * m.log(2 * class_size * delta) / n, misspecification=2 * m.log1p(chi2))


@bound(
    title="maximum likelihood over a finite class",
    symbol=r"H^2(\hat g, g^*)",
    source="audit T6(i)",
    group="offline",
    status="repaired",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(INDEPENDENT, REALIZABLE),
    conditions=(requires(lambda class_size: class_size >= 2, "a class of at least two elements"),),
    monotone={"class_size": _COVER, "n": _MORE_DATA, "delta": _SURER},
)
def mle_finite_repaired(m: Arithmetic, *, n: Value, delta: Value, class_size: Value) -> Value:
    r"""Statement: :math:`H^2(\hat g,g^*)\le\log((|\mathcal G|-1)/\delta)/n` with probability at least :math:`1-\delta`.

    Source: audit T6(i), any tie-break. Assumptions: independent data, ``g*`` in the class, at least two elements.
    Arguments: ``n, class_size`` integers, ``delta`` in (0, 1). Returns a squared Hellinger distance; vacuous from 1 on.
    Errors: ``InputError`` for a class of one element or outside the domain.

    >>> round(float(mle_finite_repaired.estimate(n=100, delta=0.05, class_size=1024)), 4)
    0.0993
    """
    return m.log((class_size - 1) / delta) / n


@bound(
    title="maximum likelihood over a finite class, exact tail",
    symbol=r"H^2(\hat g, g^*)",
    source="audit T6(i)",
    group="offline",
    status="sharp",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(INDEPENDENT, REALIZABLE),
    conditions=(requires(lambda class_size: class_size >= 2, "a class of at least two elements"),),
    monotone={"class_size": _COVER, "n": _MORE_DATA, "delta": _SURER},
)
def mle_finite_sharp(m: Arithmetic, *, n: Value, delta: Value, class_size: Value) -> Value:
    r"""Statement: :math:`H^2(\hat g,g^*)\le 1-(\delta/(|\mathcal G|-1))^{1/n}` with probability at least
    :math:`1-\delta`.

    Source: audit T6(i): the tail is :math:`(|\mathcal G|-1)(1-R)^n`. Assumptions: independent data, ``g*`` in the
    class, at least two elements. Arguments: ``n, class_size`` integers, ``delta`` in (0, 1). Returns a squared
    Hellinger distance, below 1. Errors: ``InputError`` for a class of one element or outside the domain.

    >>> round(float(mle_finite_sharp.estimate(n=100, delta=0.05, class_size=1024)), 4)
    0.0945
    """
    return m.one_minus_root(delta / (class_size - 1), n)


@bound(
    title="maximum likelihood over a cover",
    symbol=r"H^2(\hat g, g^*)",
    source="audit T6(ii)",
    group="offline",
    status="repaired",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(INDEPENDENT, REALIZABLE),
    monotone={"n": _MORE_DATA, "delta": _SURER, "log_covering": _COVER, "epsilon": _SCALE},
)
def mle_covering_repaired(m: Arithmetic, *, n: Value, delta: Value, log_covering: Value, epsilon: Value) -> Value:
    r"""Statement: for every :math:`\varepsilon>0`, :math:`H^2(\hat g,g^*)\le 2\log(\mathcal
    N(\varepsilon)/\delta)/n+2\varepsilon`.

    Source: audit T6(ii). Assumptions: independent data, ``g*`` in the class. Arguments: ``n`` integer, ``delta`` in
    (0, 1), ``log_covering`` in nats at scale ``epsilon`` > 0. Returns a squared Hellinger distance; vacuous from 1 on.
    Errors: ``InputError`` outside the domain.

    >>> round(float(mle_covering_repaired.estimate(n=1000, delta=0.05, log_covering=50, epsilon=0.01)), 4)
    0.126
    """
    return total(estimation=2 * (log_covering - m.log(delta)) / n, cover=2 * epsilon)


@bound(
    title="maximum likelihood when the truth may be outside the class",
    symbol=r"H^2(\hat g, g^*)",
    source="audit T6(iii)",
    group="offline",
    status="repaired",
    trivial=1,
    spends=("delta",),
    words=_WORDS,
    assumptions=(INDEPENDENT,),
    monotone={"n": _MORE_DATA, "delta": _SURER, "log_covering": _COVER, "epsilon": _SCALE, "chi2": _MISFIT},
)
def mle_misspecified_repaired(
    m: Arithmetic, *, n: Value, delta: Value, log_covering: Value, epsilon: Value, chi2: Value
) -> Value:
    r"""Statement: for every :math:`\varepsilon>0`,

    .. math:: H^2(\hat g,g^*)\le\frac{3\log(2\mathcal
    N(\varepsilon)/\delta)}{n}+2\varepsilon+\log(1+\chi^2)\quad\text{w.p. }1-\delta.

    Source: audit T6(iii). Assumptions: independent data; ``chi2`` is the smallest divergence from the truth to the
    class. Arguments: ``n`` integer, ``delta`` in (0, 1), ``log_covering`` in nats at scale ``epsilon`` > 0, ``chi2 >=
    0``. Returns a squared Hellinger distance; vacuous from 1 on. Errors: ``InputError`` outside the domain.

    >>> round(float(mle_misspecified_repaired.estimate(n=1000, delta=0.05, log_covering=50, epsilon=0.01, chi2=0)), 4)
    0.1811
    """
    return total(
        estimation=3 * (m.log(2 / delta) + log_covering) / n, cover=2 * epsilon, misspecification=m.log1p(chi2)
    )
