"""Empirical regret beside every version of the theory: what lies below what, and what that means."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from bridge_algos.mdp import FloatArray, IntArray
from bridge_theory import regret_trivial
from experiments.compare.ledger import Replay, exact_replay, holds, refuted_label
from experiments.compare.sequence import confidence_sequence
from experiments.compare.subject import Subject, subjects
from experiments.compare.theory_curves import Curve, LeftOut, theory_curves

ALPHA = 0.05
"""Error probability of the band around the mean and of the verdict "violated"."""

Verdict = Literal["informative", "vacuous", "violated", "below, not certified", "below, not about this run", "rate"]


@dataclass(frozen=True, eq=False)
class Empirical:
    """The realised pseudo-regret, cumulative, in units of utility.

    Args:
        regret: (seeds, G), exact for each seed.
        lower, upper: (G,) confidence sequence for the mean over seeds; None for one seed and where the ledger proves
            the run deterministic.
        replay: the ledger's exact replay, where the run is an instance of it.
    """

    regret: FloatArray
    lower: FloatArray | None
    upper: FloatArray | None
    replay: Replay | None

    @property
    def mean(self) -> FloatArray:
        """(G,) mean over seeds."""
        return np.asarray(self.regret.mean(axis=0))

    @property
    def seeds(self) -> int:
        """How many independent runs there are."""
        return len(self.regret)


@dataclass(frozen=True, eq=False)
class Row:
    """A version of the theory after the last round.

    Args:
        value: mean over seeds.
        ratio: value over mean empirical regret; infinite when there is no regret.
        verdict: see :func:`compare`.
        exceeded: seeds whose regret is above the value.
        chance: lower end of the 95 % confidence sequence for the probability that a run's regret is above the value.
        ledger: label of the ledger's claim that the statement is false, "" where there is none; None where the ledger
            is not installed.
        proved: whether the statement is proved: one of the repaired theory, or held to be true by the ledger.
        violated_from: first round drawn from which on the violation is certified; None where it is not.
    """

    curve: Curve
    value: float
    ratio: float
    verdict: Verdict
    exceeded: int
    chance: float
    ledger: str | None
    proved: bool
    violated_from: int | None


@dataclass(frozen=True, eq=False)
class Comparison:
    """One algorithm of one run beside the theory.

    Args:
        run: name of the run's directory.
        rounds: (G,) the rounds t drawn, the last one T.
        setting: the parameters of the formulas, in words.
        trivial: 2BWT at the last round, below which a bound says something.
        rows: one a version that is drawn, in the order of the legend.
        left_out: versions that this run does not give, and why.
    """

    run: str
    environment: str
    algorithm: str
    rounds: IntArray
    empirical: Empirical
    setting: Mapping[str, str]
    trivial: float
    rows: tuple[Row, ...]
    left_out: tuple[LeftOut, ...]


def compare(directory: Path, jobs: int = 1) -> tuple[Comparison, ...]:
    """Compare a stored run with the theory, one comparison for each algorithm that the theory speaks about.

    Verdicts on a bound after the last round T:

    - ``"violated"``: the statement is about this run, and false here. Either the ledger's exact replay proves the
      run's regret, or the lower end of a 95 % confidence sequence for the probability that a run's regret exceeds the
      bound is above the failure probability that the statement allows.
    - ``"below, not certified"``: some seeds exceed it, no more than the failure probability may explain.
    - ``"below, not about this run"``: the mean regret exceeds it, but the run does not meet its assumptions.
    - ``"vacuous"``: no better than 2BWT, or its failure probability is 1. ``"informative"``: certainly below it.

    Args:
        directory: where 'bridge-rl run' stored the run, with its logs where certified bounds are wanted.
        jobs: processes that check the logs; they do not change the result.

    Raises:
        InputError: when there is no run, or none of its algorithms can be compared.
    """
    return tuple(_compare(subject) for subject in subjects(directory, jobs))


def _compare(subject: Subject) -> Comparison:
    curves, left_out = theory_curves(subject)
    empirical = _empirical(subject)
    setting, last = subject.setting, int(subject.rounds[-1])
    trivial = regret_trivial.enclosure(B=setting["B"], W=setting["W"], T=last).lower
    return Comparison(
        run=subject.name,
        environment=subject.config.environment,
        algorithm=subject.algorithm,
        rounds=subject.rounds,
        empirical=empirical,
        setting={name: f"{subject.number(name):.6g}" for name in ("S", "A", "H", "n", "d", "B", "W", "lam", "delta")},
        trivial=trivial,
        rows=tuple(_row(curve, empirical, trivial) for curve in curves),
        left_out=tuple(left_out),
    )


def _empirical(subject: Subject) -> Empirical:
    regret = subject.regret
    replay = exact_replay(subject)
    if replay is not None or len(regret) == 1:
        return Empirical(regret, None, None, replay)
    low, high = (np.asarray(end * subject.rounds, dtype=np.float64) for end in subject.range_of_a_round)
    return Empirical(regret, *confidence_sequence(regret, low, high, ALPHA), None)


def _row(curve: Curve, empirical: Empirical, trivial: float) -> Row:
    final, value = empirical.regret[:, -1], float(curve.mean[-1])
    mean = float(final.mean())
    above = final - _rounding(final) > curve.values[:, -1]
    chance, violated_from = 0.0, None
    if curve.failure is not None:
        chance = float(confidence_sequence(above.astype(np.float64), 0.0, 1.0, ALPHA)[0])
    verdict: Verdict
    if curve.kind == "rate":
        verdict = "rate"
    elif empirical.replay is not None and empirical.replay.label == curve.source and above.all():
        verdict = "violated"
        violated_from = empirical.replay.violated_from
    elif above.any() and not curve.missing:
        allowed = curve.failure or 0.0
        verdict = "violated" if allowed == 0 or chance > allowed else "below, not certified"
    elif above.any() and mean > value:
        verdict = "below, not about this run"
    else:
        verdict = "vacuous" if value >= trivial or curve.failure == 1 else "informative"
    return Row(
        curve=curve,
        value=value,
        ratio=value / mean if mean > 0 else float("inf"),
        verdict=verdict,
        exceeded=int(above.sum()),
        chance=chance,
        ledger=refuted_label(curve.source),
        proved=curve.kind not in ("stated", "stated-sums", "rate") or holds(curve.source),
        violated_from=violated_from,
    )


def _rounding(regret: FloatArray) -> FloatArray:
    """More than the error of adding up a run's regret in double precision."""
    return np.asarray(1e-9 * (1 + np.abs(regret)))
