"""Experts: optimal policies by several criteria, each measured by the one score that all policies are compared by.

That score is the expected return of the finite horizon, and its maximiser is sought among the stationary deterministic
policies, the paper's policy class. An expert that solves another problem (the published runs solved a discounted one)
need not be the maximiser; it says so, with the gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.evaluation import expected_return, rounding_allowance
from bridge_algos.expert.certificate import Certificate, certify_discounted, certify_finite_horizon
from bridge_algos.expert.dynamic_programming import backward_induction, discounted_values, policy_iteration
from bridge_algos.expert.linear_program import discounted_program, finite_horizon_program, solve_program
from bridge_algos.expert.stationary import best_stationary
from bridge_algos.expert.stationary_optimum import StationaryOptimum
from bridge_algos.given import checked
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_theory.errors import InputError

KINDS = ("discounted-lp", "finite-horizon-lp", "best-stationary")

EMPTY = 1e-6
"""A state with less occupancy than this may owe it to the solver's tolerance."""


@dataclass(frozen=True, eq=False)
class Expert:
    """A policy that is optimal by some criterion, with the evidence, and its place by the evaluation score.

    Args:
        kind: one of KINDS.
        policy: integers, (S,) stationary or (H, S) time-dependent.
        objective: exact value of the policy by its own criterion (the discounted or the finite-horizon return).
        discount: that of the criterion, None for a finite-horizon one.
        solver: the LP solver, or the method that found the policy.
        status: ``"optimal"``; for ``"best-stationary"`` also ``"node limit"``, when optimality was not certified.
        certificate: enclosure and residuals of the linear program; None for ``"best-stationary"``, whose evidence is in
            ``best_stationary``.
        expected_return: exact finite-horizon expected return of the policy, the evaluation score.
        best_stationary: the maximiser of the score among stationary deterministic policies, with its certificate.
        best_time_dependent: the largest score of any policy, by backward induction.
        tolerance: differences of scores up to this are rounding errors.
    """

    kind: str
    policy: IntArray
    objective: float
    discount: float | None
    solver: str
    status: str
    certificate: Certificate | None
    expected_return: float
    best_stationary: StationaryOptimum
    best_time_dependent: float
    tolerance: float

    @property
    def gap_to_stationary(self) -> float:
        """Score of the best stationary policy found less the expert's; negative for a better time-dependent expert."""
        return self.best_stationary.value - self.expected_return

    @property
    def gap_to_time_dependent(self) -> float:
        """Largest score of any policy less the expert's, at least zero up to rounding errors."""
        return self.best_time_dependent - self.expected_return

    @property
    def is_maximiser(self) -> bool:
        """Whether it is certified that no stationary deterministic policy has a larger score."""
        return self.best_stationary.upper - self.expected_return <= self.tolerance

    def describe(self) -> str:
        """What the expert is worth, in words."""
        criterion = "" if self.discount is None else f" with discount {self.discount:g}"
        form = "stationary" if self.policy.ndim == 1 else "time-dependent"
        within = "" if self.certificate is None else f" within {self.certificate.gap:.1e}"
        found = (
            f"The {self.kind} expert{criterion} ({form}, by {self.solver}, {self.status}{within}) returns "
            f"{self.expected_return:.6g}"
        )
        if self.is_maximiser:
            verdict = "no stationary deterministic policy returns more"
        elif self.gap_to_stationary > self.tolerance:
            verdict = f"it is not the maximiser of the evaluation score, the gap is {self.gap_to_stationary:.3g}"
        else:
            verdict = "whether it is the maximiser of the evaluation score was not certified"
        return (
            f"{found}; {verdict}: {self.best_stationary.describe()}. "
            f"The best time-dependent policy returns {self.best_time_dependent:.6g}."
        )


@checked
def make_expert(mdp: TabularMDP, kind: str, discount: float = 0.99, solver: str = "HIGHS") -> Expert:
    """An optimal policy by one of three criteria, certified.

    Args:
        kind: ``"discounted-lp"``, the best discounted return (the published runs' expert, discount 0.99);
            ``"finite-horizon-lp"``, the best return of H steps, time-dependent; ``"best-stationary"``, the best return
            of H steps among stationary deterministic policies.
        discount: in [0, 1), for ``"discounted-lp"`` only.
        solver: an installed LP solver by its cvxpy name, for the two linear programs only.

    The policy of a linear program takes in each state the action of the largest occupancy, the lowest index where
    several are equal; where several actions are optimal, the solver's vertex decides. A state without occupancy, which
    the expert does not visit, takes the action of backward induction or policy iteration.

    Raises:
        InputError: for an unknown kind, a discount out of range or a solver that is not installed.
        SolverError: when the solver fails or its answer does not stand up to the certificate.

    >>> kernel = [[[1, 0], [0, 1]], [[0, 1], [0, 1]]]
    >>> mdp = TabularMDP(kernel, [1, 0], horizon=3, reward=[0, 1], axes="state-action", reward_on="arrival")
    >>> print(make_expert(mdp, "best-stationary").describe())
    The best-stationary expert (stationary, by enumeration, optimal) returns 3; no stationary deterministic policy
    returns more: the best stationary deterministic policy returns 3, optimal up to ... by enumeration. The best
    time-dependent policy returns 3.
    """
    if kind not in KINDS:
        raise InputError(f"the expert kind is {kind!r}, expected one of {', '.join(KINDS)}.")
    stationary = best_stationary(mdp)
    induced, values = backward_induction(mdp)
    optimum = float(mdp.initial @ values[0])
    certificate = None
    if kind == "best-stationary":
        policy, objective, solver = stationary.policy, stationary.value, stationary.method
    elif kind == "finite-horizon-lp":
        program = finite_horizon_program(mdp)
        solution = solve_program(program, solver)
        solver, policy = solution.solver, _policy_of(solution.occupancy, induced)
        certificate = certify_finite_horizon(mdp, program, solution, policy, optimum)
        objective = expected_return(mdp, policy)
    else:
        program = discounted_program(mdp, discount)
        solution = solve_program(program, solver)
        iterated, discounted = policy_iteration(mdp, discount)
        solver, policy = solution.solver, _policy_of(solution.occupancy, iterated)
        certificate = certify_discounted(mdp, program, solution, policy, float(mdp.initial @ discounted), discount)
        objective = float(mdp.initial @ discounted_values(mdp, policy, discount))
    return Expert(
        kind=kind,
        policy=policy,
        objective=objective,
        discount=discount if kind == "discounted-lp" else None,
        solver=solver,
        status="optimal" if certificate or stationary.optimal else "node limit",
        certificate=certificate,
        expected_return=expected_return(mdp, policy),
        best_stationary=stationary,
        best_time_dependent=optimum,
        tolerance=stationary.tolerance + 2 * rounding_allowance(mdp),
    )


def _policy_of(occupancy: FloatArray, unvisited: IntArray) -> IntArray:
    return np.where(occupancy.sum(axis=-1) > EMPTY, occupancy.argmax(axis=-1), unvisited)
