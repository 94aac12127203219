"""The run's own numbers, recomputed by its own rule: where the two disagree, the log is not that of an honest run.

The certificate uses none of these claims. They are compared up to ``TOLERANCE``, which the run's double arithmetic
never needs and below which a changed claim changes nothing; a policy within the rounding of squared distances of the
border of Pi_t may be counted either way.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bridge_theory.arithmetic.flint_balls import ball, ends, midpoint
from proofs_checks.verify.ellipsoid import data_matrix, solver_error
from proofs_checks.verify.enclosed import UNIT, Enclosed, FloatArray
from proofs_checks.verify.facts import Facts
from proofs_checks.verify.features import IntArray, coordinates, expectations
from proofs_checks.verify.policies import widest, worst_margins
from proofs_checks.verify.regret import View
from proofs_checks.verify.rules import History, rule_of

TOLERANCE = 1e-6


@dataclass(eq=False)
class Replay:
    """The run's rule, followed round by round; ``faults`` collects what does not fit."""

    facts: Facts
    faults: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.rule = rule_of(self.facts)
        self.history = History()
        self.expected = np.zeros((self.facts.table.dimension,) * 2)
        self.answered: tuple[IntArray, FloatArray] = np.zeros((0, len(self.expected)), dtype=np.int64), np.zeros(0)

    def errors(self, t: int, view: View, gram: IntArray, differences: IntArray, outcomes: FloatArray) -> None:
        """The claimed solver error of the weights that round t uses."""
        error, self.answered = view.error, (differences, outcomes)
        if self.rule.expected:
            own = data_matrix(self.rule.scale, gram)
            facts = self.facts
            error = solver_error(own, differences, outcomes, view.w, ball(facts.lam), ball(facts.slope))
        low, high = ends(error)
        claim = float(self.facts.claims["solver_error"][t - 1])
        if claim < low * (1 - TOLERANCE) - 1e-8:
            self._fault(t, f"the solver error claimed is {claim:.3g}, recomputed at least {low:.3g}")
        elif claim > high * (1 + TOLERANCE) + 1e-8:
            self._fault(t, f"the solver error claimed is {claim:.3g}, recomputed at most {high:.3g}")

    def round(self, t: int, view: View, gram: IntArray, counts: IntArray | None, kernel: FloatArray) -> None:
        """The claims about round t, from its view; then the round joins the history."""
        facts, rule = self.facts, self.rule
        first, second = pair = facts.pairs[t - 1]
        scale = midpoint(rule.scale)
        matrix, scores = scale * np.eye(len(gram)) + (self.expected if rule.expected else gram), view.scores.mid
        gamma = rule.gamma(t, view.rho, self.history)
        if rule.answers is not None:
            around = rule.answers.look(*self.answered)
            matrix, gamma, scores = around.matrix, around.radius, view.features.mid @ around.center
        bonus = self._bonus(view, counts, kernel)
        z = view.features.mid @ np.linalg.inv(np.linalg.cholesky(matrix)).T
        distance = float(np.linalg.norm(z[first] - z[second]))
        self._number(t, "gamma", gamma, 0.0)
        self._number(t, "log_det", float(np.linalg.slogdet(matrix)[1]), 1.0)
        self._number(t, "uncertainty", distance, float(np.abs(z).max()))
        for claim, value in zip(facts.claims["bonus"][t - 1], bonus[pair], strict=True):
            if not abs(claim - value) <= TOLERANCE * (value + 1e-3):
                self._fault(t, f"a bonus of the pair is claimed to be {claim:.6g}, recomputed {value:.6g}")
        if rule.answers is not None:
            rule.answers.settle(view.features.mid, z, bonus)
        self._membership(t, scores, z, gamma, bonus)
        if counts is not None:
            self.history.visits.append(_visits(facts, kernel, pair))
            self.history.counts.append(counts.sum(axis=2))
        played = view.features.mid[first] - view.features.mid[second]
        self.expected = self.expected + np.outer(played, played)

    def _bonus(self, view: View, counts: IntArray | None, kernel: FloatArray) -> FloatArray:
        if counts is None or self.rule.costs is None:
            return view.bonus
        facts = self.facts
        costs = self.rule.costs(counts.sum(axis=2))
        horizon = facts.table.places.shape[0]
        return expectations(kernel, facts.initial, facts.policies, facts.table, costs, horizon)[1]

    def _membership(self, t: int, scores: FloatArray, z: FloatArray, gamma: float, bonus: FloatArray) -> None:
        """The size of Pi_t, that the pair lies in it, and that the rule chooses this pair.

        The rules are the paper's, but that the maximum is over pairs of two policies: a policy with itself compares
        nothing, and is played only where it alone is left. The bounds ask for no more (audit R4).
        """
        pair, rule = self.facts.pairs[t - 1], self.facts.configuration["pair_rule"]
        reach = 2 * float(np.linalg.norm(z - z.mean(axis=0), axis=1).max())
        size = float(np.abs(scores).max() + bonus.max()) + gamma * reach
        allowance = np.sqrt(64 * (z.shape[1] + 4) * UNIT) * size + 1e-12
        if self.rule.answers is None:
            lowest, highest = worst_margins(Enclosed(scores, 0.0), Enclosed(z, 0.0), gamma, bonus)
            inside = lowest >= -1e-9 * size - 1e-12  # rounding may keep a policy, but never rules one out
            perhaps = highest >= -allowance
        else:
            inside, perhaps = self.rule.answers.inside, self.rule.answers.perhaps
        least, most = int(inside.sum()), int(perhaps.sum())
        claim = int(self.facts.claims["set_size"][t - 1])
        if not least <= claim <= most:
            counted = str(least) if least == most else f"{least} to {most}"
            self._fault(t, f"the policies left are claimed to be {claim}, recomputed {counted}")
        for i in pair:
            if not perhaps[i]:
                self._fault(t, f"policy {i} of the stored pair is not inside Pi_t")
        first, second = pair
        if (first == second) != (claim == 1):
            played = "a policy with itself" if first == second else "two policies"
            self._fault(t, f"the stored pair is of {played}, but the policies left are claimed to be {claim}")
        if not inside.any():
            return
        distance = float(np.linalg.norm(z[first] - z[second]))
        if rule == "uncertainty_and_bonus":
            best, value = widest(z[inside], gamma, bonus[inside]), gamma * distance + bonus[first] + bonus[second]
        elif rule == "max_uncertainty":
            best, value = widest(z[inside], 1.0, np.zeros(int(inside.sum()))), distance
            allowance = np.sqrt(64 * (z.shape[1] + 4) * UNIT) * reach + 1e-12
        elif rule == "ucb":
            best = widest(z[inside], gamma, bonus[inside], scores[inside])
            value = scores[first] - scores[second] + gamma * distance + bonus[first] + bonus[second]
        else:
            best, value = float(scores[inside].max()), float(scores[first])
        if value < best - allowance:
            self._fault(t, f"the stored pair is not the one that the rule {rule!r} chooses ({value:.6g} < {best:.6g})")

    def _number(self, t: int, name: str, value: float, size: float) -> None:
        claim = float(self.facts.claims[name][t - 1])
        if not abs(claim - value) <= TOLERANCE * (abs(value) + size):
            words = {"gamma": "multiplier", "log_det": "log determinant"}.get(name, name)
            self._fault(t, f"the {words} claimed is {claim:.9g}, recomputed {value:.9g}")

    def _fault(self, t: int, sentence: str) -> None:
        self.faults.append(f"round {t}: {sentence}")


def _visits(facts: Facts, kernel: FloatArray, pair: IntArray) -> FloatArray:
    """Expected visits of two policies to every pair of state and action over all steps, (2, S, A)."""
    horizon, n_states, n_actions, _ = facts.table.places.shape
    table = coordinates("state_action_counts", n_states, n_actions, horizon)
    visits = expectations(kernel, facts.initial, facts.policies[pair], table)[0].mid
    return visits.reshape(2, n_states, n_actions)
