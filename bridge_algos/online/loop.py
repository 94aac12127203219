r"""The online loop: one for BRIDGE, BRIDGE with known dynamics, and PbRL, which are settings of it.

A round t asks about the pair that the confidence set Pi_t and the pair rule give, rolls both policies out in the real
environment (algo:main line 8 prints the estimated one, with which the regret can be linear: audit 4.7), and learns from
the answer. What is recorded for round t is the pair's pseudo-regret and, as in the paper's figures, the suboptimality
of the policy that is greedy after the round's answer.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol, get_args

import numpy as np

from bridge_algos.embeddings import Embedding, SampledEmbedding, expected_features, sampled_features
from bridge_algos.evaluation import expected_returns, rounding_allowance
from bridge_algos.given import check_fields, checked
from bridge_algos.mdp import Dynamics, FloatArray, IntArray, TabularMDP
from bridge_algos.offline.transitions import add_transitions, estimate_transitions
from bridge_algos.online.confidence import Confidence, RoundState, pair_visits
from bridge_algos.online.likelihood import LikelihoodFilter
from bridge_algos.online.memory import Memory, Rows
from bridge_algos.online.oracles import Oracle
from bridge_algos.online.pair_rules import PairRule, choose_pair
from bridge_algos.online.policy_filter import first_best, surviving
from bridge_algos.online.preference_model import fit_adam, fit_exact, project, projection_error
from bridge_algos.trajectories import Trajectories, sample_each
from bridge_theory.errors import InputError


class Problem(Protocol):
    """What the loop asks of a world; policies are rows that the problem understands.

    :class:`OnlineProblem` computes in a tabular MDP, :class:`bridge_algos.continuous.problem.SimulatedProblem` plays in
    a simulator. A simulator's trajectories have what embedding and oracle need, and the log's states and actions.
    """

    @property
    def embedding(self) -> Any:
        """phi, with its ``dimension`` and ``of_trajectories``."""

    @property
    def oracle(self) -> Oracle:
        """Who answers."""

    @property
    def optimum(self) -> IntArray:
        """The policy that regret is measured against in the theory."""

    @property
    def expert_return(self) -> float:
        """The yardstick of the paper's figures."""

    @property
    def w_star(self) -> FloatArray | None:
        """(d,) true weights, if they exist."""

    def standing(self, policies: IntArray) -> tuple[FloatArray, float, bool]:
        """Returns of the policies, that of the optimum, and whether a policy among them is as good."""

    def look(
        self, learner: Learner, counts: IntArray | None, policies: IntArray, rng: np.random.Generator
    ) -> tuple[Dynamics | None, FloatArray, FloatArray]:
        """The dynamics in use, the policies' features (N, d) and their bonuses (N,)."""

    def sample_pair(self, pair: IntArray, n: int, rng: np.random.Generator) -> tuple[Any, Any]:
        """n independent trajectories of each of two policies in the real world."""


@dataclass(frozen=True, eq=False)
class OnlineProblem:
    """The problem of a tabular MDP, with its yardsticks: everything but the trajectories compared is computed.

    Args:
        mdp: the real environment.
        embedding: phi.
        oracle: who answers.
        optimum: (S,) the policy that regret is measured against in the theory, argmax of the expected return.
        expert_return: the expert's expected return, the yardstick of the paper's figures.
        w_star: (d,) true weights, or None where the preferences are not linear in phi.
    """

    mdp: TabularMDP
    embedding: Embedding | SampledEmbedding
    oracle: Oracle
    optimum: IntArray
    expert_return: float
    w_star: FloatArray | None = None

    def standing(self, policies: IntArray) -> tuple[FloatArray, float, bool]:
        """See :class:`Problem`; exact."""
        returns = expected_returns(self.mdp, policies)
        best = float(expected_returns(self.mdp, self.optimum[None])[0])
        return returns, best, bool(returns.max() >= best - rounding_allowance(self.mdp))

    def look(
        self, learner: Learner, counts: IntArray | None, policies: IntArray, rng: np.random.Generator
    ) -> tuple[Dynamics, FloatArray, FloatArray]:
        """See :class:`Problem`; under the estimate from ``counts``, or the real dynamics where there are none."""
        dynamics, costs = self.mdp.dynamics, None
        if counts is not None:
            dynamics = dynamics.under(learner.estimate(counts))
            costs = learner.confidence.step_bonus(counts.sum(axis=2))
        steps = learner.confidence.bonus_steps
        if learner.rollouts is not None:
            sample = sampled_features(dynamics, policies, self.embedding, learner.rollouts, rng, costs, steps)
            return dynamics, sample.means, sample.costs
        if isinstance(self.embedding, Embedding):
            return dynamics, *expected_features(dynamics, policies, self.embedding, costs, steps)
        raise InputError(
            f"the embedding {self.embedding.name!r} is a function of whole trajectories, whose expectation can only "
            "be sampled; give the learner a number of rollouts."
        )

    def sample_pair(self, pair: IntArray, n: int, rng: np.random.Generator) -> tuple[Trajectories, Trajectories]:
        """See :class:`Problem`."""
        both = sample_each(self.mdp, pair, n, rng)
        return both[:n], both[n:]


