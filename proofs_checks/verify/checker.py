r"""The checker: from a log to a certificate, trusting nothing that can be recomputed.

Two things are done side by side. The *certificate* comes from the trajectories, the answers, the candidates and the
weights alone: data matrix, solver error and radius of audit R1 (for any weights in the ball, however they were found),
bonuses of R6, the sets they give, and the regret bounds of R4. The *claims* of the run are recomputed by the run's own
rule; a log that contradicts itself is not certified, whatever its bounds. Hence a hand-set or unproved multiplier costs
a run nothing here but its own sets: the bounds use the certified radius, which holds for whatever was played.

No code is shared with the algorithms: this package imports formulas and balls from ``bridge_theory``, the file reader
and the definitions of the built-in environments, and nothing else.
"""

from __future__ import annotations

import numpy as np
from threadpoolctl import threadpool_limits

from bridge_algos.run.log_file import RunLog
from bridge_theory.arithmetic.flint_balls import ball, ends, working_precision
from bridge_theory.errors import ComputationError
from proofs_checks.verify.certificate import BOUNDS, Certificate
from proofs_checks.verify.claims import Replay
from proofs_checks.verify.consistency import ALL, VERSION_SPACE, best_policy_is_searched, contradictions
from proofs_checks.verify.ellipsoid import certified_scale, data_matrix, radius, solver_error
from proofs_checks.verify.enclosed import Enclosed, FloatArray, cumulative, enlarged, largest_norms, raised
from proofs_checks.verify.facts import Facts, add_transitions, facts
from proofs_checks.verify.features import (
    IntArray,
    estimated_kernel,
    expectations,
    feature_bound,
    row_radii,
)
from proofs_checks.verify.regret import View, best_bounds, diameter, hindsight, round_bounds

BITS = 96


def verify(log: RunLog) -> tuple[Certificate, ...]:
    """Check every algorithm of a log.

    Raises:
        InputError: when the log is malformed or too large to check.
    """
    with threadpool_limits(1):  # small products: threads cost more than they do
        return tuple(check(facts(log, algorithm)) for algorithm in log.algorithms)


def check(given: Facts) -> Certificate:
    """The certificate of one algorithm of a log."""
    with working_precision(BITS):
        reasons = contradictions(given)
        if reasons:
            return _certificate(given, reasons, None)
        walk = _Walk(given)
        try:
            walk.run()
        except ComputationError as error:
            return _certificate(given, [str(error)], None)
        return _certificate(given, walk.replay.faults, walk)


class _Walk:
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
        return sums | {"hindsight": self.hindsight, "best": best_bounds(self.steps, self.hindsight)}

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


def theory_withheld(given: Facts) -> list[str]:
    """Why no bound but the trivial one is available, whatever the run did; empty when all are."""
    config = given.configuration
    answers = given.outcomes
    reasons = {
        f"the answers come from the oracle {config['oracle']!r}, not from the Bradley-Terry model": config["oracle"]
        != "bradley-terry",
        "some answers are missing or ties": bool((~np.isin(answers, (0.0, 1.0))).any()),
        f"the fitted slope is {float(given.slope):g}, not the Bradley-Terry model's 1": given.slope != 1,
        "noise changed the recorded actions, so that counts are not those of the environment": given.algorithm
        == "bridge"
        and config.get("noise") != 0,
    }
    return [reason for reason, holds in reasons.items() if holds]


def _notes(given: Facts) -> tuple[str, ...]:
    withheld = theory_withheld(given)
    if withheld:
        return tuple(f"only the trivial bound is certified: {reason}" for reason in withheld)
    kinds = {"fixed": "hand-set multiplier and bonuses have", "stated": "stated multiplier and bonuses have"}
    kind = kinds.get(given.configuration["confidence"])
    if kind is None:
        return ()
    return (f"the run's {kind} no guarantee; the bounds use the certified radius and bonuses, and the sets they give",)


def _assumptions(given: Facts) -> tuple[str, ...]:
    searched = best_policy_is_searched(given)
    comparator = {
        ALL: "regret is measured against the best policy, which is searched because all are",
        VERSION_SPACE: f"the demonstrations come from a best policy, so that it is searched: {VERSION_SPACE}",
        None: "regret is measured against the best of the policies searched; a log cannot show how good that is",
    }
    general = ("the utility of a policy is <phi, w*> with ||w*|| <= W", comparator[searched])
    if theory_withheld(given):
        return general
    return (
        *general,
        "answers are independent given the trajectories and follow the Bradley-Terry model with w*",
        "the trajectories come from the real environment, both rollouts of a round drawn independently",
    )


def _certificate(given: Facts, reasons: list[str], walk: _Walk | None) -> Certificate:
    rounds, certified = given.rounds, walk is not None and not reasons
    nothing = {name: np.full(rounds, np.inf) for name in BOUNDS}
    spent: dict[str, float] = {}
    if certified and not theory_withheld(given):
        delta = float(given.delta)
        spent = {"weights": delta} if given.known else {"weights": delta, "transitions": delta}
    return Certificate(
        algorithm=given.algorithm,
        seed=given.seed,
        rounds=rounds,
        certified=certified,
        reasons=tuple(reasons),
        notes=_notes(given) if certified else (),
        assumptions=_assumptions(given) if certified else (),
        spent=spent,
        bounds=walk.bounds() if walk is not None and certified else nothing,
        radius=np.full(rounds + 1, np.inf) if walk is None else walk.radius,
        solver_error=np.full(rounds + 1, np.inf) if walk is None else walk.errors,
        set_size=np.full(rounds, np.nan) if walk is None else walk.set_size,
    )
