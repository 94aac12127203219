"""From the empirical bonus to the true one: the paper's factor 2 at 2 H eta, and the sharper 1 + 1/H at H eta."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total
from bridge_theory.online.bonus import REAL_TRANSITIONS

_MONOTONE = {"true_bonus": rises("it multiplies"), "epsilon": rises("it is added")}


@bound(
    title="empirical bonus in terms of the true one, as stated",
    symbol=r"\widehat B_t(\pi,\eta,\delta)",
    source="lemma:emp_bonus_to_true_bonus",
    group="online",
    status="stated",
    spends=("delta",),
    words="the empirical bonus is at most {value} for every policy",
    assumptions=REAL_TRANSITIONS,
    monotone=_MONOTONE,
)
def empirical_from_true_bonus(m: Arithmetic, *, true_bonus: Value, epsilon: Value, delta: Value) -> Value:
    r"""Statement: :math:`\widehat B_t(\pi,\eta,\delta)\le2B_t(\pi,2H\eta,\delta,\varepsilon)+\varepsilon`.

    Source: ``lemma:emp_bonus_to_true_bonus``, repeated as ``lemma:bonus_relation`` with the proof that is right.
    Assumptions: as ``expected_bonus``. Arguments: ``true_bonus`` = :math:`B_t(\pi,2H\eta,\delta,\varepsilon)` >= 0,
    ``epsilon`` > 0, ``delta`` in (0, 1). Returns a number in the units of ``eta``. Errors: ``InputError``.

    >>> float(empirical_from_true_bonus.estimate(true_bonus=1.5, epsilon=0.25, delta=0.05))
    3.25
    """
    return total(bonus=2 * true_bonus, cover=epsilon)


@bound(
    title="empirical bonus in terms of the true one, centred",
    symbol=r"\widehat B_t(\pi,\eta,\delta)",
    source="audit C.10",
    group="online",
    status="sharp",
    spends=("delta",),
    words="the empirical bonus is at most {value} for every policy",
    assumptions=REAL_TRANSITIONS,
    monotone={**_MONOTONE, "H": falls("1 + 1/H falls")},
)
def empirical_from_true_bonus_sharp(
    m: Arithmetic, *, H: Value, true_bonus: Value, epsilon: Value, delta: Value
) -> Value:
    r"""Statement: :math:`\widehat B_t(\pi,\eta,\delta)\le(1+1/H)B_t(\pi,H\eta,\delta,\varepsilon)+\varepsilon`.

    Source: audit C.10: the summed xi lies in :math:`[0,2H\eta]`, so its centred version is at most :math:`H\eta`, and
    xi is linear in eta. Assumptions: as ``expected_bonus``. Arguments: ``H`` a positive integer, ``true_bonus`` =
    :math:`B_t(\pi,H\eta,\delta,\varepsilon)` >= 0, ``epsilon`` > 0, ``delta`` in (0, 1). Returns a number in the units
    of ``eta``. Errors: ``InputError``.

    >>> float(empirical_from_true_bonus_sharp.estimate(H=4, true_bonus=1.5, epsilon=0.25, delta=0.05))
    2.125
    """
    return total(bonus=(1 + 1 / H) * true_bonus, cover=epsilon)
