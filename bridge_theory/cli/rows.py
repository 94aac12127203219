"""Which formulas a setting determines, and which flag would add the others."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from bridge_theory.bound import Bound
from bridge_theory.cli.options import flag
from bridge_theory.errors import InputError
from bridge_theory.formula import Formula
from bridge_theory.parameters import PARAMETERS
from bridge_theory.setting import Setting
from bridge_theory.value import BoundValue

_IMPLIED = {"rows": "S", "S_reach": "S", "t": "T", "diameter": "B", "delta1": "delta", "delta2": "delta"}
_PRIMARY = ("S", "A", "H", "n", "d", "B", "W", "T", "lam", "delta", "gamma_min")


@dataclass(frozen=True)
class Row:
    """One line of the table: a formula with its certified value, its estimate if it is a rate, or why it has none."""

    formula: Formula
    value: BoundValue | None = None
    estimate: float | None = None
    problem: str = ""


def row_for(formula: Formula, setting: Setting) -> Row:
    """Evaluate one formula whose parameters the setting determines."""
    try:
        if isinstance(formula, Bound):
            return Row(formula, value=formula.value(setting))
        known = setting.completed(())
        exact = {name: known[name] for name in formula.parameters}
        return Row(formula, estimate=float(np.float64(formula.estimate(**exact))))
    except InputError as error:
        return Row(formula, problem=str(error))


def missing_from(formula: Formula, setting: Setting) -> tuple[str, ...]:
    """The parameters a user would have to add before this formula has a value."""
    spends = formula.spends if isinstance(formula, Bound) else ()
    known = setting.completed(spends)
    implied = {**_IMPLIED, **dict.fromkeys(spends, "delta")}
    lacking = [implied.get(name, name) for name in formula.parameters if name not in known]
    return tuple(dict.fromkeys(lacking))


def additions(formulas: Iterable[Formula], setting: Setting, *, everything: bool) -> list[str]:
    """Sentences that say which flags would add which rows; those with intermediate quantities only on request."""
    by_flags: dict[tuple[str, ...], list[str]] = {}
    hidden = 0
    for formula in formulas:
        missing = missing_from(formula, setting)
        if everything or set(missing) <= set(_PRIMARY):
            by_flags.setdefault(tuple(sorted(missing, key=_rank)), []).append(formula.name)
        else:
            hidden += 1
    lines = [
        f"{' '.join(map(flag, missing))} would add {', '.join(names)}"
        for missing, names in sorted(
            by_flags.items(), key=lambda item: (len(item[0]), [_rank(name) for name in item[0]])
        )
    ]
    if hidden:
        lines.append(f"{hidden} more take intermediate quantities or counts; --left-out lists them with their flags")
    return lines


def _rank(name: str) -> tuple[int, str]:
    return (_PRIMARY.index(name) if name in _PRIMARY else len(_PRIMARY), name)


def described_parameters(formula: Formula) -> list[str]:
    """One line per parameter: name, meaning, domain, unit."""
    return [
        f"{name}: {PARAMETERS[name].meaning} ({PARAMETERS[name].domain.describe(name)}; unit: {PARAMETERS[name].unit})"
        for name in formula.parameters
    ]