FITS = ("exact", "adam", "continual")


@dataclass(frozen=True, eq=False)
class Learner:
    """One algorithm as a setting of the loop.

    Args:
        name: bridge, bridge-known or pbrl.
        policies: (N, S) candidate policies, all different: the offline set, or PbRL's search space.
        counts: (S, A, S) transition counts to start from; None where the dynamics are known.
        confidence: multiplier gamma_t, bonuses and data matrix; see :mod:`bridge_algos.online.confidence`.
        pair_rule: how the pair is chosen.
        weight_bound: W, the radius of the ball on which w is projected.
        slope: c of the fitted model sigma(c <x, w>).
        lam: lambda of the regularised likelihood.
        comparisons: K, how many pairs of trajectories are compared in a round.
        fit: ``"exact"`` optimum; the published tabular runs' ten ``"adam"`` steps from a normalised vector of ones; or
            the published continuous runs' ``"continual"`` hundred steps from the weights of the round before, first
            from a vector of ones of norm W, and not projected on the ball.
        rollouts: None for exact features, or the number of rollouts a policy.
        estimate: from pooled transition counts (S, A, S) to a kernel (S, A, S).
        until_decided: ask nothing once Pi_t holds one policy, as in the published continuous runs.
    """

    name: str
    policies: IntArray
    counts: IntArray | None
    confidence: Confidence
    pair_rule: PairRule
    weight_bound: float
    slope: float = 1.0
    lam: float = 1.0
    comparisons: int = 1
    fit: str = "exact"
    rollouts: int | None = None
    estimate: Callable[[IntArray], FloatArray] = estimate_transitions
    until_decided: bool = False

    def __post_init__(self) -> None:
        check_fields(self)
        if self.pair_rule not in get_args(PairRule):
            raise InputError(f"pair_rule is {self.pair_rule!r}, expected one of {', '.join(get_args(PairRule))}.")
        if self.fit not in FITS:
            raise InputError(f"fit is {self.fit!r}, expected one of {', '.join(FITS)}.")
        if self.policies.ndim != 2 or not len(self.policies):
            raise InputError(f"policies has shape {self.policies.shape}, expected (N, S) with at least one policy.")
        distinct = len(np.unique(self.policies, axis=0))
        if distinct < len(self.policies):  # else a policy could be compared with itself
            raise InputError(
                f"policies holds {len(self.policies)} rows but {distinct} different policies, expected each once; pass "
                "numpy.unique(policies, axis=0)."
            )


@dataclass(frozen=True, eq=False)
class _View:
    """What the learner makes of its memory at the start of a round; ``error`` is NaN where nobody asked for it."""

    dynamics: Dynamics | None
    features: FloatArray
    bonus: FloatArray
    w: FloatArray
    error: float


RECORDED = (
    "first",
    "second",
    "greedy",
    "pseudo_regret",
    "suboptimality",
    "set_size",
    "optimum_kept",
    "optimum_ruled_out",
    "weight_error",
    "uncertainty",
    "bonus_sum",
    "gamma",
    "log_det",
    "seconds",
)
"""Names of the per-round records, in this order in every result."""


