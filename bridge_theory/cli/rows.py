"""Which formulas a setting determines, and which flag would add the others."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from bridge_theory.bound import Bound
from bridge_theory.cli.options import flag
from bridge_theory.defaults import Filled, completed, missing
from bridge_theory.errors import InputError
from bridge_theory.formula import Formula
from bridge_theory.parameters import PARAMETERS
from bridge_theory.setting import Setting
from bridge_theory.value import BoundValue

_PRIMARY = ("S", "A", "H", "n", "d", "B", "W", "T", "lam", "delta", "gamma_min")


@dataclass(frozen=True)
class Row:
    """One line of the table: a formula with its certified value, its estimate if it is a rate, or why it has none."""

    formula: Formula
    value: BoundValue | None = None
    estimate: float | None = None
    problem: str = ""
    filled: tuple[Filled, ...] = ()


def row_for(formula: Formula, setting: Setting) -> Row:
    """Evaluate one formula whose parameters the setting determines."""
    try:
        if isinstance(formula, Bound):
            value = formula.value(setting)
            return Row(formula, value=value, filled=value.filled)
        known, filled = completed(formula, setting)
        return Row(formula, estimate=float(np.float64(formula.estimate(**known))), filled=filled)
    except InputError as error:
        return Row(formula, problem=str(error))


def additions(formulas: Iterable[Formula], setting: Setting, *, everything: bool) -> list[str]:
    """Sentences that say which flags would add which rows; those with intermediate quantities only on request."""
    by_flags: dict[tuple[str, ...], list[str]] = {}
    hidden = 0
    for formula in formulas:
        lacking = missing(formula, setting)
        if everything or set(lacking) <= set(_PRIMARY):
            by_flags.setdefault(tuple(sorted(lacking, key=_rank)), []).append(formula.name)
        else:
            hidden += 1
    lines = [
        f"{' '.join(map(flag, lacking))} would add {', '.join(names)}"
        for lacking, names in sorted(
            by_flags.items(), key=lambda item: (len(item[0]), [_rank(name) for name in item[0]])
        )
    ]
    if hidden:
        lines.append(f"{hidden} more take intermediate quantities or counts; --left-out lists them with their flags")
    return lines


def filled_in(bounds: Iterable[tuple[str, tuple[Filled, ...]]]) -> list[str]:
    """One line for each value that some bounds had filled in, with what it assumes and which bounds those are."""
    takers: dict[str, dict[str, list[str]]] = {}
    parts: dict[str, None] = {}
    for bound, filled in bounds:
        for item in filled:
            if item.part_of_delta:
                parts[item.name] = None
            else:
                takers.setdefault(item.name, {}).setdefault(str(item), []).append(bound)
    lines = [
        text if len(texts) == 1 else f"{text} in {', '.join(names)}"  # named where others differ
        for texts in takers.values()
        for text, names in texts.items()
    ]
    return [*lines, f"{', '.join(parts)} = equal parts of delta in each bound"] if parts else lines


def failure_words(value: BoundValue) -> str:
    """The bound's own failure probability for a table; it certifies nothing from 1 on."""
    return value.failure.at_most if value.certified else f"{value.failure.at_most}: not certified"


def _rank(name: str) -> tuple[int, str]:
    return (_PRIMARY.index(name) if name in _PRIMARY else len(_PRIMARY), name)


def described_parameters(formula: Formula) -> list[str]:
    """One line per parameter: name, meaning, domain, unit."""
    return [
        f"{name}: {PARAMETERS[name].meaning} ({PARAMETERS[name].domain.describe(name)}; unit: {PARAMETERS[name].unit})"
        for name in formula.parameters
    ]
