"""``bridge-rl bounds``: every bound of the paper at one setting, certified."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bridge_theory.bound import Bound
from bridge_theory.catalog import FORMULAS, by_label
from bridge_theory.cli.explain import explain
from bridge_theory.cli.options import Parser, add_parameters, setting_from
from bridge_theory.cli.rows import Row, additions, failure_words, filled_in, row_for
from bridge_theory.cli.sweep import parse_sweep, run_sweep
from bridge_theory.cli.table import text_table
from bridge_theory.defaults import filled_in_words, missing
from bridge_theory.errors import InputError
from bridge_theory.parameters import show
from bridge_theory.value import BoundValue

_HEADER = ("bound", "value", "enclosure", "may fail with", "trivial", "vacuous", "status", "source")
_GROUPS = ("offline", "online", "regret", "answers")


def main(argv: list[str], data: Sequence[BoundValue] = ()) -> int:
    """Run ``bridge-rl bounds``; ``data`` are values already computed from demonstrations, shown as their own group.

    Returns 0. Errors: ``InputError`` for a user's mistake.

    >>> main(["--S", "5", "--A", "4", "--n", "10000", "--delta", "0.05", "--only", "lem:offline_CI_under_known_dyn"])
    offline
      bound                 value     enclosure                     may fail with  trivial  vacuous  status  source
      offline_radius_known  0.114657  [0.1146563..., 0.1146563...]  0.05           1        no       stated
      lem:offline_CI_under_known_dyn
    0
    """
    arguments = _parser().parse_args(argv)
    setting = setting_from(arguments)
    if arguments.explain:
        print("\n\n".join(explain(formula, setting) for formula in by_label(arguments.explain)))
        return 0
    chosen = [formula for label in arguments.only for formula in by_label(label)]
    if arguments.sweep:
        bounds = [formula for formula in chosen if isinstance(formula, Bound)]
        print(run_sweep(parse_sweep(arguments.sweep), setting, bounds, Path(arguments.figure)))
        return 0
    formulas = chosen or list(FORMULAS.values())
    complete = [formula for formula in formulas if not missing(formula, setting)]
    rows = [row_for(formula, setting) for formula in complete] + [Row(value.bound, value) for value in data]
    rest = [formula for formula in formulas if formula not in complete]
    if arguments.json:
        print(json.dumps([_record(row) for row in rows], indent=2, allow_nan=False))
    elif arguments.latex:
        print(_latex(rows))
    else:
        left_out = additions(rest, setting, everything=arguments.left_out)
        print(_report(rows, left_out, of_data={value.bound.name for value in data}))
    return 0


def _parser() -> Parser:
    parser = Parser(prog="bridge-rl bounds", description=(__doc__ or "").strip(), allow_abbrev=False)
    parser.add_argument("--only", metavar="LABEL", action="append", default=[], help="a bound's name or source label")
    parser.add_argument("--explain", metavar="LABEL", help="statement, assumptions, terms and words of one bound")
    parser.add_argument("--sweep", metavar="NAME=LOW:HIGH[:log]", help="vary one parameter and draw a figure")
    parser.add_argument("--figure", metavar="FILE", default="sweep.png", help="where --sweep draws (default sweep.png)")
    parser.add_argument(
        "--left-out", action="store_true", help="list every row that is left out with the flags it needs"
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print JSON")
    form.add_argument("--latex", action="store_true", help="print the formulas and their values as LaTeX")
    add_parameters(parser)
    return parser


def _report(rows: list[Row], left_out: list[str], of_data: set[str]) -> str:
    blocks = []
    for group in (*_GROUPS, "from the demonstrations"):
        members = [row for row in rows if (row.formula.name in of_data) == (group not in _GROUPS)]
        members = [row for row in members if group not in _GROUPS or row.formula.group == group]
        if members:
            blocks.append(f"{group}\n" + text_table(_HEADER, [_cells(row) for row in members]))
    filled = filled_in((row.formula.name, row.filled) for row in rows)
    if filled:
        blocks.append("\n".join(["filled in, as they were not given", *(f"  {line}" for line in filled)]))
    if left_out:
        blocks.append("\n".join(["left out", *(f"  {line}" for line in left_out)]))
    return "\n\n".join(blocks)


def _cells(row: Row) -> tuple[str, ...]:
    ends = (row.formula.status, row.formula.source)
    if row.estimate is not None:
        return (row.formula.name, f"~ {row.estimate:.6g}", "a rate: for scaling only", "-", "-", "-", *ends)
    if row.value is None:
        return (row.formula.name, "undefined", row.problem, "-", "-", "-", *ends)
    value = row.value
    trivial = "-" if value.trivial is None else value.trivial.at_most
    vacuous = {None: "-", True: "vacuous", False: "no"}[value.vacuous]
    enclosure, failure = str(value.enclosure), failure_words(value)
    return (row.formula.name, value.shown, enclosure, failure, trivial, vacuous, *ends)


def _record(row: Row) -> dict[str, Any]:
    record: dict[str, Any] = {
        "name": row.formula.name,
        "title": row.formula.title,
        "group": row.formula.group,
        "status": row.formula.status,
        "source": row.formula.source,
        "filled_in": {item.name: item.assumes for item in row.filled},
    }
    if row.value is None:
        return record | {"estimate": row.estimate, "problem": row.problem or None}
    value = row.value
    return record | {
        "lower": _finite(value.enclosure.lower),
        "upper": _finite(value.enclosure.upper),
        "trivial": None if value.trivial is None else _finite(value.trivial.upper),
        "vacuous": value.vacuous,
        "failure": [_finite(value.failure.lower), _finite(value.failure.upper)],
        "certified": value.certified,
        "parameters": {name: show(number) for name, number in value.parameters.items()},
        "terms": {name: [_finite(term.lower), _finite(term.upper)] for name, term in value.terms.items()},
        "words": value.words,
    }


def _finite(value: float) -> float | None:
    """JSON has no infinity; an end that is not known is null."""
    return value if math.isfinite(value) else None


def _latex(rows: list[Row]) -> str:
    if not rows:
        raise InputError(
            "no bound is determined by these parameters; add some, e.g. --S 5 --A 4 --H 8 --n 2 --delta 0.05"
        )
    lines = []
    for row in rows:
        status, comment = row.formula.status, row.formula.name + filled_in_words(row.filled)
        if row.value:
            sign = r"\geq" if row.value.bound.from_below else r"\leq"
            shown = f" {sign} {row.value.shown}" if math.isfinite(row.value.enclosure.upper) else ""
            failing = "" if row.value.certified else ", not certified"
        else:
            shown = "" if row.estimate is None else rf" \approx {row.estimate:.6g}"
            failing = ""
        lines.append(rf"  {row.formula.latex()}{shown} &\quad\text{{{status}{failing}}} % {comment}")
    return "\n".join([r"\begin{align*}", " \\\\\n".join(_break(line) for line in lines), r"\end{align*}"])


def _break(line: str) -> str:
    # the comment has to come after the row's end
    formula, _, comment = line.partition(" % ")
    return f"  % {comment}\n{formula}"
