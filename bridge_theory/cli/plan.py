"""``bridge-rl plan``: how many demonstrations or preference queries a target needs under each version of the theory."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bridge_theory.bound import Bound
from bridge_theory.cli.figure import Curve, draw
from bridge_theory.cli.options import Parser, add_parameters, flag, setting_from
from bridge_theory.cli.rows import missing_from
from bridge_theory.cli.table import text_table
from bridge_theory.cli.versions import RADIUS, REGRET
from bridge_theory.errors import InputError
from bridge_theory.parameters import show, to_exact
from bridge_theory.setting import Setting
from bridge_theory.solution import Solution
from bridge_theory.solve import solve_for

_QUERIES = tuple(round(10 ** (exponent / 8)) for exponent in range(8, 57))  # T from 10 to 10^7
_TABLE_STEP = 8


def main(argv: list[str]) -> int:
    """Run ``bridge-rl plan``. Returns 0. Errors: ``InputError`` for a user's mistake.

    >>> main(["--target-radius", "0.9", "--S", "5", "--A", "4", "--H", "8", "--delta", "0.05", "--gamma-min", "0.1"])
    demonstrations n for a radius of at most 0.9
      bound                          status    n       certified there           certified one short
      offline_radius                 stated    184...
      offline_radius_repaired        repaired  93...
      offline_radius_repaired_angle  sharp     69...
    0
    """
    arguments = _parser().parse_args(argv)
    setting = setting_from(arguments)
    if arguments.target_radius is None and arguments.target_regret is None:
        raise InputError("plan needs a target; write --target-radius 0.9 or --target-regret 100")
    records: list[dict[str, Any]] = []
    blocks: list[str] = []
    if arguments.target_radius is not None:
        solutions = _solutions(RADIUS, "n", arguments.target_radius, setting)
        records += map(_record, solutions)
        blocks.append(f"demonstrations n for a radius of at most {arguments.target_radius}\n{_certified(solutions)}")
    if arguments.target_regret is not None:
        text, regret = _regret(arguments.target_regret, setting, Path(arguments.figure))
        records += regret
        blocks.append(text)
    print(json.dumps(records, indent=2) if arguments.json else "\n\n".join(blocks))
    return 0


def _parser() -> Parser:
    parser = Parser(prog="bridge-rl plan", description=(__doc__ or "").strip(), allow_abbrev=False)
    parser.add_argument("--target-radius", metavar="R", help="offline radius to reach")
    parser.add_argument("--target-regret", metavar="X", help="regret to stay below")
    parser.add_argument("--figure", metavar="FILE", default="plan.png", help="where the trade-off is drawn")
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_parameters(parser)
    return parser


def _solutions(bounds: Sequence[Bound], name: str, target: str, setting: Setting) -> list[Solution]:
    others = Setting(**{key: value for key, value in setting.items() if key != name})
    probe = others.replace(**{name: 1})
    # more demonstrations must help and more queries must cost, or there is nothing to plan
    wanted = {"n": "falls", "T": "rises"}[name]
    moving = [bound for bound in bounds if name in bound.monotone and bound.monotone[name].direction == wanted]
    usable = [bound for bound in moving if not missing_from(bound, probe)]
    if not usable:
        missing = dict.fromkeys(flag(other) for bound in moving for other in missing_from(bound, probe))
        raise InputError(f"solving for {name} needs more of the problem; add {' '.join(missing)}")
    return [solve_for(name, bound, target, setting=others) for bound in usable]


def _certified(solutions: Sequence[Solution]) -> str:
    rows = []
    for solution in solutions:
        value = "none" if solution.value is None else show(solution.value)
        meets = solution.reason if solution.meets is None else f"<= {solution.meets.upper!r}"
        fails = f">= {solution.fails.lower!r}" if solution.fails is not None and solution.meets is not None else "-"
        rows.append((solution.bound.name, solution.bound.status, value, meets, fails))
    return text_table(("bound", "status", solutions[0].name, "certified there", "certified one short"), rows)


def _regret(target: str, setting: Setting, path: Path) -> tuple[str, list[dict[str, Any]]]:
    """The trade-off between n and T for one regret, and the answers at the T or n that is given."""
    blocks, records = [], []
    for name, other in (("n", "T"), ("T", "n")):
        if other in setting:
            solutions = _solutions(REGRET, name, target, setting)
            records += [_record(solution) for solution in solutions]
            kind = "demonstrations" if name == "n" else "preference queries"
            heading = f"{kind} {name} for a regret of at most {target} at {other} = {show(setting[other])}"
            blocks.append(f"{heading}\n{_certified(solutions)}")
    curves = {T: _solutions(REGRET, "n", target, setting.replace(T=T)) for T in _QUERIES}
    records += [_record(solution) for solutions in curves.values() for solution in solutions]
    bounds = [solution.bound for solution in curves[_QUERIES[0]]]
    rows = [(str(T), *map(_short, curves[T])) for T in _QUERIES[::_TABLE_STEP]]
    table = text_table(("T", *(f"{bound.name} ({bound.status})" for bound in bounds)), rows)
    _draw_tradeoff(path, bounds, curves, target)
    blocks.append(f"trade-off: demonstrations n for a regret of at most {target}\n{table}\nfigure: {path}")
    return "\n\n".join(blocks), records


def _short(solution: Solution) -> str:
    return "none" if solution.value is None else show(solution.value)


def _draw_tradeoff(path: Path, bounds: Sequence[Bound], curves: dict[int, list[Solution]], target: str) -> None:
    lines = []
    for position, bound in enumerate(bounds):
        answers = [(T, solutions[position].value) for T, solutions in curves.items()]
        found = [(float(T), float(value)) for T, value in answers if value is not None]
        if found:
            x, y = np.array(found).T
            lines.append(Curve(f"{bound.name} ({bound.status})", bound.status, x, y))
    draw(
        path,
        lines,
        x_label="T: online preference queries",
        y_label="n: demonstrations needed",
        title=f"smallest n with regret at most {show(to_exact('target', target))}",
        log_x=True,
        log_y=True,
    )


def _record(solution: Solution) -> dict[str, Any]:
    return {
        "bound": solution.bound.name,
        "status": solution.bound.status,
        "parameter": solution.name,
        "answer": solution.status,
        "value": None if solution.value is None else show(solution.value),
        "meets": None if solution.meets is None else [solution.meets.lower, solution.meets.upper],
        "fails": None if solution.fails is None else [solution.fails.lower, solution.fails.upper],
        "others": {name: show(value) for name, value in solution.others.items()},
        "reason": solution.reason,
    }
