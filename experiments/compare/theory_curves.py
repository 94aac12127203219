"""Each version of the theory as a curve over the rounds, or the reason why a run does not give it.

Which failure probability is spent: the run's own ``delta`` for each event (its sets used that one for the weights and,
with unknown dynamics, for the transitions); a curve's ``failure`` is their sum.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

import bridge_theory as theory
from bridge_algos.mdp import FloatArray
from bridge_theory.bound import Bound, Rate
from bridge_theory.errors import InputError
from experiments.compare.applicability import missing_of_certified, missing_of_repaired, missing_of_stated
from experiments.compare.certificates import CHECKER, SOURCES, certified
from experiments.compare.subject import Subject

Kind = Literal["trivial", "certified", "answers", "a-priori", "played", "stated", "stated-sums", "rate"]


@dataclass(frozen=True, eq=False)
class Curve:
    """One version of the theory over the rounds.

    Args:
        kind: which version.
        label: for the legend.
        source: label in the paper, or audit label.
        formula: what computes it, a name in ``bridge_theory`` or of the checker.
        values: (seeds, G), or (1, G) where it is the same for all seeds: certified upper ends of the bounds, in units
            of utility; the scaled estimate of a rate.
        failure: probability with which the statement may fail, at most; 0 for one that cannot, None for a rate.
        missing: assumptions of the statement that this run does not meet; empty when it is about this run.
    """

    kind: Kind
    label: str
    source: str
    formula: str
    values: FloatArray
    failure: float | None
    missing: tuple[str, ...] = ()

    @property
    def mean(self) -> FloatArray:
        """(G,) mean over seeds."""
        return np.asarray(self.values.mean(axis=0))


@dataclass(frozen=True)
class LeftOut:
    """A version of the theory that is not drawn, and why."""

    label: str
    reason: str


def theory_curves(subject: Subject) -> tuple[list[Curve], list[LeftOut]]:
    """All versions of the theory for a run, and those that it does not give."""
    curves: list[Curve] = []
    left_out: list[LeftOut] = []
    for label, make in _versions(subject):
        try:
            curves.append(make(subject, label))
        except InputError as error:
            left_out.append(LeftOut(label, str(error)))
    if not subject.known:
        left_out.append(LeftOut("stated lemma, as printed", "its true bonuses are expectations that no run knows"))
    if any(curve.kind == "certified" for curve in curves):  # its minimum contains the widths played
        curves = [curve for curve in curves if curve.kind != "played"]
    return curves, left_out


def _versions(subject: Subject) -> list[tuple[str, Callable[[Subject, str], Curve]]]:
    versions: list[tuple[str, Callable[[Subject, str], Curve]]] = [
        ("trivial, 2BWT", _trivial),
        ("certified from the data (R4)", _certified),
        (f"a priori, repaired ({'R5' if subject.known else 'R7'})", _apriori),
        ("from the widths played (R4)", _played)
        if subject.config.confidence in ("repaired", "likelihood")
        else _SUMS[subject.known],
    ]
    if subject.known:
        versions.insert(2, ("certified from the answers (G6)", _answers))
        versions.append(("stated theorem", _stated))
    return [*versions, ("rate (scaled to touch), not a bound", _rate)]


def _trivial(subject: Subject, label: str) -> Curve:
    return _curve(subject, "trivial", label, theory.regret_trivial)


def _certified(subject: Subject, label: str) -> Curve:
    return _of_the_checker(subject, "certified", label, "best")


def _answers(subject: Subject, label: str) -> Curve:
    return _of_the_checker(subject, "answers", label, "likelihood")


def _of_the_checker(subject: Subject, kind: Kind, label: str, bound: str) -> Curve:
    seeds = [int(seed) for seed in subject.results.seed.values]
    values, failure = certified(subject.certificates, subject.algorithm, seeds, bound)
    missing = missing_of_certified(subject)
    return Curve(kind, label, SOURCES[bound], CHECKER, subject.at_rounds(values), failure, missing)


def _apriori(subject: Subject, label: str) -> Curve:
    missing = missing_of_repaired(subject)
    version_space = subject.config.radius == "zero"
    if version_space:
        bound = theory.regret_known_version_space if subject.known else theory.regret_unknown_version_space
        return _curve(subject, "a-priori", label, bound, missing)
    bound = theory.regret_known_repaired if subject.known else theory.regret_unknown_repaired
    largest = 2 * subject.world.embedding.bound  # nothing is known of the set
    curve = _curve(subject, "a-priori", label, bound, missing, Delta_n=1.0, diameter=largest)
    return _with_offline_set(curve, subject)


def _with_offline_set(curve: Curve, subject: Subject) -> Curve:
    """The curve, its failure probability including that the offline set lacks the best policy."""
    return replace(curve, failure=min(1.0, (curve.failure or 0) + subject.config.delta))


def _stated(subject: Subject, label: str) -> Curve:
    missing = missing_of_stated(subject)
    return _curve(subject, "stated", label, theory.regret_known_stated, missing)


def _played(subject: Subject, label: str) -> Curve:
    widths = subject.at_rounds((subject.record("gamma") * subject.record("uncertainty")).cumsum(axis=1))
    bonuses = subject.at_rounds(subject.record("bonus_sum").cumsum(axis=1))
    values = [
        [
            theory.regret_width.enclosure(width_sum=float(width), bonus_sum=float(max(bonus, 0.0))).upper
            for width, bonus in zip(row, row_bonuses, strict=True)
        ]
        for row, row_bonuses in zip(widths, bonuses, strict=True)
    ]
    events = 1 + (not subject.known) + (subject.config.radius != "zero")
    return Curve(
        "played", label, theory.regret_width.source, theory.regret_width.name, np.array(values),
        min(1.0, events * subject.config.delta), missing_of_repaired(subject, ("repaired", "likelihood")),
    )  # fmt: skip


def _stated_sum_known(subject: Subject, label: str) -> Curve:
    norms = subject.at_rounds(subject.record("uncertainty").cumsum(axis=1))
    sums = [{"norm_sum": row} for row in norms]
    missing = missing_of_stated(subject)
    return _curve(subject, "stated-sums", label, theory.regret_known_from_sum, missing, of_seeds=sums)


def _stated_sum_unknown(subject: Subject, label: str) -> Curve:
    """With the run's own multiplier: its bonus sum is what gamma_t leaves beyond the other terms."""
    setting, rounds = subject.setting, subject.rounds
    gamma = subject.at_rounds(subject.record("gamma"))
    names = {name: setting[name] for name in ("B", "W", "lam", "d", "delta")}
    last = int(rounds[-1])
    without = [float(theory.gamma_unknown.estimate(t=int(t), T=last, bonus_square_sum=0, **names)) for t in rounds]
    squares = (np.maximum(gamma - np.array(without), 0) / 2) ** 2
    potentials = subject.at_rounds((subject.record("uncertainty") ** 2).cumsum(axis=1))
    bonuses = subject.at_rounds(2 * subject.record("bonus_sum").cumsum(axis=1))  # from eta = 2WB to 4WB: linear
    sums = [
        {"bonus_square_sum": square, "potential": potential, "bonus_sum": bonus}
        for square, potential, bonus in zip(squares, potentials, bonuses, strict=True)
    ]
    missing = missing_of_stated(subject)
    return _curve(subject, "stated-sums", label, theory.regret_unknown_squared, missing, of_seeds=sums)


