r"""Linear programs over occupancy measures, posed with one sparse constraint matrix and solved through cvxpy.

Both programs maximise :math:`\langle d, r\rangle` over :math:`d \ge 0` subject to a conservation of flow
:math:`M d = b`, and their duals minimise :math:`\langle b, V\rangle` subject to :math:`M^\top V \ge r`
(Puterman, Markov Decision Processes, 1994, section 6.9):

- finite horizon, :math:`d_h(s, a)` of shape (H, S, A): :math:`\sum_a d_1(s, a) = d_0(s)` and
  :math:`\sum_a d_{h+1}(s', a) = \sum_{s, a} P(s'|s, a) d_h(s, a)`;
- discounted, :math:`d(s, a)` of shape (S, A), summing to :math:`1 / (1 - \gamma)`:
  :math:`\sum_a d(s', a) = d_0(s') + \gamma \sum_{s, a} P(s'|s, a) d(s, a)`.

One matrix, because cvxpy compiles a constraint a state thirty times more slowly.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from bridge_algos.expert.dynamic_programming import check_discount
from bridge_algos.mdp import FloatArray, TabularMDP
from bridge_theory.errors import ComputationError, InputError

# First-order methods stop by default at an accuracy that the certificate does not accept.
ACCURACY: dict[str, dict[str, float]] = {
    "SCS": {"eps": 1e-9, "max_iters": 1_000_000},
    "OSQP": {"eps_abs": 1e-9, "eps_rel": 1e-9, "max_iter": 1_000_000},
}


class SolverError(ComputationError):
    """A solver failed, or returned numbers that do not stand up to the certificate; not a mistake of the user's."""


@dataclass(frozen=True, eq=False)
class OccupancyProgram:
    """maximise <reward, d> subject to flow d = inflow, d >= 0.

    Args:
        flow: scipy.sparse matrix, a row for each entry of the dual values and a column for each occupancy.
        inflow: right-hand side b.
        reward: objective, flat like the columns of ``flow``.
        shape: (H, S, A) or (S, A), the occupancies' shape.
    """

    flow: Any
    inflow: FloatArray
    reward: FloatArray
    shape: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class ProgramSolution:
    """What a solver, by its name in cvxpy, returned: occupancies, dual values (H, S) or (S,), the claimed objective."""

    occupancy: FloatArray
    values: FloatArray
    objective: float
    solver: str


def finite_horizon_program(mdp: TabularMDP) -> OccupancyProgram:
    """The program over time-dependent occupancies (H, S, A); its optimum is the best expected return."""
    from scipy import sparse

    leaving, entering = _leaving_and_entering(mdp)
    steps = sparse.eye_array(mdp.horizon)
    successors = sparse.eye_array(mdp.horizon, k=-1)
    return OccupancyProgram(
        flow=sparse.csc_array(sparse.kron(steps, leaving) - sparse.kron(successors, entering)),
        inflow=np.concatenate([mdp.initial, np.zeros((mdp.horizon - 1) * mdp.n_states)]),
        reward=np.tile(mdp.expected_reward.ravel(), mdp.horizon),
        shape=(mdp.horizon, mdp.n_states, mdp.n_actions),
    )


def discounted_program(mdp: TabularMDP, discount: float) -> OccupancyProgram:
    """The program over discounted stationary occupancies (S, A); its optimum is the best discounted return."""
    check_discount(discount)
    leaving, entering = _leaving_and_entering(mdp)
    return OccupancyProgram(
        flow=(leaving - discount * entering).tocsc(),
        inflow=mdp.initial,
        reward=mdp.expected_reward.ravel(),
        shape=(mdp.n_states, mdp.n_actions),
    )


def solve_program(program: OccupancyProgram, solver: str) -> ProgramSolution:
    """Solve an occupancy program with an installed LP solver, by its name in cvxpy.

    Rewards are scaled to a largest magnitude of one, because solvers measure feasibility absolutely.

    Raises:
        InputError: when the solver is not installed.
        SolverError: for any status but ``optimal``; ``optimal_inaccurate`` is a failure too.
    """
    import cvxpy

    name = _installed_name(solver, cvxpy.installed_solvers())
    scale = float(np.abs(program.reward).max()) or 1.0
    occupancy = cvxpy.Variable(program.flow.shape[1], nonneg=True)
    conservation = program.flow @ occupancy == program.inflow
    # Minimised, so that the multipliers of cvxpy's Lagrangian are the values V and not their negatives.
    problem = cvxpy.Problem(cvxpy.Minimize(-(program.reward / scale) @ occupancy), [conservation])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what cvxpy would warn of is in the status
            problem.solve(solver=name, **ACCURACY.get(name, {}))
    except cvxpy.error.SolverError as error:
        raise SolverError(f"the solver {name} failed on the linear program: {error}") from error
    if problem.status != cvxpy.OPTIMAL:
        raise SolverError(
            f"the solver {name} ended with status {problem.status!r}, expected 'optimal'; an MDP always has an optimal "
            "occupancy, so try another solver, such as HIGHS."
        )
    return ProgramSolution(
        occupancy=np.asarray(occupancy.value).reshape(program.shape),
        values=scale * np.asarray(conservation.dual_value).reshape(program.shape[:-1]),
        objective=-scale * float(problem.value),
        solver=name,
    )


def _installed_name(solver: str, installed: list[str]) -> str:
    name = str(solver).upper()
    if name not in installed:
        raise InputError(
            f"the solver {solver!r} is not installed; expected one of {', '.join(sorted(installed))} (default HIGHS)."
        )
    return name


def _leaving_and_entering(mdp: TabularMDP) -> tuple[Any, Any]:
    """(S, SA) sparse matrices that sum occupancies over the actions of a state, and over its predecessors."""
    from scipy import sparse

    pairs = mdp.n_states * mdp.n_actions
    leaving = sparse.kron(sparse.eye_array(mdp.n_states), np.ones((1, mdp.n_actions)))
    return leaving.tocsr(), sparse.csr_array(mdp.transitions.reshape(pairs, mdp.n_states).T)
