"""``--sweep n=1:1e7:log``: bounds along one parameter, as a table and a figure."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bridge_theory.arithmetic.floats import FLOATS
from bridge_theory.arithmetic.protocol import FloatArray
from bridge_theory.bound import Bound, call_with
from bridge_theory.cli.figure import Curve, draw
from bridge_theory.cli.options import flag
from bridge_theory.cli.rows import filled_in
from bridge_theory.cli.table import text_table
from bridge_theory.cli.versions import RADIUS, REGRET
from bridge_theory.defaults import Filled, completed, missing
from bridge_theory.errors import InputError
from bridge_theory.parameters import Given, Parameter, parameter, show, to_exact
from bridge_theory.setting import Setting

_POINTS = 240
_ROWS = 9
_LARGEST = 1e300  # estimates beyond it overflow float64


@dataclass(frozen=True)
class Sweep:
    """A parameter and the values it takes, increasing."""

    row: Parameter
    values: tuple[Given, ...]
    log: bool


def parse_sweep(text: str) -> Sweep:
    """Read ``name=low:high`` or ``name=low:high:log``.

    Errors: ``InputError`` showing the form to write.

    >>> sweep = parse_sweep("n=1:1e7:log")
    >>> sweep.row.name, sweep.values[0], sweep.values[-1]
    ('n', 1, 10000000)
    """
    match = re.fullmatch(r"(\w+)=([^:]+):([^:]+)(:log|:lin)?", text.replace("-", "_", text.split("=")[0].count("-")))
    if match is None:
        raise InputError(f"--sweep {text!r} is not a range; write for example n=1:1e7:log or gamma_min=0.01:0.5")
    row = parameter(match[1])
    if row.array:
        raise InputError(f"--sweep cannot vary the array {row.name}; vary a parameter that is one number")
    low, high = (to_exact(row.name, end) for end in match.group(2, 3))
    row.exact(low)
    row.exact(high)
    log = match[4] == ":log"
    if not low < high or (log and low <= 0):
        raise InputError(f"--sweep {text!r} needs low < high{' and low > 0' if log else ''}")
    if high > _LARGEST:
        raise InputError(f"--sweep {text!r} ends beyond {_LARGEST:g}; a sweep draws float64 estimates, so end it below")
    space = np.geomspace if log else np.linspace
    inner = space(float(low), float(high), _POINTS)[1:-1].tolist()
    if row.domain.integer:
        whole = sorted({round(value) for value in inner} | {int(low), int(high)})
        return Sweep(row, tuple(whole), log)
    return Sweep(row, (low, *inner, high), log)


def run_sweep(sweep: Sweep, setting: Setting, chosen: Sequence[Bound], path: Path) -> str:
    """Draw the figure and return the table; estimates in float64, labelled as such."""
    bounds = list(chosen) or _default(sweep, setting)
    points = [setting.replace(**{sweep.row.name: value}) for value in sweep.values]
    _check_complete(bounds, points[0])
    x = np.array([float(point[sweep.row.name]) for point in points])  # type: ignore[arg-type]  # scalar by parse_sweep
    curves = [Curve(f"{bound.name} ({bound.status})", bound.status, x, _along(bound, points)) for bound in bounds]
    curves += _trivial(bounds, points, x)
    same = len({bound.symbol for bound in bounds}) == 1
    draw(
        path,
        curves,
        x_label=f"{sweep.row.name}: {sweep.row.meaning}",
        y_label=f"${bounds[0].symbol}$" if same else "value",
        title=_title(setting, sweep.row.name),
        log_x=sweep.log,
        log_y=all(np.all(curve.y > 0) for curve in curves),
    )
    picked = np.unique(np.linspace(0, len(x) - 1, _ROWS).round().astype(int))
    rows = [(f"{x[index]:.6g}", *(f"{curve.y[index]:.6g}" for curve in curves)) for index in picked]
    table = text_table((sweep.row.name, *(curve.label for curve in curves)), rows)
    notes = "".join(f"{note}\n" for note in _notes(bounds, [points[index] for index in picked], sweep.row.name))
    return f"float64 estimates (certify a point with bridge-rl bounds)\n{table}\n{notes}figure: {path}"


def _notes(bounds: Sequence[Bound], points: Sequence[Setting], varied: str) -> list[str]:
    """What was filled in, and where a bound may fail with probability 1 or more, so that it certifies nothing."""
    notes = [f"filled in: {line}" for line in filled_in((b.name, _filled(b, points, varied)) for b in bounds)]
    for bound in bounds:
        failing = [show(point[varied]) for point in points if not bound.value(point).certified]
        if failing:
            where = f"{varied} = {', '.join(failing)}"
            notes.append(f"{bound.name} certifies nothing at {where}: its events may fail with probability 1 in total")
    return notes


def _filled(bound: Bound, points: Sequence[Setting], varied: str) -> tuple[Filled, ...]:
    """What was filled in at the first point, marked where it changes along the sweep."""
    first, last = (completed(bound, point)[1] for point in (points[0], points[-1]))
    along = f"at {varied} = {show(points[0][varied])}; "
    return tuple(
        item if item == end else replace(item, assumes=along + item.assumes)
        for item, end in zip(first, last, strict=True)
    )


def _default(sweep: Sweep, setting: Setting) -> list[Bound]:
    first = setting.replace(**{sweep.row.name: sweep.values[0]})
    for family in (RADIUS, REGRET):
        usable = [bound for bound in family if not missing(bound, first)]
        if any(sweep.row.name in _touched(bound) for bound in usable):
            return usable
    raise InputError(f"no figure varies with {sweep.row.name} in this setting; name the bounds with --only")


def _touched(bound: Bound) -> set[str]:
    derived = {"delta"} if bound.spends else set()
    return {*bound.parameters, *derived}


def _check_complete(bounds: Sequence[Bound], point: Setting) -> None:
    for bound in bounds:
        lacking = missing(bound, point)
        if lacking:
            raise InputError(f"{bound.name} cannot be drawn; it also needs {' '.join(map(flag, lacking))}")


def _along(bound: Bound, points: Sequence[Setting]) -> FloatArray:
    # point by point, at the exact numbers of the setting: 1 - delta in float64 may have lost digits already
    known = [completed(bound, point)[0] for point in points]
    exact = [{name: values[name] for name in bound.parameters} for values in known]
    bound.check_conditions(
        {name: np.array([point[name] for point in exact], dtype=object) for name in bound.parameters}
    )
    return np.array([bound.estimate(**point) for point in exact])


def _columns(bound: Bound, points: Sequence[Setting]) -> dict[str, FloatArray]:
    known = [completed(bound, point)[0] for point in points]
    return {name: np.array([float(values[name]) for values in known]) for name in bound.parameters}  # type: ignore[arg-type]


def _trivial(bounds: Sequence[Bound], points: Sequence[Setting], x: FloatArray) -> list[Curve]:
    lines: dict[tuple[float, ...], Curve] = {}
    for bound in bounds:
        if bound.trivial is not None:
            level = (
                call_with(bound.trivial, FLOATS, _columns(bound, points)) if callable(bound.trivial) else bound.trivial
            )
            y = np.broadcast_to(np.asarray(level, dtype=np.float64), len(x))
            lines.setdefault(tuple(y.tolist()), Curve("trivial", "trivial", x, y))
    return list(lines.values())


def _title(setting: Setting, varied: str) -> str:
    # no-break spaces keep "name = value" on one line
    return ", ".join(f"{name}\u00a0=\u00a0{show(value)}" for name, value in setting.items() if name != varied)
