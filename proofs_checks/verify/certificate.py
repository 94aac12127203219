"""A certificate: cumulative regret bounds that hold on one event of stated probability, or why there are none."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from proofs_checks.verify.enclosed import FloatArray

BOUNDS = ("trivial", "ucb", "width", "hindsight", "best")

_SHOWN_REASONS = 5


@dataclass(frozen=True, eq=False)
class Certificate:
    r"""What a log proves about one algorithm's regret.

    Args:
        algorithm, seed, rounds: whose.
        certified: whether the log agrees with itself, so that ``bounds`` hold on the event below.
        reasons: why not, one sentence each.
        notes: what limits the bounds, for example a multiplier without a guarantee.
        assumptions: what no log can show.
        spent: failure probability of each event used.
        bounds: for each name of ``BOUNDS`` an array (T,) of upper bounds on :math:`\sum_{l\le t} r_l`, rounded up, in
            utility :math:`\langle\phi, w^*\rangle`; infinite where not available.
        radius, solver_error: (T + 1,) rho_t and e_t of audit R1, rounded up.
        set_size: (T,) policies that are not certainly outside Pi_t.
    """

    algorithm: str
    seed: int
    rounds: int
    certified: bool
    reasons: tuple[str, ...]
    notes: tuple[str, ...]
    assumptions: tuple[str, ...]
    spent: dict[str, float]
    bounds: dict[str, FloatArray]
    radius: FloatArray
    solver_error: FloatArray
    set_size: FloatArray

    @property
    def failure(self) -> float:
        """Total failure probability of the events used, rounded up."""
        total = sum(map(Fraction, self.spent.values()), start=Fraction(0))
        return float(total) if Fraction(float(total)) >= total else float(np.nextafter(float(total), 2.0))

    def words(self) -> str:
        """A small table and the verdict."""
        head = f"{self.algorithm}, seed {self.seed}, {self.rounds} rounds: "
        if not self.certified:
            more = len(self.reasons) - _SHOWN_REASONS
            lines = [head + "not certified", *(f"  {reason}" for reason in self.reasons[:_SHOWN_REASONS])]
            return "\n".join([*lines, f"  and {more} more"] if more > 0 else lines)
        events = " + ".join(f"{name} {value:g}" for name, value in self.spent.items()) or "none"
        lines = [
            head + f"certified, with failure probability {self.failure:.3g} ({events})",
            "  regret after all rounds is at most, in utility <phi, w*>:",
            *(f"    {name:<10} {self.bounds[name][-1]:>12.6g}" for name in BOUNDS),
            *(f"  note: {note}" for note in self.notes),
            *(f"  assuming: {assumption}" for assumption in self.assumptions),
        ]
        return "\n".join(lines)

    def record(self) -> dict[str, Any]:
        """The certificate as plain JSON values; an infinite bound is null."""
        return {
            "algorithm": self.algorithm,
            "seed": self.seed,
            "rounds": self.rounds,
            "certified": self.certified,
            "reasons": list(self.reasons),
            "notes": list(self.notes),
            "assumptions": list(self.assumptions),
            "failure": self.failure,
            "spent": self.spent,
            "bounds": {name: _finite(values) for name, values in self.bounds.items()},
            "radius": _finite(self.radius),
            "solver_error": _finite(self.solver_error),
            "set_size": _finite(self.set_size),
        }


def _finite(values: FloatArray) -> list[float | None]:
    return [value if np.isfinite(value) else None for value in values.tolist()]
