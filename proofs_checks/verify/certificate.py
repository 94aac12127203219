"""A certificate: cumulative regret bounds that hold on one event of stated probability, or why there are none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite
from typing import Any

import numpy as np

from bridge_theory.rounding import rounded_up as decimals_above
from proofs_checks.verify.comparator import Comparator
from proofs_checks.verify.enclosed import FloatArray

BOUNDS = ("trivial", "ucb", "width", "hindsight", "best", "likelihood")

_SHOWN_REASONS = 5


@dataclass(frozen=True, eq=False)
class Certificate:
    r"""What a log proves about one algorithm's regret.

    Args:
        algorithm, seed, rounds: whose.
        certified: whether the log agrees with itself, so that ``bounds`` hold, each but for its own ``failures``.
        reasons: why not, one sentence each.
        comparator: what the regret is measured against.
        notes: what limits the bounds, for example a multiplier without a guarantee.
        assumptions: what no log can show.
        unshown: entries of the log that may be changed without a contradiction to its data, each with what of it is
            shown, "" for nothing.
        spent: failure probability of each event that the bounds of R4 use, all but ``"trivial"`` and ``"likelihood"``;
            empty where there are none.
        alone: failure probability of the ``"likelihood"`` bound (companion G6), by its name, on an event of its own;
            empty where there is none.
        bounds: for each name of ``BOUNDS`` an array (T,) of upper bounds on :math:`\sum_{l\le t} r_l`, rounded up, in
            utility :math:`\langle\phi, w^*\rangle`; infinite where not available. ``"best"`` is the least that follows
            from those of R4 together.
        radius, solver_error: (T + 1,) rho_t and e_t of audit R1, rounded up.
        set_size: (T,) policies that are not certainly outside Pi_t.
    """

    algorithm: str
    seed: int
    rounds: int
    certified: bool
    reasons: tuple[str, ...]
    comparator: Comparator
    notes: tuple[str, ...]
    assumptions: tuple[str, ...]
    unshown: dict[str, str]
    spent: dict[str, float]
    alone: dict[str, float]
    bounds: dict[str, FloatArray]
    radius: FloatArray
    solver_error: FloatArray
    set_size: FloatArray

    @property
    def failure(self) -> float:
        """Total failure probability of the events used, rounded up."""
        total = sum(map(Fraction, self.spent.values()), start=Fraction(0))
        return float(total) if Fraction(float(total)) >= total else float(np.nextafter(float(total), 2.0))

    @property
    def failure_words(self) -> str:
        """That probability as text, its decimals rounded up."""
        return decimals_above(Fraction(repr(self.failure)))

    @property
    def failures(self) -> dict[str, float]:
        """Failure probability of each bound: the trivial one cannot fail, those of R4 hold together."""
        own = {"trivial": 0.0, "likelihood": 0.0} | self.alone
        return {name: own.get(name, self.failure) for name in self.bounds}

    @property
    def sentences(self) -> dict[str, tuple[str, ...]]:
        """All that a reader of the bounds must know, by kind."""
        if not self.certified:
            return {}
        nothing = [entry for entry, shown in self.unshown.items() if not shown]
        partly = [
            f"of {', '.join(entry for entry, part in self.unshown.items() if part == shown)} "
            f"the data show no more than {shown}"
            for shown in dict.fromkeys(filter(None, self.unshown.values()))
        ]
        return {
            "bounds": (self.comparator.sentence,),
            "note": self.notes,
            "assuming": self.assumptions,
            "likelihood": tuple(
                "the bound of that name is from questions and answers alone (companion G6): it assumes Bradley-Terry "
                "answers and ||w*|| <= W, but neither fresh trajectories nor a rule of play; it fails with probability "
                f"at most {decimals_above(Fraction(repr(failure)))} of its own, beside that of the others"
                for failure in self.alone.values()
            ),
            "taken at its word": tuple(partly) + ((f"nothing shows {', '.join(nothing)}",) if nothing else ()),
        }

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
            "comparator": self.comparator.sentence,
            "notes": list(self.notes),
            "assumptions": list(self.assumptions),
            "unshown": self.unshown,
            "failures": self.failures,
            "spent": self.spent,
            "alone": self.alone,
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
        (str(c.seed), c.algorithm, "certified", *(rounded_up(c.bounds[name][-1]) for name in BOUNDS), c.failure_words)
        if c.certified
        else (str(c.seed), c.algorithm, "NOT CERTIFIED", *("-" for _ in BOUNDS), "-")
        for c in certificates
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
    lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
    lines.append(
        "bounds on the regret after all rounds in utility <phi, w*>, each rounded up; the trivial one cannot fail, the "
        "others but the likelihood one hold together, but for the failure probability of their row"
    )
    lines += [f"{kind} ({holders}): {sentence}" for kind, sentence, holders in shared(certificates)]
    for c in certificates:
        more = len(c.reasons) - _SHOWN_REASONS
        lines += [f"seed {c.seed}, {c.algorithm}: {reason}" for reason in c.reasons[:_SHOWN_REASONS]]
        lines += [f"seed {c.seed}, {c.algorithm}: and {more} more"] if more > 0 else []
    good = sum(c.certified for c in certificates)
    return "\n".join([*lines, f"{good} of {len(certificates)} certified"])


def shared(certificates: Sequence[Certificate]) -> list[tuple[str, str, str]]:
    """Kind, sentence and holders of every sentence, each once: only certificates that have it are named.

    An algorithm alone stands for all its certificates; otherwise their seeds follow it.
    """
    seeds: dict[str, list[int]] = {}
    found: dict[tuple[str, str], dict[str, list[int]]] = {}
    for c in (c for c in certificates if c.certified):
        seeds.setdefault(c.algorithm, []).append(c.seed)
        for kind, sentences in c.sentences.items():
            for sentence in sentences:
                found.setdefault((kind, sentence), {}).setdefault(c.algorithm, []).append(c.seed)
    kinds = list(dict.fromkeys(kind for kind, _ in found))

    def named(algorithm: str, own: list[int]) -> str:
        if own == seeds[algorithm]:
            return algorithm
        return f"{algorithm} seed{'s' if len(own) > 1 else ''} {', '.join(map(str, own))}"

    return [
        (kind, sentence, ", ".join(named(*item) for item in holders.items()))
        for wanted in kinds
        for (kind, sentence), holders in found.items()
        if kind == wanted
    ]


def rounded_up(value: float) -> str:
    """A bound as text: six significant digits, rounded up, and ``"-"`` where it is infinite."""
    return decimals_above(value) if isfinite(value) else "-"
