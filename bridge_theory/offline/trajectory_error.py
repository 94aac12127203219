"""From the errors of single transition rows to the error of whole trajectories, and back."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from bridge_theory.core import Arithmetic, Value, bound, requires, rises

_WORDS = "the squared Hellinger distance between the estimated and the true trajectory law is at most {value}"
_SAME_CELLS = requires(
    lambda occupancy, row_errors: np.size(occupancy) == np.size(row_errors),
    "one row error for each cell of the occupancy",
)
_BOTH_OCCUPANCIES = requires(
    lambda occupancy, occupancy_hat: np.size(occupancy) == np.size(occupancy_hat), "both occupancies of the same cells"
)
_COMMON = "both trajectory laws share policy and first-state distribution"


@bound(
    title="trajectory error as the paper bounds it",
    symbol="H^2",
    source="lemma:technical_result",
    group="offline",
    status="stated",
    trivial=1,
    words=_WORDS,
    assumptions=("R2 bounds the squared Hellinger error under the expert", "C is the concentrability coefficient"),
    monotone={"H": rises("it multiplies"), "C": rises("it multiplies"), "R2": rises("it multiplies")},
)
def trajectory_error_stated(m: Arithmetic, *, H: Value, C: Value, R2: Value) -> Value:
    r"""Statement: :math:`H^2(\hat P^\pi,P_*^\pi)\le H\,C(\pi,\pi^*)\,H^2(\hat P^{\pi^*},P_*^{\pi^*})`.

    Source: ``lemma:technical_result``; false where the policy leaves the expert's support (audit O15). Assumptions:
    none beyond the definitions. Arguments: ``H`` positive integer, ``C >= 0``, ``R2 >= 0``. Returns a bound claimed
    for a squared Hellinger distance. Errors: ``InputError`` outside the domain.

    >>> float(trajectory_error_stated.estimate(H=8, C=2, R2=0.0625))
    1.0
    """
    return H * C * R2


@bound(
    title="trajectory error from row errors, both occupancies",
    symbol="H^2",
    source="audit T1",
    group="offline",
    status="sharp",
    trivial=1,
    words=_WORDS,
    assumptions=(_COMMON,),
    conditions=(_SAME_CELLS, _BOTH_OCCUPANCIES),
)
def trajectory_error_symmetrised(m: Arithmetic, *, occupancy: Value, occupancy_hat: Value, row_errors: Value) -> Value:
    r"""Statement: :math:`H^2(\hat P^\pi,P_*^\pi)\le\frac12\sum_{t,s,a}(\hat d_t+d_t)(s,a)\,h(s,a)`.

    Source: audit T1, replacing Step 1 of ``lemma:technical_result``. Assumptions: common policy and first state.
    Arguments: three arrays of one length, one entry per (step, state, action): the occupancies under the true and the
    estimated dynamics and the squared Hellinger error of the row. Returns a squared Hellinger distance. Errors:
    ``InputError`` outside the domain.

    >>> float(trajectory_error_symmetrised.estimate(occupancy=[1, 0.5], occupancy_hat=[1, 0.25], row_errors=[0.25, 0]))
    0.25
    """
    return m.sum(lambda d, d_hat, h: (d + d_hat) * h / 2, occupancy, occupancy_hat, row_errors)


@bound(
    title="trajectory error from row errors, one occupancy",
    symbol="H^2",
    source="audit T2",
    group="offline",
    status="repaired",
    trivial=1,
    words=_WORDS,
    assumptions=(_COMMON,),
    conditions=(_SAME_CELLS,),
)
def trajectory_error_one_sided(m: Arithmetic, *, occupancy: Value, row_errors: Value) -> Value:
    r"""Statement: :math:`H^2(\hat P^\pi,P_*^\pi)\le 2.97\sum_{t,s,a}d_t(s,a)\,h(s,a)`, the occupancy under either of
    the two dynamics.

    Source: audit T2; the best constant is between 2.9615 and 2.97. Assumptions: common policy and first state.
    Arguments: two arrays of one length, one entry per (step, state, action). Returns a squared Hellinger distance.
    Errors: ``InputError`` outside the domain.

    >>> float(trajectory_error_one_sided.estimate(occupancy=[1, 0.5], row_errors=[0.25, 0]))
    0.7425
    """
    return m.number(Fraction(297, 100)) * m.sum(lambda d, h: d * h, occupancy, row_errors)


@bound(
    title="expected row error at one step",
    symbol=r"\mathbb{E}_{d^*_t} h_t",
    source="audit T4",
    group="offline",
    status="sharp",
    trivial=1,
    words="the squared Hellinger error of a transition row averages at most {value} at any step of the expert",
    assumptions=("R bounds the squared Hellinger error of the dynamics under the expert",),
    monotone={"R": rises("u (2 - u) rises on [0, 1]")},
)
def row_error_at_step(m: Arithmetic, *, R: Value) -> Value:
    r"""Statement: :math:`\mathbb E_{d_t^*}[h_t]\le u(2-u)` with :math:`u=H^2(\hat P^{\pi^*},P_*^{\pi^*})`.

    Source: audit T4, replacing Step 3 of ``lemma:technical_result``; attained for every ``u``. Assumptions: none.
    Arguments: ``R`` = ``u`` in [0, 1]. Returns an expected squared Hellinger distance. Errors: ``InputError``.

    >>> float(row_error_at_step.estimate(R=0.5))
    0.75
    """
    return R * (2 - R)


@bound(
    title="expected row errors summed over a trajectory",
    symbol=r"\sum_t\mathbb{E}_{d^*_t} h_t",
    source="audit T4",
    group="offline",
    status="sharp",
    trivial=lambda m, H: H,
    words="the expected squared Hellinger errors of the expert's transition rows sum to at most {value}",
    assumptions=("R bounds the squared Hellinger error of the dynamics under the expert", "H transitions a trajectory"),
    monotone={"R": rises("1 + (H - 1)(2 - 2u) > 0 is its slope"), "H": rises("it multiplies")},
)
def row_error_summed(m: Arithmetic, *, R: Value, H: Value) -> Value:
    r"""Statement: :math:`\sum_{t<H}\mathbb E_{d_t^*}[h_t]\le u(1+(H-1)(2-u))` with :math:`u=H^2(\hat
    P^{\pi^*},P_*^{\pi^*})`.

    Source: audit T4; attained for every ``u``. Assumptions: ``H`` counts the transitions of a trajectory. Arguments:
    ``R`` = ``u`` in [0, 1], ``H`` positive integer. Returns a sum of expected squared Hellinger distances. Errors:
    ``InputError`` outside the domain.

    >>> float(row_error_summed.estimate(R=0.5, H=3))
    2.0
    """
    return R * (1 + (H - 1) * (2 - R))
