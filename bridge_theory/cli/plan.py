"""``bridge-rl plan``: how many demonstrations or preference queries a target needs under each version of the theory."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from bridge_theory.bound import Bound
from bridge_theory.cli.figure import Curve, draw
from bridge_theory.cli.options import Parser, add_parameters, flag, setting_from
from bridge_theory.cli.rows import filled_in
from bridge_theory.cli.table import text_table
from bridge_theory.cli.versions import RADIUS, REGRET
from bridge_theory.defaults import missing
from bridge_theory.errors import InputError
from bridge_theory.parameters import Stored, show, to_exact
from bridge_theory.regret.unknown_repaired import regret_unknown_version_space
from bridge_theory.setting import Setting
from bridge_theory.solution import Solution
from bridge_theory.solve import solve_for

_QUERIES = tuple(round(10 ** (exponent / 8)) for exponent in range(8, 57))  # T from 10 to 10^7
_TABLE_STEP = 8
_REGRET = (*REGRET, regret_unknown_version_space)  # answers T at a given n

Answer: TypeAlias = tuple[Bound, Solution | str]
"""A bound with its solution, or with the reason why it is left out."""


def main(argv: list[str]) -> int:
    """Run ``bridge-rl plan``. Returns 0. Errors: ``InputError`` for a user's mistake.

    >>> main(["--target-radius", "0.9", "--S", "5", "--A", "4", "--H", "8", "--delta", "0.05", "--gamma-min", "0.1"])
    demonstrations n for a radius of at most 0.9
      bound                          status    n       certified there        certified one short    may fail with
      offline_radius                 stated    182831  <= 0.8999998510618952  >= 0.9000024755685818  0.05
      offline_radius_repaired        repaired  934     <= 0.8997635952189065  >= 0.9001893099107383  0.05
      offline_radius_repaired_angle  sharp     621     <= 0.8997155540099747  >= 0.9000895941454229  0.05
      filled in: rows = 5 (S: a deterministic stationary expert uses one action in each state)
    0
    """
    arguments = _parser().parse_args(argv)
    setting = setting_from(arguments)
    if arguments.target_radius is None and arguments.target_regret is None:
        raise InputError("plan needs a target; write --target-radius 0.9 or --target-regret 100")
    records: list[dict[str, Any]] = []
    blocks: list[str] = []
    if arguments.target_radius is not None:
        _check_target("--target-radius", arguments.target_radius)
        answers = _answers(RADIUS, "n", arguments.target_radius, setting)
        records += [_record(answer, "n", setting) for answer in answers]
        heading = f"demonstrations n for a radius of at most {arguments.target_radius}"
        blocks.append(f"{heading}\n{_certified(answers, 'n')}")
    if arguments.target_regret is not None:
        _check_target("--target-regret", arguments.target_regret)
        text, regret = _regret(arguments.target_regret, setting, Path(arguments.figure))
        records += regret
        blocks.append(text)
    print(json.dumps(records, indent=2, allow_nan=False) if arguments.json else "\n\n".join(blocks))
    return 0


def _parser() -> Parser:
    parser = Parser(prog="bridge-rl plan", description=(__doc__ or "").strip(), allow_abbrev=False)
    parser.add_argument("--target-radius", metavar="R", help="offline radius to reach")
    parser.add_argument("--target-regret", metavar="X", help="regret to stay below")
    parser.add_argument("--figure", metavar="FILE", default="plan.png", help="where the trade-off is drawn")
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_parameters(parser)
    return parser


def _check_target(name: str, target: str) -> None:
    if to_exact(name, target) < 0:
        raise InputError(f"{name} {target} is negative, which no bound can reach; give a number from 0 on")


def _answers(bounds: Sequence[Bound], name: str, target: str, setting: Setting) -> list[Answer]:
    others = Setting(**{key: value for key, value in setting.items() if key != name})
    answers = [(bound, _answer(bound, name, target, others)) for bound in bounds]
    lacking = dict.fromkeys(flag(other) for bound in bounds for other in _missing(bound, name, others))
    if lacking and all(isinstance(answer, str) for _, answer in answers):
        raise InputError(f"solving for {name} needs more of the problem; add {' '.join(lacking)}")
    return answers


def _answer(bound: Bound, name: str, target: str, others: Setting) -> Solution | str:
    # more demonstrations must help and more queries must cost, or there is nothing to plan
    if not _plannable(bound, name):
        move = bound.monotone.get(name)
        return f"not known to be monotone in {name}" if move is None else f"{move.direction} in {name}: {move.because}"
    lacking = _missing(bound, name, others)
    if lacking:
        return f"needs {' '.join(map(flag, lacking))}"
    try:
        solution = solve_for(name, bound, target, setting=others)
    except InputError as error:  # the statement's own conditions refuse these parameters, not those of the others
        return str(error)
    there = solution.at_value
    if there is None or there.certified:
        return solution
    return f"nothing is certified: its events may fail with a total probability of {there.failure.at_most}"


def _plannable(bound: Bound, name: str) -> bool:
    return name in bound.monotone and bound.monotone[name].direction == {"n": "falls", "T": "rises"}[name]


def _missing(bound: Bound, name: str, others: Setting) -> tuple[str, ...]:
    return missing(bound, others, varied=name) if _plannable(bound, name) else ()


def _certified(answers: Sequence[Answer], name: str) -> str:
    rows = []
    for bound, answer in answers:
        if isinstance(answer, str):
            rows.append((bound.name, bound.status, "-", answer, "-", "-"))
            continue
        meets = answer.reason if answer.meets is None else f"<= {answer.meets.upper!r}"
        fails = f">= {answer.fails.lower!r}" if answer.fails is not None and answer.meets is not None else "-"
        chance = "-" if answer.at_value is None else answer.at_value.failure.at_most
        rows.append((bound.name, bound.status, _short(answer), meets, fails, chance))
    table = text_table(("bound", "status", name, "certified there", "certified one short", "may fail with"), rows)
    return table + _filled_in(answers)


def _filled_in(answers: Sequence[Answer]) -> str:
    lines = filled_in((bound.name, answer.filled) for bound, answer in answers if isinstance(answer, Solution))
    return "".join(f"\n  filled in: {line}" for line in lines)


def _regret(target: str, setting: Setting, path: Path) -> tuple[str, list[dict[str, Any]]]:
    """The trade-off between n and T for one regret, and the answers at the T or n that is given."""
    blocks, records = [], []
    for name, other in (("n", "T"), ("T", "n")):
        if other in setting:
            answers = _answers(_REGRET, name, target, setting)
            records += [_record(answer, name, setting) for answer in answers]
            kind = "demonstrations" if name == "n" else "preference queries"
            heading = f"{kind} {name} for a regret of at most {target} at {other} = {show(setting[other])}"
            blocks.append(f"{heading}\n{_certified(answers, name)}")
    curves = {T: _answers(_REGRET, "n", target, setting.replace(T=T)) for T in _QUERIES}
    records += [_record(answer, "n", setting.replace(T=T)) for T, answers in curves.items() for answer in answers]
    columns = [i for i in range(len(_REGRET)) if any(not isinstance(answers[i][1], str) for answers in curves.values())]
    rows = [(str(T), *(_short(curves[T][i][1]) for i in columns)) for T in _QUERIES[::_TABLE_STEP]]
    table = text_table(("T", *(f"{_REGRET[i].name} ({_REGRET[i].status})" for i in columns)), rows)
    left_out = [f"left out: {b.name}: {a}\n" for i, (b, a) in enumerate(curves[_QUERIES[0]]) if i not in columns]
    drawn = _draw_tradeoff(path, curves, target)
    blocks.append(
        f"trade-off: demonstrations n for a regret of at most {target}\n{table}\n{''.join(left_out)}figure: {drawn}"
    )
    return "\n\n".join(blocks), records


def _short(answer: Solution | str) -> str:
    if isinstance(answer, str):
        return "-"
    if answer.status == "never":
        return "none" if answer.name == "T" or answer.beyond is None else f"> {show(answer.beyond)}"
    if answer.value is None:
        return "undecided"
    if answer.status == "undecided" or (answer.status == "always" and answer.name == "T"):
        return f"{'<=' if answer.name == 'n' else '>='} {show(answer.value)}"
    return show(answer.value)


def _draw_tradeoff(path: Path, curves: dict[int, list[Answer]], target: str) -> str:
    lines = []
    for position, bound in enumerate(_REGRET):
        column = [(T, answers[position][1]) for T, answers in curves.items()]
        found = [(float(T), float(a.value)) for T, a in column if isinstance(a, Solution) and a.value is not None]
        if found:
            x, y = np.array(found).T
            lines.append(Curve(f"{bound.name} ({bound.status})", bound.status, x, y))
    if not lines:
        return "none is drawn, no bound reaches the target"
    draw(
        path,
        lines,
        x_label="T: online preference queries",
        y_label="n: demonstrations needed",
        title=f"smallest n with regret at most {show(to_exact('target', target))}",
        log_x=True,
        log_y=True,
    )
    return str(path)


def _record(answer: Answer, name: str, setting: Setting) -> dict[str, Any]:
    bound, solution = answer
    row: dict[str, Any] = {"bound": bound.name, "status": bound.status, "parameter": name}
    if isinstance(solution, str):
        nothing = dict.fromkeys(("value", "meets", "fails", "failure"))
        return row | {"answer": "left out", **nothing, "others": _shown(setting, name), "reason": solution}
    return row | {
        "answer": solution.status,
        "value": None if solution.value is None else show(solution.value),
        "meets": None if solution.meets is None else [solution.meets.lower, solution.meets.upper],
        "fails": None if solution.fails is None else [solution.fails.lower, solution.fails.upper],
        "failure": None if solution.at_value is None else solution.at_value.failure.upper,
        "filled_in": {item.name: item.assumes for item in solution.filled},
        "others": _shown(solution.others, name),
        "reason": solution.reason,
    }


def _shown(values: Mapping[str, Stored], name: str) -> dict[str, str]:
    return {other: show(value) for other, value in values.items() if other != name}
