"""From round to round: what the trajectories, answers and weights of a log certify, and the run's claims beside it."""

from __future__ import annotations

import numpy as np

from bridge_theory.arithmetic.flint_balls import ball, ends
from bridge_theory.errors import ComputationError
from proofs_checks.verify.claims import Replay
from proofs_checks.verify.conditions import likelihood_withheld, theory_withheld
from proofs_checks.verify.ellipsoid import certified_scale, data_matrix, radius, solver_error
from proofs_checks.verify.enclosed import Enclosed, FloatArray, cumulative, enlarged, largest_norms, raised
from proofs_checks.verify.evidence import Answers
from proofs_checks.verify.facts import Facts, add_transitions
from proofs_checks.verify.features import IntArray, estimated_kernel, expectations, feature_bound, row_radii
from proofs_checks.verify.likelihood import checked_rounds, likelihood_bound
from proofs_checks.verify.regret import View, best_bounds, diameter, excess, hindsight, round_bounds


class Walk:
    """The rounds of a log in order, with what they add up to."""

    def __init__(self, given: Facts) -> None:
        self.facts = given
        self.bound, self.weight_bound = feature_bound(given.table), ball(given.weight_bound)
        self.lam, self.delta = ball(given.lam), ball(given.delta)
        self.scale = certified_scale(self.bound, self.weight_bound, self.lam)
        self.highest_weight = ends(self.weight_bound)[1]
        self.counts = None if given.known else given.offline.copy()
        self.replay = Replay(given)
        rounds, d = given.rounds, given.table.dimension
        self.differences, self.outcomes = np.empty((0, d), dtype=np.int64), np.empty(0)
        self.radius, self.errors = np.full(rounds + 1, np.inf), np.full(rounds + 1, np.inf)
        self.set_size, self.hindsight = np.full(rounds, np.nan), np.full(rounds, np.inf)
        self.likelihood = np.full(rounds, np.inf)
        self.checked = set() if likelihood_withheld(given) else checked_rounds(rounds)
        self.steps = {name: np.full(rounds, np.inf) for name in ("trivial", "ucb", "width")}

    def run(self) -> None:
        """Every round, and the view after the last."""
        given, plays = self.facts, np.zeros(len(self.facts.policies), dtype=np.int64)
        ever = np.ones(len(given.policies), dtype=bool)
        learns = not theory_withheld(given)
        kernel, features, bonus = self._model()
        self.steps["trivial"][:] = self._trivial(features)
        for t in range(1, given.rounds + 2):
            gram = self.differences.T @ self.differences
            view = self._view(t, features, bonus, gram)
            self.replay.errors(t, view, gram, self.differences, self.outcomes)
            if learns:
                possible = view.possible()
                ever &= possible
                if not ever.any():
                    raise ComputationError(
                        f"round {t}: no policy is in every set so far, so that the certificate's events have failed"
                    )
                if t > 1:
                    self.hindsight[t - 2] = hindsight(view, ever, plays, self.highest_weight)
            if t - 1 in self.checked:
                self.likelihood[t - 2] = self._likelihood(t, features, plays)
            if t > given.rounds:
                return
            self.replay.round(t, view, gram, self.counts, kernel)
            pair = (int(given.pairs[t - 1, 0]), int(given.pairs[t - 1, 1]))
            if learns:
                self.set_size[t - 1] = possible.sum()
                bounds = round_bounds(view, possible, pair, self.highest_weight)
                self.steps["ucb"][t - 1], self.steps["width"][t - 1] = bounds
            np.add.at(plays, list(pair), 1)
            self._learn(t)
            if self.counts is not None:
                kernel, features, bonus = self._model()

    def bounds(self) -> dict[str, FloatArray]:
        """Cumulative bounds by name."""
        sums = {name: cumulative(values) for name, values in self.steps.items()}
        best = best_bounds(self.steps, self.hindsight)
        # no round has negative regret, so that a bound on later rounds is one on fewer
        likelihood = np.minimum.accumulate(self.likelihood[::-1])[::-1]
        return sums | {"hindsight": self.hindsight, "best": best, "likelihood": likelihood}

    def _likelihood(self, t: int, features: Enclosed, plays: IntArray) -> float:
        """The bound of companion G6 from the answers before round t."""
        given = self.facts
        answers = Answers.counted(self.differences, self.outcomes)
        try:
            return likelihood_bound(answers, excess(features, plays, t - 1), given.weight_bound, given.delta)
        except ComputationError as error:
            raise ComputationError(f"round {t}: {error}") from None

    def _model(self) -> tuple[FloatArray, Enclosed, FloatArray]:
        """Kernel, features and bonuses as the data so far have them."""
        given = self.facts
        if self.counts is None:
            features, _ = expectations(given.kernel, given.initial, given.policies, given.table)
            return given.kernel, features, np.zeros(len(given.policies))
        kernel = estimated_kernel(self.counts, given.configuration["empty_row"])
        costs = row_radii(self.counts, self.delta)
        horizon = given.table.places.shape[0]
        features, spent = expectations(kernel, given.initial, given.policies, given.table, costs, horizon - 1)
        reach = ends(self.bound * self.weight_bound)[1]
        return kernel, features, raised(reach * np.minimum(2.0, spent))

    def _view(self, t: int, features: Enclosed, bonus: FloatArray, gram: IntArray) -> View:
        given = self.facts
        matrix = data_matrix(self.scale, gram)
        w = _inside(given.w[t - 1], float(given.weight_bound))
        error = solver_error(matrix, self.differences, self.outcomes, w, self.lam, ball(given.slope))
        rho = radius(matrix, error, self.bound, self.weight_bound, self.lam, self.delta)
        self.radius[t - 1], self.errors[t - 1] = ends(rho)[1], ends(error)[1]
        return View(features, bonus, matrix, w, float(self.radius[t - 1]), error)

    def _trivial(self, features: Enclosed) -> float:
        """A round's regret without learning: 2BW, or W times the diameter of the candidates (audit R4(i))."""
        most = ends(2 * self.bound * self.weight_bound)[1]
        if self.counts is not None:
            return most
        return min(most, enlarged(self.highest_weight * diameter(features)))

    def _learn(self, t: int) -> None:
        given, (states, actions) = self.facts, (self.facts.states[t - 1], self.facts.actions[t - 1])
        one, two = (given.table.of_trajectories(s, a) for s, a in zip(states, actions, strict=True))
        answered = ~np.isnan(given.outcomes[t - 1])
        self.differences = np.concatenate([self.differences, (one - two)[answered]])
        self.outcomes = np.concatenate([self.outcomes, given.outcomes[t - 1][answered]])
        if self.counts is not None:
            add_transitions(self.counts, states, actions)


def _inside(w: FloatArray, weight_bound: float) -> FloatArray:
    """Weights of norm at most W for certain: R1 takes any point of the ball, so that a rounding may be undone."""
    norm = float(largest_norms(Enclosed(w[None], 0.0))[0])
    return w if norm <= weight_bound else w * (weight_bound / norm * (1 - 1e-12))