_SUMS: dict[bool, tuple[str, Callable[[Subject, str], Curve]]] = {
    True: ("stated lemma, sums played", _stated_sum_known),
    False: ("stated lemma with its missing square, sums played", _stated_sum_unknown),
}


def _rate(subject: Subject, label: str) -> Curve:
    """Scaled by the smallest factor with which it is nowhere below the mean regret."""
    rate: Rate = theory.regret_known_rate if subject.known else theory.main_simplified_rate
    names = {name: subject.number(name) for name in rate.parameters if name != "T"}
    with np.errstate(invalid="ignore", divide="ignore"):
        values = np.asarray(rate.estimate(T=subject.rounds.astype(np.float64), **names), dtype=np.float64)
    positive = np.isfinite(values) & (values > 0)
    if not positive.any():
        raise InputError("the rate has no positive value in this range of rounds.")
    mean = subject.regret.mean(axis=0)
    factor = max(0.0, float((mean[positive] / values[positive]).max()))
    scaled = np.where(positive, factor * values, np.nan)
    return Curve("rate", label, rate.source, rate.name, scaled[None], None)


def _curve(
    subject: Subject,
    kind: Kind,
    label: str,
    bound: Bound,
    missing: tuple[str, ...] = (),
    *,
    of_seeds: Sequence[Mapping[str, FloatArray]] = ({},),
    **values: float,
) -> Curve:
    setting = subject.setting
    rows = []
    for sums in of_seeds:
        row = [
            bound.value(setting, T=int(t), **values, **{name: float(array[i]) for name, array in sums.items()})
            for i, t in enumerate(subject.rounds)
        ]
        rows.append([value.enclosure.upper for value in row])
    failure = min(1.0, row[-1].failure.upper)
    return Curve(kind, label, bound.source, bound.name, np.array(rows), failure, missing)
