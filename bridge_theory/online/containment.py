"""How likely it is that the best policy ever leaves the online policy sets: the events the repaired sets need."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, rises, total
from bridge_theory.online.confidence import MODEL
from bridge_theory.online.l1_bonus import EVENT

_SETS = (*MODEL, "the offline set contains the best policy up to its own failure probability")
_ADDED = rises("it is added")


@bound(
    title="probability that the best policy leaves the sets, known dynamics",
    symbol=r"P(\exists t:\pi^*\notin\Pi_t)",
    source="audit R2",
    group="online",
    status="repaired",
    trivial=1,
    words="the best policy is missing from some round's set with probability at most {value}",
    assumptions=_SETS,
    monotone={"delta_off": _ADDED, "delta_w": _ADDED},
)
def containment_failure_known(m: Arithmetic, *, delta_off: Value, delta_w: Value) -> Value:
    r"""Statement: :math:`P(\pi^*\in\Pi_t\ \forall t\ge1)\ge1-\delta_{off}-\delta_w`, for the sets

    .. math:: \Pi_t=\{\pi\in\Pi_{off}:\forall\pi'\in\Pi_{off},\ \langle\phi(\pi)-\phi(\pi'),w_t\rangle
       +\rho_t\|\phi(\pi)-\phi(\pi')\|_{V_t^{-1}}\ge0\}.

    Source: audit R2, which replaces ``lemma:optimal_policy_containment``: no expected data matrix, no factor 4, and any
    weights of the ball with ``confidence_radius_repaired``. Assumptions: as ``beta_repaired``. Arguments: ``delta_off,
    delta_w`` in (0, 1). Returns a probability, vacuous from 1 on. Errors: ``InputError``.

    >>> float(containment_failure_known.estimate(delta_off=0.25, delta_w=0.125))
    0.375
    """
    return total(offline=delta_off, weights=delta_w)


@bound(
    title="probability that the best policy leaves the sets, unknown dynamics",
    symbol=r"P(\exists t:\pi^*\notin\Pi_t)",
    source="audit R2",
    group="online",
    status="repaired",
    trivial=1,
    words="the best policy is missing from some round's set with probability at most {value}",
    assumptions=(*_SETS, *EVENT),
    monotone={"delta_off": _ADDED, "delta_w": _ADDED, "delta_P": _ADDED},
)
def containment_failure_unknown(m: Arithmetic, *, delta_off: Value, delta_w: Value, delta_P: Value) -> Value:
    r"""Statement: with estimated features and :math:`b_t(\pi)+b_t(\pi')` added to the sets of
    ``containment_failure_known``, :math:`P(\pi^*\in\Pi_t\ \forall t\ge1)\ge1-\delta_{off}-\delta_w-\delta_P`.

    Source: audit R2, which replaces the proof of ``lem:online_confidence_set``. Assumptions: as ``beta_repaired`` and
    ``transition_bonus``. Arguments: ``delta_off, delta_w, delta_P`` in (0, 1). Returns a probability, vacuous from 1
    on. Errors: ``InputError``.

    >>> float(containment_failure_unknown.estimate(delta_off=0.25, delta_w=0.125, delta_P=0.125))
    0.5
    """
    return total(offline=delta_off, weights=delta_w, dynamics=delta_P)
