"""``bridge-rl plan``: how many demonstrations and questions a target needs, by simulation or by the theory's bounds.

With an environment the asker of ``bridge-rl ask`` is simulated; without one the bounds are solved for their parameters
(:mod:`bridge_theory.cli.plan`).
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.goal import goal
from bridge_algos.asking.rules import RULES
from bridge_algos.asking.utility import ADDITIVE
from bridge_algos.envs.registry import mdp_names
from bridge_theory.cli import plan as theory
from bridge_theory.cli.options import Parser
from bridge_theory.cli.table import text_table
from bridge_theory.errors import InputError
from experiments.asked import Asked, asked, count_text, draw_axes, draw_medians, interval_text

FLAGS = ("--json", "--help", "-h")
"""Options that take no value."""


def main(argv: list[str]) -> int:
    """Plan by simulation where an environment is named, else by the bounds of the theory."""
    if not argv:
        raise InputError(
            "plan needs an environment, as in 'bridge-rl plan starmdp --until 10% --range 5', or a target of the "
            "theory, --target-radius 0.9 or --target-regret 100."
        )
    if argv[0] in ("-h", "--help"):
        print(_parser().format_help() + "\nwithout an environment, by the bounds of the theory:\n")
    return simulate(argv) if names_environment(argv) else theory.main(argv)


def names_environment(argv: list[str]) -> bool:
    """Whether some argument is neither an option nor an option's value.

    >>> names_environment(["--until", "10%", "starmdp"]), names_environment(["--target-radius", "0.9", "--json"])
    (True, False)
    """
    value = False
    for word in argv:
        if value:
            value = False
        elif word.startswith("-"):
            value = "=" not in word and word not in FLAGS
        else:
            return True
    return False


def simulate(argv: list[str]) -> int:
    """Simulate sessions for each number of demonstrations; finished ones are kept, so that a killed plan continues."""
    options = _parser().parse_args(argv)
    counts = _counts(options.demonstrations)
    configs = {n: _configuration(options, n) for n in counts}
    if options.seeds < 1:
        raise InputError(f"--seeds must be at least 1, got {options.seeds}.")
    from bridge_algos.asking.study import prepare, run_study

    _, utility, _ = prepare(configs[counts[0]])
    directory = options.out or Path("out") / f"plan-{Path(options.environment).stem}"
    sessions: dict[int, list[dict[str, Any]]] = {}
    found: dict[int, Asked] = {}
    for n in counts[::-1]:  # fewer demonstrations leave more candidates, and the longest sessions
        rows = run_study(configs[n], directory / f"demonstrations-{n}", options.seeds, options.jobs)
        sessions, found = {n: rows, **sessions}, {n: asked([row["questions"] for row in rows]), **found}
        print(f"{_answer(n, found[n], options.max_questions)}, kept in {directory}", file=sys.stderr)
    config = configs[counts[0]]
    paths = _draw(config, found, sessions, directory)
    if options.json:
        print(json.dumps(_record(config, found, sessions, paths), indent=2, allow_nan=False))
        return 0
    print(f"{sentence(config, found)}\n\n{_table(config, found, sessions)}\n\n{_rests_on(config, utility, sessions)}")
    print(f"figures: {', '.join(str(path) for path in paths)}")
    return 0


def sentence(config: AskConfig, found: dict[int, Asked]) -> str:
    """The answer."""
    parts = [_answer(n, one, config.max_questions) for n, one in found.items()]
    each = next(iter(found.values())).sessions
    listed = parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
    return (
        f"Until {goal(config.until, config.utility_range).describe()}, {config.environment} needs this many questions "
        f"in the median session: {listed} (in brackets the 95 % interval of the median, from order statistics of "
        f"{each} simulated session{'' if each == 1 else 's'} for each number)."
    )


def _answer(n: int, one: Asked, most: int) -> str:
    given = "without demonstrations" if n == 0 else f"with {n} demonstration{'' if n == 1 else 's'}"
    interval = f" ({interval_text(one, most)})" if one.low != one.high else ""
    return f"{count_text(one.median, most)}{interval} {given}"


def _table(config: AskConfig, found: dict[int, Asked], sessions: dict[int, list[dict[str, Any]]]) -> str:
    header = ("demonstrations", "median", "95 % interval", "90 % need at most", "certified", "one candidate")
    rows = []
    for n, one in found.items():
        alone = sum(row["candidates"] == 1 for row in sessions[n])
        median, most = (count_text(value, config.max_questions) for value in (one.median, one.ninetieth))
        interval = interval_text(one, config.max_questions)
        rows.append((str(n), median, interval, most, f"{one.certified} of {one.sessions}", str(alone)))
    return text_table(header, rows)


def _rests_on(config: AskConfig, utility: Any, sessions: dict[int, list[dict[str, Any]]]) -> str:
    missed = sum(not row["covered"] for rows in sessions.values() for row in rows)
    total = sum(len(rows) for rows in sessions.values())
    lines = [
        f"Simulated: a Bradley-Terry teacher of range {utility.utility_range:.4g} nats with W = "
        f"{utility.weight_bound:.4g}, demonstrations of the best stationary policy for its utility, {config.pool} "
        f"trajectories to ask about, rule {config.asking!r}, delta = {config.delta:g} for each session; the true "
        f"weights left the likelihood set in {missed} of {total} sessions. A session without a certificate after "
        f"{config.max_questions} questions counts as more than that."
    ]
    if utility.error:
        lines.append(
            f"The reward is not linear in {config.embedding}: the teacher's utility is a fit to it, with errors of up "
            f"to {utility.error:.1%} of the range."
        )
    if any(row["candidates"] == config.limit for rows in sessions.values() for row in rows):
        lines.append(f"Some sessions compare a sample of {config.limit} candidates, and their certificates say so.")
    return "\n".join(lines)


def _draw(
    config: AskConfig, found: dict[int, Asked], sessions: dict[int, list[dict[str, Any]]], directory: Path
) -> list[Path]:
    """The trade-off: a dot for each session, the medians and their intervals."""
    import numpy as np
    from matplotlib.figure import Figure

    from bridge_algos.run.plots import finish, save
    from experiments.asked import censored_level

    picture = Figure(figsize=(4.6, 3.4), layout="constrained")
    axes = picture.subplots()
    most = config.max_questions
    draw_axes(axes, list(found), most, config.until)
    for place, rows in enumerate(sessions.values()):
        y = [censored_level(most) if row["questions"] is None else row["questions"] for row in rows]
        spread = np.linspace(-0.25, 0.25, len(y)) if len(y) > 1 else np.zeros(1)
        label = "one session" if place == 0 else None
        axes.plot(place + spread, y, "o", color="#999999", markersize=2.5, alpha=0.7, label=label)
    style = {"color": "#0072B2", "label": "median, and 10 % to 90 %"}
    draw_medians(axes, range(len(found)), list(found.values()), most, style)
    each = next(iter(found.values())).sessions
    title = f"{Path(config.environment).stem}, range {config.utility_range:g} nats, {each} sessions for each number"
    axes.set_title(title, fontsize=9)
    finish(axes)
    return save(picture, directory / "plan")


def _record(
    config: AskConfig, found: dict[int, Asked], sessions: dict[int, list[dict[str, Any]]], paths: list[Path]
) -> dict[str, Any]:
    def finite(value: float) -> float | None:
        return value if value != float("inf") else None

    return {
        "sentence": sentence(config, found),
        "environment": config.environment,
        "until": config.until,
        "range": config.utility_range,
        "delta": config.delta,
        "max_questions": config.max_questions,
        "plan": [
            {
                "demonstrations": n,
                "median_questions": finite(one.median),
                "interval_95": [finite(one.low), finite(one.high)],
                "quantile_90": finite(one.ninetieth),
                "certified": one.certified,
                "sessions": one.sessions,
                "questions": [row["questions"] for row in sessions[n]],
            }
            for n, one in found.items()
        ],
        "figures": [str(path) for path in paths],
    }


def _parser() -> argparse.ArgumentParser:
    p = Parser(
        prog="bridge-rl plan",
        description="How many demonstrations and questions will I need? Simulated sessions of 'bridge-rl ask' answer.",
        allow_abbrev=False,
    )
    p.add_argument("environment", help=f"one of {', '.join(mdp_names())}, or an MDP's .npz file")
    p.add_argument("--until", default="10%", help="10%% of the range, 0.2nats, or share=90%% (default 10%%)")
    p.add_argument("--range", type=float, default=5.0, metavar="NATS", help="best minus worst utility (default 5)")
    p.add_argument("--demonstrations", default="0,1,2,4,8", metavar="N,...", help="numbers tried (default 0,1,2,4,8)")
    p.add_argument("--delta", type=float, default=0.05, help="failure probability of a session (default 0.05)")
    p.add_argument("--embedding", default="state_action_counts", help=f"one of {', '.join(ADDITIVE)}")
    p.add_argument("--asking", default="pool", help=f"which questions: {', '.join(RULES)} (default pool)")
    p.add_argument("--seeds", type=int, default=20, help="sessions for each number of demonstrations (default 20)")
    p.add_argument("--max-questions", type=int, default=200, metavar="N", help="end a session here (default 200)")
    p.add_argument("--out", type=Path, help="directory of sessions and figure (default out/plan-ENVIRONMENT)")
    p.add_argument("--jobs", type=int, default=-1, help="processes (default: all cores); does not change the numbers")
    p.add_argument("--json", action="store_true", help="print JSON")
    return p


def _counts(text: str) -> list[int]:
    words = text.split(",")
    if not all(word.strip().isascii() and word.strip().isdigit() for word in words):
        raise InputError(f"--demonstrations must be whole numbers with commas between, as in 0,1,2,4,8; got {text!r}.")
    return sorted({int(word) for word in words})


def _configuration(options: argparse.Namespace, n: int) -> AskConfig:
    if options.max_questions < 1:
        raise InputError(f"--max-questions must be at least 1, got {options.max_questions}.")
    return AskConfig(
        environment=options.environment,
        embedding=options.embedding,
        utility_range=options.range,
        until=options.until,
        delta=options.delta,
        n_demonstrations=n,
        asking=options.asking,
        max_questions=options.max_questions,
    )
