"""The radius that data alone give for a deterministic expert: zero, or the mass that leaves the data."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, rises
from bridge_theory.offline.assumptions import CLONE, DETERMINISTIC

_WORDS = "the expert lies within Hellinger distance {value} of the cloned policy under the estimated dynamics"


@bound(
    title="radius under a closed estimate of the dynamics",
    symbol=r"\mathrm{Radius}",
    source="audit T8(A)",
    group="offline",
    status="sharp",
    trivial=1,
    words=_WORDS,
    assumptions=(
        DETERMINISTIC,
        CLONE,
        "the estimated dynamics never leave the states in which an action was recorded (count estimate, self-loops)",
    ),
)
def offline_radius_closed(m: Arithmetic) -> Value:
    r"""Statement: :math:`H(\hat P^{\pi^*},\hat P^{BC})=0` surely, if :math:`\hat P` never leaves the states with a
    recorded action.

    Source: audit T8(A): the ball of radius 0 is the set of policies that agree with every demonstration. Assumptions:
    deterministic expert, likelihood-maximising cloned policy, closed estimate (counts of the transitions inside the
    trajectories, empirical first state, self-loops where there is no data). Arguments: none. Returns 0. Errors: none.

    >>> float(offline_radius_closed.estimate())
    0.0
    """
    return m.number(0)


@bound(
    title="radius from the mass that leaves the data",
    symbol=r"\mathrm{Radius}",
    source="audit T8(B)",
    group="offline",
    status="sharp",
    trivial=1,
    words=_WORDS,
    assumptions=(DETERMINISTIC, CLONE, "mass is computed under the same estimated dynamics"),
    monotone={"mass": rises("it is under a root")},
)
def offline_radius_mass(m: Arithmetic, *, mass: Value) -> Value:
    r"""Statement: :math:`H(\hat P^{\pi^*},\hat P^{BC})\le\rho`, :math:`\rho^2=\hat P^{BC}(\text{meet a state without
    recorded action})`, surely.

    Source: audit T8(B); ``rho^2`` comes from dynamic programming under the estimate. For a cloned policy that does not
    do what was recorded, the states where it does not are met as well. Assumptions: deterministic expert,
    likelihood-maximising cloned policy, any estimated dynamics. Arguments: ``mass`` = ``rho^2`` in [0, 1]. Returns a
    Hellinger distance in [0, 1]. Errors: ``InputError`` outside the domain.

    >>> float(offline_radius_mass.estimate(mass=0.25))
    0.5
    """
    return m.sqrt(mass)
