"""``bridge-rl ask``: how many answers certify a recommendation, with a simulated teacher."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from bridge_algos.asking.config import DYNAMICS, AskConfig
from bridge_algos.asking.goal import FORMS
from bridge_algos.asking.rules import RULES
from bridge_algos.asking.tabular import REFERENCES
from bridge_algos.asking.utility import ADDITIVE
from bridge_algos.envs.registry import mdp_names
from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError


def main(argv: list[str]) -> int:
    """Ask, print what was certified; status 0 also where nothing is certified, which is said in words."""
    options = _parser().parse_args(argv)
    config = _configuration(options)
    if options.model == "none":
        return _without_model(options, config)
    from bridge_algos.asking.study import run_study, summary

    directory = options.out or Path("out") / f"ask-{Path(config.environment).stem}"
    outcomes = run_study(config, directory, options.seeds, options.jobs)
    found = summary(outcomes)
    if options.json:
        print(json.dumps(found, indent=2))
        return 0
    print(table(outcomes))
    print()
    print(in_words(config, found))
    print(f"sessions: {directory}; check them with 'bridge-rl verify {directory}'")
    return 0


def _without_model(options: argparse.Namespace, config: AskConfig) -> int:
    """Ask without a model of utility, and print what was certified."""
    from bridge_algos.asking.no_model_report import in_words, summary, table
    from bridge_algos.asking.no_model_study import run_no_model

    directory = options.out or Path("out") / f"ask-{Path(config.environment).stem}-no-model"
    outcomes = run_no_model(config, options.eps, directory, options.seeds, options.jobs)
    found = summary(outcomes)
    if options.json:
        print(json.dumps(found, indent=2))
        return 0
    print(f"{table(outcomes)}\n\n{in_words(config, options.eps, found)}\nsessions: {directory}")
    return 0


def table(outcomes: list[dict[str, Any]]) -> str:
    """One line a seed."""
    lines = [f"{'seed':>4} {'questions':>9} {'gap <=':>8} {'true gap':>8} {'covered':>7} {'candidates':>10}"]
    for row in outcomes:
        asked = "-" if row["questions"] is None else str(row["questions"])
        asked = "refuted" if row.get("contradicted") else asked
        covered = "yes" if row["covered"] else "no"
        lines.append(
            f"{row['seed']:>4} {asked:>9} {row['certified_gap']:>8.3f} {row['true_gap']:>8.3f} {covered:>7} "
            f"{row['candidates']:>10}"
        )
    return "\n".join(lines)


def in_words(config: AskConfig, found: dict[str, Any]) -> str:
    """The summary in sentences."""
    total = len(found["seeds"])
    median = found["median_questions"]
    asked = f"more than {config.max_questions}" if median is None else f"{median:.0f}"
    sentence = f"{found['certified']} of {total} sessions are certified; the median needs {asked} questions"
    if found["quantile_90"] is not None:
        sentence += f", 90 % need at most {found['quantile_90']:.0f}"
    if found["contradicted"]:
        sentence += f". In {found['contradicted']} the answers contradict the model, and nothing is certified"
    single = found["seeds_with_one_candidate"]
    if single:
        rest = found["median_where_something_is_open"]
        sentence += f". In {single} the demonstrations leave one candidate and nothing to ask"
        if rest is not None:
            sentence += f"; the median of the others is {rest:.0f}"
    if found["median_episodes"] is not None:
        sentence += f". Features come from rollouts, {found['median_episodes']:,.0f} episodes in the median"
    return sentence + "."


def _parser() -> argparse.ArgumentParser:
    p = Parser(prog="bridge-rl ask", description="Ask preference questions until the answers certify a policy.")
    p.add_argument("environment", help=f"one of {', '.join(mdp_names())}, or an MDP's .npz file")
    p.add_argument("--teacher", default="simulated", choices=("simulated",), help="who answers (default simulated)")
    p.add_argument(
        "--range", type=float, metavar="NATS", help="best minus worst utility (default 5); then W = 2 ||w*||"
    )
    p.add_argument("--BW", type=float, metavar="X", help="instead of --range: B W = X, with ||w*|| = W")
    p.add_argument(
        "--until",
        default="10%",
        help=f"when to stop: {FORMS.replace('%', '%%')} (default 10%%)",
    )
    p.add_argument(
        "--model",
        default="linear",
        choices=("linear", "none"),
        help="linear utilities and logistic answers (default), or none: compare every pair of few candidates",
    )
    p.add_argument("--eps", type=float, help="with --model none: preferred with probability >= 1/2 - eps (default 0.1)")
    p.add_argument("--delta", type=float, default=0.05, help="failure probability of a session (default 0.05)")
    p.add_argument("--demonstrations", type=int, metavar="N", help="by the best stationary policy (default 2)")
    p.add_argument("--demos", metavar="FILE", help="demonstrations (.npz) that every seed uses instead")
    p.add_argument("--embedding", default="state_action_counts", help=f"one of {', '.join(ADDITIVE)}")
    p.add_argument("--asking", default="pool", help=f"which questions: {', '.join(RULES)} (default pool)")
    p.add_argument(
        "--dynamics", default="known", choices=DYNAMICS, help="unknown: only simulated, by rollouts (default known)"
    )
    p.add_argument("--reference", default="random", help=f"for shares: {', '.join(REFERENCES)} (default random)")
    p.add_argument("--seeds", type=int, default=20, help="number of sessions (default 20)")
    p.add_argument(
        "--max-questions", type=int, metavar="N", help="end a session here (default 1000; 10000 without a model)"
    )
    p.add_argument("--out", type=Path, help="directory of the sessions (default out/ask-ENVIRONMENT)")
    p.add_argument("--jobs", type=int, default=-1, help="processes (default: all cores); does not change the numbers")
    p.add_argument("--json", action="store_true", help="print JSON")
    return p


def _configuration(options: argparse.Namespace) -> AskConfig:
    if options.demos is not None and options.demonstrations is not None:
        raise InputError("--demos and --demonstrations exclude each other; give one.")
    if options.range is not None and options.BW is not None:
        raise InputError("--range and --BW exclude each other; give one.")
    _check_model(options)
    given = options.demonstrations
    return AskConfig(
        environment=options.environment,
        embedding=options.embedding,
        utility_range=None if options.BW is not None else 5.0 if options.range is None else options.range,
        weight_norm=options.BW,
        until=options.until,
        delta=options.delta,
        n_demonstrations=0 if options.demos is not None else 2 if given is None else given,
        demonstrations=options.demos,
        asking=options.asking,
        reference=options.reference,
        max_questions=options.max_questions,
        dynamics=options.dynamics,
    )


def _check_model(options: argparse.Namespace) -> None:
    """Refuse options of the other model, and fill in what depends on the model."""
    without = options.model == "none"
    if not without and options.eps is not None:
        raise InputError("--eps belongs to --model none; say with --until when to stop.")
    for name, default in (("until", "10%"), ("asking", "pool"), ("reference", "random")):
        if without and getattr(options, name) != default:
            raise InputError(f"--{name} needs a model of utility; with --model none say --eps, and leave it out.")
    if without and options.dynamics != "known":
        raise InputError("--dynamics needs a model of utility; leave it out with --model none.")
    if options.eps is None:
        options.eps = 0.1
    if options.max_questions is None:
        options.max_questions = 10_000 if without else 1000
