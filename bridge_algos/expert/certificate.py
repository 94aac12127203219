r"""What an LP solver's numbers are worth, recomputed from the numbers themselves.

Nothing here trusts the solver. Its answer is measured (feasibility, complementarity) and then repaired into a feasible
pair, whose objectives enclose the optimum by weak duality:

- primal: the policy read off the occupancies, whose exact value is that of a feasible occupancy measure;
- dual: the value vector, raised where it violates :math:`V \ge r + P V`. For the finite horizon,
  :math:`V'_h(s) = \max(V_h(s), \max_a [r(s, a) + \sum_{s'} P(s'|s, a) V'_{h+1}(s')])` from the last step back; for a
  discount, :math:`V + e / (1 - \gamma)` with the largest violation :math:`e`. Both are feasible, and what the repair
  costs is part of the gap.

The rounding errors of these computations are bounded and part of the gap, too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.evaluation import expected_next_value, expected_return, rounding_allowance
from bridge_algos.expert.dynamic_programming import discounted_values
from bridge_algos.expert.linear_program import OccupancyProgram, ProgramSolution, SolverError
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP

ACCEPTED = 1e-6
"""Largest accepted residual and gap, relative to max|r| and to the number of (discounted) steps."""


@dataclass(frozen=True)
class Certificate:
    """An enclosure [lower, upper] of a linear program's optimum, and the residuals of the solver's answer.

    Args:
        primal_infeasibility: largest violation of the flow equations or of d >= 0, as a probability.
        dual_infeasibility: largest violation of V >= r + P V, in units of reward.
        complementarity: sum of |d(s, a) (V(s) - r(s, a) - (P V)(s, a))|, in units of reward.
        primal_objective: <d, r> of the returned occupancies.
        lower: exact value of the policy read off the occupancies, less the rounding allowance.
        upper: value of the repaired dual, plus the rounding allowance.
        dynamic_programming: the optimum by backward induction or policy iteration; it lies in [lower, upper].
    """

    primal_infeasibility: float
    dual_infeasibility: float
    complementarity: float
    primal_objective: float
    lower: float
    upper: float
    dynamic_programming: float

    @property
    def gap(self) -> float:
        """How far the policy can be from optimal: upper - lower, at least twice the rounding allowance."""
        return self.upper - self.lower


def certify_finite_horizon(
    mdp: TabularMDP, program: OccupancyProgram, solution: ProgramSolution, policy: IntArray, optimum: float
) -> Certificate:
    """The certificate of a finite-horizon solution with the policy (H, S) read off it; SolverError if it fails."""
    largest = float(np.abs(mdp.reward).max())
    values = np.zeros(mdp.n_states)
    for h in reversed(range(mdp.horizon)):
        backup = (mdp.expected_reward + expected_next_value(mdp, values)).max(axis=-1)
        # Any values become feasible when they are raised to the backup. The cap keeps those of states that no
        # trajectory visits, which are arbitrary in a dual, from swamping the rounding allowance.
        values = np.maximum(backup, np.minimum(solution.values[h], (mdp.horizon - h) * largest))
    # Twice: once for these recursions, once for that of the optimum they are compared with.
    allowance = 2 * rounding_allowance(mdp)
    lower, upper = expected_return(mdp, policy) - allowance, float(mdp.initial @ values) + allowance
    return _certify(program, solution, lower, upper, optimum, steps=mdp.horizon)


def certify_discounted(
    mdp: TabularMDP,
    program: OccupancyProgram,
    solution: ProgramSolution,
    policy: IntArray,
    optimum: float,
    discount: float,
) -> Certificate:
    """The certificate of a discounted solution with the policy (S,) read off it; SolverError if it fails."""
    contraction = 1 - discount * float(mdp.transitions.sum(axis=-1).max())
    largest = float(np.abs(mdp.reward).max())
    states = np.arange(mdp.n_states)

    def residual(values: FloatArray) -> FloatArray:
        return mdp.expected_reward + discount * expected_next_value(mdp, values) - values[:, None]

    def rounding(values: FloatArray) -> float:
        return 2.0**-52 * (2 * mdp.n_states + 6) * (largest + 2 * float(np.abs(values).max()))

    own = discounted_values(mdp, policy, discount)
    own_error = (float(np.abs(residual(own)[states, policy]).max()) + 2 * rounding(own)) / contraction
    dual = np.minimum(solution.values, largest / contraction)
    dual_error = (max(0.0, float(residual(dual).max())) + 2 * rounding(dual)) / contraction
    lower, upper = float(mdp.initial @ own) - own_error, float(mdp.initial @ dual) + dual_error
    return _certify(program, solution, lower, upper, optimum, steps=1 / (1 - discount))


def _certify(
    program: OccupancyProgram, solution: ProgramSolution, lower: float, upper: float, optimum: float, steps: float
) -> Certificate:
    occupancy, values = solution.occupancy.ravel(), solution.values.ravel()
    if not (np.isfinite(occupancy).all() and np.isfinite(values).all()):
        raise SolverError("the solver returned numbers that are not finite; try another solver, such as HIGHS.")
    slack = program.flow.T @ values - program.reward
    certificate = Certificate(
        primal_infeasibility=float(max(0.0, np.abs(program.flow @ occupancy - program.inflow).max(), -occupancy.min())),
        dual_infeasibility=float(max(0.0, -slack.min())),
        complementarity=float(np.abs(occupancy * slack).sum()),
        primal_objective=float(program.reward @ occupancy),
        lower=lower,
        upper=upper,
        dynamic_programming=optimum,
    )
    reward = float(np.abs(program.reward).max()) or 1.0
    measured = {
        "primal infeasibility": (certificate.primal_infeasibility, ACCEPTED * steps),
        "dual infeasibility": (certificate.dual_infeasibility, ACCEPTED * reward),
        "complementarity": (certificate.complementarity, ACCEPTED * reward * steps),
        "error of the claimed objective": (
            abs(solution.objective - certificate.primal_objective),
            ACCEPTED * reward * steps,
        ),
        "primal-dual gap": (certificate.gap, ACCEPTED * reward * steps),
        "distance of dynamic programming from the enclosure": (max(lower - optimum, optimum - upper), 0.0),
    }
    faults = [f"{name} {value:.3g} > {limit:.3g}" for name, (value, limit) in measured.items() if value > limit]
    if faults:
        raise SolverError(
            f"the solver's answer to the linear program does not stand up to its certificate ({'; '.join(faults)}); "
            "try another solver, such as HIGHS."
        )
    return certificate
