"""The technical lemma where the expert visits all that the policy visits: what holds, and a growing counterexample."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from proofs_checks.context import Context
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import Choice, History, Row, occupancies, squared_hellinger
from proofs_checks.exact.model import Model, point
from proofs_checks.exact.strategies import choices, pairs
from proofs_checks.outcome import Outcome, Tally

Instance = tuple[Model, Model, Choice, Choice]


@st.composite
def _inside(draw: DrawFn) -> Instance:
    """Two kernels, an expert with an action per step and state, and a policy with the same support."""
    pair = draw(pairs())
    model = pair.model
    table = [[draw(st.integers(0, model.n_actions - 1)) for _ in range(model.n_states)] for _ in range(model.horizon)]
    free = draw(choices(model))

    def expert(history: History) -> Row:
        return point(table[len(history) // 2][history[-1]], model.n_actions)

    seen = [{s for s, _ in step} for step in occupancies(model.law(expert), model.horizon)]

    def other(history: History) -> Row:
        return expert(history) if history[-1] in seen[len(history) // 2] else free(history)

    return model, pair.estimate, expert, other


def full_support_is_the_expert(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """A deterministic expert that visits what the policy visits: both have the same error and occupancies."""

    def holds(instance: Instance) -> bool:
        model, estimate, expert, other = instance
        laws = [(model.law(each, arrival=True), estimate.law(each, arrival=True)) for each in (expert, other)]
        same = occupancies(laws[0][0], model.horizon) == occupancies(laws[1][0], model.horizon)
        errors = [squared_hellinger(*both) for both in laws]
        return same and errors[1] == errors[0] * share

    return on_every("full support of a deterministic expert", _inside(), holds, context.pick(quick=40, full=150))


def family_grows(*, slope: Fraction = Fraction(19, 10)) -> Outcome:
    """H^2(pi) >= slope (T - 1) C H^2(pi*) along the family of the stored counterexample, at p = 1/1000, T = 2, ..., 7.

    The counterexample's own data, with another p and horizon, are evaluated.
    """
    from proofs_checks.counterexample import load
    from proofs_checks.evaluators.offline_models import EXPERT, OTHER, concentrability, trajectory_error

    tally = Tally()
    for steps in range(2, 8):
        data = _rarer(load("offline-history-family").data, Fraction(1, 1000), steps)
        bound = trajectory_error(data, EXPERT) * concentrability(data) * slope * (steps - 1)
        tally.expect(trajectory_error(data, OTHER) >= bound, f"the ratio at T = {steps} is below {slope} (T - 1)")
    return tally.outcome("the family with 2 to 7 transitions")


def _rarer(data: Any, rare: Fraction, horizon: int) -> dict[str, Any]:
    """The instance with the probability 1/100 of its rare steps replaced."""
    new = {"1/100": str(rare), "99/100": str(1 - rare)}
    kernels = {
        name: [[[new.get(p, p) for p in row] for row in rows] for rows in kernel]
        for name, kernel in data["kernels"].items()
    }
    return {**data, "kernels": kernels, "horizon": horizon}