@checked
def run_online(
    problem: Problem,
    learner: Learner,
    rounds: int,
    rng: np.random.Generator,
    log: Callable[[dict[str, Any]], None] | None = None,
) -> dict[str, FloatArray]:
    """Play ``rounds`` rounds and return one array (rounds,) per name in ``RECORDED``.

    Regrets are the problem's (exact in a tabular MDP) and never clipped; ``pseudo_regret`` is that of the round's pair
    against ``problem.optimum``, ``suboptimality`` that of the greedy policy after the round against the expert.
    ``first``, ``second`` and ``greedy`` index ``learner.policies``. ``optimum_kept``: an optimal policy is among those
    searched, and the optimum is not ruled out. ``optimum_ruled_out``: some policy searched beats the optimum beyond the
    confidence width, so that it would not be in Pi_t even if it were searched.

    ``log`` receives what a checker needs to recompute a round, as a plain record: ``pair`` (2,) indices, ``w`` (d,)
    that the round used and ``w_next`` (d,) fitted after it, ``states`` and ``actions`` (2, K, H) of the trajectories
    compared, ``outcomes`` (K,), ``kept`` (N,), and the numbers ``gamma``, ``solver_error`` (of w),
    ``solver_error_next`` (of w_next), ``log_det``, ``uncertainty``, and ``bonus`` (2,) of the pair.
    """
    returns, best, searched = problem.standing(learner.policies)
    policies = np.concatenate([learner.policies, problem.optimum[None]])
    memory = _start(problem, learner)
    with_error = learner.confidence.needs_error or log is not None
    view = _look(problem, learner, memory, policies, None, rng, with_error)
    answers = None if learner.confidence.answers is None else learner.confidence.answers()
    challenging = np.arange(len(policies)) < len(learner.policies)
    record = {name: np.full(rounds, np.nan) for name in RECORDED}
    for t in range(1, rounds + 1):
        clock = time.perf_counter()
        state, center = _state(t, memory, view, answers)
        gamma = learner.confidence.multiplier(state)
        z = view.features @ state.inverse_root.T
        scores = view.features @ center
        if answers is None:
            upper, lower = scores + view.bonus, scores - view.bonus
            keeps = surviving(upper, lower[:-1], z, gamma, z[:-1])
        else:
            keeps = answers.survivors(view.features, view.bonus, challenging)
        kept, optimum_kept = keeps[:-1], bool(keeps[-1])
        bonus = learner.confidence.pair_bonus * view.bonus[:-1]
        first, second = choose_pair(learner.pair_rule, kept, scores[:-1], z[:-1], gamma, bonus, rng)
        norm, bonuses = float(np.linalg.norm(z[first] - z[second])), view.bonus[first] + view.bonus[second]
        log_det = state.log_det
        before = view
        asking = not (learner.until_decided and kept.sum() == 1)
        if asking:
            one, two, outcomes = _play(problem, learner, memory, view, (first, second), rng)
            view = _look(problem, learner, memory, policies, view, rng, with_error)
        greedy = first_best(view.features[:-1] @ view.w)
        values = {
            "first": first,
            "second": second,
            "greedy": greedy,
            "pseudo_regret": best - (returns[first] + returns[second]) / 2,
            "suboptimality": problem.expert_return - returns[greedy],
            "set_size": kept.sum(),
            "optimum_kept": searched and optimum_kept,
            "optimum_ruled_out": not optimum_kept,
            "weight_error": np.nan if problem.w_star is None else np.linalg.norm(view.w - problem.w_star),
            "uncertainty": norm,
            "bonus_sum": bonuses,
            "gamma": gamma,
            "log_det": log_det,
            "seconds": time.perf_counter() - clock,
        }
        for name, value in values.items():
            record[name][t - 1] = value
        if log is not None and asking:
            log(
                {
                    "pair": (first, second),
                    "w": before.w,
                    "w_next": view.w,
                    "states": np.stack([one.states, two.states]),
                    "actions": np.stack([one.actions, two.actions]),
                    "outcomes": outcomes,
                    "kept": kept,
                    "gamma": gamma,
                    "solver_error": before.error,
                    "solver_error_next": view.error,
                    "log_det": log_det,
                    "uncertainty": norm,
                    "bonus": before.bonus[[first, second]],
                }
            )
    return record


