"""What transition counts alone certify: a budget of KL divergence, and the Hellinger errors that follow from it."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, requires, rises, total
from bridge_theory.offline.assumptions import COUNT_ESTIMATE, DETERMINISTIC, FITTED, INDEPENDENT, STATIONARY

_SURER = falls("log(1/delta) falls")
_WORDS = "the counts times the KL errors of the estimated rows sum to at most {value} nats"
_HELLINGER = "the squared Hellinger distance between the two trajectory laws is at most {value}"


@bound(
    title="KL budget of the transition counts",
    symbol=r"\mathcal{B}",
    source="audit T10",
    group="offline",
    status="sharp",
    spends=("delta",),
    words=_WORDS,
    assumptions=("each row of the kernel is stationary", "each row is estimated by the frequencies of its own counts"),
    monotone={"S": rises("every binomial rises"), "delta": _SURER},
)
def transition_kl_budget(m: Arithmetic, *, S: Value, counts: Value, delta: Value) -> Value:
    r"""Statement: w.p. at least :math:`1-\delta`, at all times at once, :math:`\sum_{s,a}N_{sa}\mathrm{KL}(\hat
    P_{sa}\|P^*_{sa})\le \sum_{s,a}\log\binom{N_{sa}+|S|-1}{|S|-1}+\log(1/\delta)`.

    Source: audit T10 (Laplace mixture and Ville's inequality); counts may be adaptive. Assumptions: stationary rows.
    Arguments: ``S`` positive integer, ``counts`` the transition uses of every cell (zeros allowed), ``delta`` in (0,
    1). Returns nats. Errors: ``InputError`` outside the domain.

    >>> round(float(transition_kl_budget.estimate(S=2, counts=[1, 3, 0], delta=0.5)), 4)
    2.7726
    """
    return total(cells=m.sum(lambda N: m.log_binomial(N + S - 1, S - 1), counts), confidence=-m.log(delta))


@bound(
    title="trajectory KL from the budget",
    symbol=r"\mathrm{KL}(\hat P^\pi \| P_*^\pi)",
    source="audit T10",
    group="offline",
    status="sharp",
    spends=("delta",),
    words="the KL divergence from the estimated to the true trajectory law is at most {value} nats",
    assumptions=(STATIONARY, FITTED, "the policy never uses a pair without data under the estimate"),
    monotone={"S": rises("the budget rises"), "delta": _SURER, "ratio": rises("it multiplies")},
)
def trajectory_kl(m: Arithmetic, *, S: Value, counts: Value, ratio: Value, delta: Value) -> Value:
    r"""Statement: :math:`\mathrm{KL}(\hat P^\pi\|P_*^\pi)\le\mathcal B\max_{s,a}\hat m_{sa}/N_{sa}`, :math:`\hat m`
    the expected visits under :math:`(\hat P,\pi)`.

    Source: audit T10. Assumptions: stationary rows; the policy stays on pairs with data. Arguments: ``S`` positive
    integer, ``counts`` per cell, ``ratio`` the largest :math:`\hat m/N`, ``delta`` in (0, 1). Returns nats. Errors:
    ``InputError`` outside the domain.

    >>> round(float(trajectory_kl.estimate(S=2, counts=[1, 3, 0], ratio=0.5, delta=0.5)), 4)
    1.3863
    """
    return transition_kl_budget(m, S=S, counts=counts, delta=delta) * ratio


@bound(
    title="Hellinger from KL",
    symbol="H^2",
    source="audit T3",
    group="offline",
    status="sharp",
    trivial=1,
    words=_HELLINGER,
    monotone={"kl": rises("the exponential falls")},
)
def hellinger_from_kl(m: Arithmetic, *, kl: Value) -> Value:
    r"""Statement: :math:`H^2(P,Q)\le 1-\exp(-\mathrm{KL}(P\|Q)/2)`.

    Source: audit T3 (Jensen). Assumptions: none. Arguments: ``kl >= 0`` in nats. Returns a squared Hellinger distance,
    below 1. Errors: ``InputError`` outside the domain.

    >>> round(float(hellinger_from_kl.estimate(kl=2)), 4)
    0.6321
    """
    return -m.expm1(-kl / 2)


@bound(
    title="Hellinger from KL with exits",
    symbol="H^2",
    source="audit T3",
    group="offline",
    status="sharp",
    trivial=1,
    words=_HELLINGER,
    assumptions=("exit_mass is the estimated probability of using a pair without data, kl is summed before that",),
    monotone={"kl": rises("the exponential falls")},
)
def hellinger_from_kl_with_exits(m: Arithmetic, *, kl: Value, exit_mass: Value) -> Value:
    r"""Statement: with exit probability :math:`p<1`, :math:`H^2\le
    1-(1-p)\exp\bigl(-(\mathrm{KL}+p\log(1/p))/(2(1-p))\bigr)`.

    Source: audit T3. Assumptions: ``kl`` is the expected sum of row divergences before the exit. Arguments: ``kl >=
    0`` in nats, ``exit_mass`` in [0, 1). Returns a squared Hellinger distance, below 1. Errors: ``InputError``.

    >>> float(hellinger_from_kl_with_exits.estimate(kl=0, exit_mass=0))
    0.0
    """
    stay = 1 - exit_mass
    surprise = m.if_at_most(exit_mass, 0, lambda: m.number(0), lambda: -exit_mass * m.log(exit_mass))
    return 1 - stay * m.exp(-(kl + surprise) / (2 * stay))


@bound(
    title="transition error from counts for each step",
    symbol="R_2",
    source="audit T10",
    group="offline",
    status="sharp",
    trivial=1,
    spends=("delta",),
    words=_HELLINGER,
    assumptions=(DETERMINISTIC, INDEPENDENT, COUNT_ESTIMATE),
    conditions=(requires(lambda n: n >= 1, "at least one demonstration"),),
    monotone={"S": rises("every binomial rises"), "delta": _SURER},
)
def transition_error_counts(m: Arithmetic, *, S: Value, n: Value, counts: Value, delta: Value) -> Value:
    r"""Statement: :math:`H^2(\hat P^{\pi^*},P_*^{\pi^*})\le 1-\exp(-\mathcal B/(2n))`, the cells of :math:`\mathcal
    B` being the (step, state) pairs and the first state.

    Source: audit T10 with T3: under the count estimate the expert's expected visits are the counts over ``n``.
    Assumptions: deterministic expert, one estimated row per step, empirical first state. Arguments: ``S, n`` positive
    integers, ``counts`` the transition uses of each (step, state) cell, ``delta`` in (0, 1). Returns a squared
    Hellinger distance, below 1. Errors: ``InputError`` outside the domain.

    >>> round(float(transition_error_counts.estimate(S=2, n=10, counts=[10], delta=0.5)), 4)
    0.24
    """
    first_state = m.log_binomial(n + S - 1, S - 1)
    budget = transition_kl_budget(m, S=S, counts=counts, delta=delta) + first_state
    return hellinger_from_kl(m, kl=budget / n)


@bound(
    title="KL budget of the action counts",
    symbol=r"\mathcal{B}_\pi",
    source="audit T13",
    group="offline",
    status="sharp",
    spends=("delta",),
    words="the visits times the KL errors of the estimated policy sum to at most {value} nats",
    assumptions=("the expert is Markov", "the policy is estimated by counts for each step and state"),
    monotone={"A": rises("every binomial rises"), "delta": _SURER},
)
def policy_kl_budget(m: Arithmetic, *, A: Value, visits: Value, delta: Value) -> Value:
    r"""Statement: w.p. at least :math:`1-\delta`, :math:`\sum_{h,s}N_h(s)\mathrm{KL}(\hat\pi_h(s)\|\pi^*_h(s))\le
    \sum_{h,s}\log\binom{N_h(s)+|A|-1}{|A|-1}+\log(1/\delta)`.

    Source: audit T13. Assumptions: Markov expert, policy estimated by counts for each step and state. Arguments: ``A``
    positive integer, ``visits`` per (step, state) cell (zeros allowed), ``delta`` in (0, 1). Returns nats. Errors:
    ``InputError`` outside the domain.

    >>> round(float(policy_kl_budget.estimate(A=2, visits=[1, 3, 0], delta=0.5)), 4)
    2.7726
    """
    return total(cells=m.sum(lambda N: m.log_binomial(N + A - 1, A - 1), visits), confidence=-m.log(delta))


@bound(
    title="radius for a stochastic expert",
    symbol=r"\mathrm{Radius}",
    source="audit T13",
    group="offline",
    status="sharp",
    trivial=1,
    spends=("delta",),
    words="the expert lies within Hellinger distance {value} of the cloned policy under the estimated dynamics",
    assumptions=("the expert is Markov", INDEPENDENT, COUNT_ESTIMATE, "so is the policy, for each step"),
    monotone={"A": rises("the budget rises"), "delta": _SURER},
)
def offline_radius_stochastic(m: Arithmetic, *, A: Value, n: Value, visits: Value, delta: Value) -> Value:
    r"""Statement: :math:`H(\hat P^{\pi^*},\hat P^{\hat\pi})\le\sqrt{1-\exp(-\mathcal B_\pi/(2n))}` w.p. at least
    :math:`1-\delta`.

    Source: audit T13; transition error does not enter. Assumptions: Markov expert, per-step count estimates of policy
    and dynamics, empirical first state. Arguments: ``A, n`` positive integers, ``visits`` per (step, state) cell,
    ``delta`` in (0, 1). Returns a Hellinger distance, below 1. Errors: ``InputError`` outside the domain.

    >>> round(float(offline_radius_stochastic.estimate(A=2, n=10, visits=[10, 10], delta=0.5)), 4)
    0.4899
    """
    return m.sqrt(hellinger_from_kl(m, kl=policy_kl_budget(m, A=A, visits=visits, delta=delta) / n))
