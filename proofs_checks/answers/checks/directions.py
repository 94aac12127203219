"""The directions that ``solve_for`` relies on: every declared one, on whole intervals of one parameter."""

from __future__ import annotations

from bridge_theory.catalog import by_group
from bridge_theory.parameters import parameter
from proofs_checks.balls import Exact
from proofs_checks.outcome import Outcome, Tally
from proofs_checks.slopes import prove_monotone

_FIXED: dict[str, Exact] = {"tangent": 1, "reach": 1, "delta": "1/20", "delta_phi": "1/20", "weight_norm": "1/2"}


def directions(*, flipped: bool = False) -> Outcome:
    """The derivative's sign over an interval of one parameter, the others fixed; ``flipped`` claims the opposite."""
    tally = Tally()
    for bound in by_group("answers"):
        for running, declared in bound.monotone.items():
            claimed = {"rises": "falls", "falls": "rises"}[declared.direction] if flipped else declared.direction
            box = {name: _interval(name) if name == running else (_fixed(name),) * 2 for name in bound.parameters}
            outcome = prove_monotone(bound, running, box, claimed, most=3000)  # type: ignore[arg-type]
            tally.expect(outcome.holds, "; ".join(outcome.failures))
    return tally.outcome(f"{tally.decisions} directions of the formulas about answers")


def _interval(name: str) -> tuple[Exact, Exact]:
    domain = parameter(name).domain
    if domain.integer:
        return domain.low, 50 if name == "d" else 10**6
    return ("1/1000", "2/5") if name.startswith("delta") else ("1/10", 10)


def _fixed(name: str) -> Exact:
    return _FIXED.get(name, 3 if parameter(name).domain.integer else 2)