def _state(t: int, memory: Memory, view: _View, answers: LikelihoodFilter | None) -> tuple[RoundState, FloatArray]:
    """The state of round t, and the middle of its confidence set."""
    past = view.error, memory.played_visits, memory.counts_then
    if answers is None:
        return RoundState(t, memory.matrix, *past), view.w
    ellipsoid = answers.look(memory.x.values, memory.outcomes.values)
    return RoundState(t, ellipsoid.matrix, *past, ellipsoid), ellipsoid.center


def _start(problem: Problem, learner: Learner) -> Memory:
    d = problem.embedding.dimension
    matrix = learner.confidence.initial_scale * np.eye(d)
    counts = None if learner.counts is None else learner.counts.copy()
    return Memory(Rows(d), Rows(), counts, matrix, matrix)


def _look(
    problem: Problem,
    learner: Learner,
    memory: Memory,
    policies: IntArray,
    previous: _View | None,
    rng: np.random.Generator,
    with_error: bool,
) -> _View:
    """Dynamics, features, bonuses and weights as the data so far have them."""
    w, x = _fit(learner, memory, previous), memory.x.values
    error = np.nan
    if with_error:
        outcomes = memory.outcomes.values
        error = projection_error(w, x, outcomes, learner.lam, memory.observed) if len(x) else 0.0
    if previous is not None and learner.rollouts is None and memory.counts is None:
        return replace(previous, w=w, error=error)
    dynamics, features, bonus = problem.look(learner, memory.counts, policies, rng)
    return _View(dynamics, features, np.minimum(bonus, learner.confidence.bonus_cap), w, error)


def _fit(learner: Learner, memory: Memory, previous: _View | None) -> FloatArray:
    x, outcomes, d = memory.x.values, memory.outcomes.values, len(memory.matrix)
    continual = learner.fit == "continual"
    if previous is None or not len(x):
        return np.full(d, learner.weight_bound / d**0.5 if continual else 0.0)
    if continual:
        return fit_adam(x, outcomes, learner.lam, previous.w, steps=100)
    if learner.fit == "adam":
        estimate = fit_adam(x, outcomes, learner.lam, np.full(d, d**-0.5))
    else:
        estimate = fit_exact(x, outcomes, learner.lam, previous.w)
    return project(estimate, x, learner.lam, memory.observed, learner.weight_bound)


def _play(
    problem: Problem,
    learner: Learner,
    memory: Memory,
    view: _View,
    pair: tuple[int, int],
    rng: np.random.Generator,
) -> tuple[Any, Any, FloatArray]:
    """Roll the pair out in the real environment, ask, and remember; returns trajectories and answers."""
    k, played = learner.comparisons, learner.policies[list(pair)]
    one, two = problem.sample_pair(played, k, rng)
    outcomes = np.asarray(problem.oracle(one, two, rng), dtype=np.float64)
    answered = ~np.isnan(outcomes)
    if outcomes.shape != (k,) or not (~answered | ((outcomes >= 0) & (outcomes <= 1))).all():
        raise InputError(
            f"the oracle answered {np.array2string(outcomes, threshold=4)}, expected {k} numbers in [0, 1] or NaN."
        )
    difference = (problem.embedding.of_trajectories(one) - problem.embedding.of_trajectories(two))[answered]
    memory.x.append(learner.slope * difference)
    memory.outcomes.append(outcomes[answered])
    memory.observed = memory.observed + difference.T @ difference
    if learner.confidence.matrix == "observed":
        memory.matrix = memory.observed
    else:
        expected = view.features[pair[0]] - view.features[pair[1]]
        memory.matrix = memory.matrix + expected[:, None] * expected
    if memory.counts is not None:
        if learner.confidence.needs_history and view.dynamics is not None:
            memory.counts_then.append(memory.counts.sum(axis=2))
            memory.played_visits.append(pair_visits(view.dynamics, played))
        for trajectories in (one, two):
            add_transitions(memory.counts, trajectories)
    return one, two, outcomes
