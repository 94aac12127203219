"""A certificate: cumulative regret bounds that hold on one event of stated probability, or why there are none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite
from typing import Any

import numpy as np

from bridge_theory.rounding import rounded_up as decimals_above
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
        """The certificate as text; see :func:`table`."""
        return table([self])

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


def table(certificates: Sequence[Certificate]) -> str:
    """Certificates as text: a row each, then what they rest on, then why some are refused."""
    head = ("seed", "algorithm", "verdict", *BOUNDS, "failure")
    rows = [head] + [
        (str(c.seed), c.algorithm, "certified", *(rounded_up(c.bounds[name][-1]) for name in BOUNDS), f"{c.failure:g}")
        if c.certified
        else (str(c.seed), c.algorithm, "NOT CERTIFIED", *("-" for _ in BOUNDS), "-")
        for c in certificates
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
    lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
    lines.append("bounds on the regret after all rounds in utility <phi, w*>, each rounded up")
    for kind in ("notes", "assumptions"):
        holders: dict[str, list[str]] = {}
        for c in certificates:
            for sentence in getattr(c, kind):
                if c.algorithm not in holders.setdefault(sentence, []):
                    holders[sentence].append(c.algorithm)
        word = {"notes": "note", "assumptions": "assuming"}[kind]
        lines += [f"{word} ({', '.join(names)}): {sentence}" for sentence, names in holders.items()]
    for c in certificates:
        more = len(c.reasons) - _SHOWN_REASONS
        lines += [f"seed {c.seed}, {c.algorithm}: {reason}" for reason in c.reasons[:_SHOWN_REASONS]]
        lines += [f"seed {c.seed}, {c.algorithm}: and {more} more"] if more > 0 else []
    good = sum(c.certified for c in certificates)
    return "\n".join([*lines, f"{good} of {len(certificates)} certified"])


def rounded_up(value: float) -> str:
    """A bound as text: six significant digits, rounded up, and ``"-"`` where it is infinite."""
    return decimals_above(value) if isfinite(value) else "-"
