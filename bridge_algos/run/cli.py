"""``bridge-rl run``: an environment name in, results, a table and figures out."""

from __future__ import annotations

import argparse
import json
from dataclasses import fields
from pathlib import Path
from typing import Any

from bridge_algos.envs.registry import mdp_names
from bridge_algos.run.config import ALGORITHMS, PRESETS, RunConfig, preset
from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError


def parser() -> argparse.ArgumentParser:
    """The options of ``bridge-rl run``."""
    p = Parser(prog="bridge-rl run", description="Run BRIDGE, PbRL and BC on a tabular environment.")
    p.add_argument("environment", help=f"one of {', '.join(mdp_names())}, or an MDP's .npz file")
    add_options(p)
    p.add_argument("--show-config", action="store_true", help="print the configuration as JSON and stop")
    return p


def add_options(p: argparse.ArgumentParser) -> None:
    """The options that describe a run, all but its environment; :func:`configuration` reads them."""
    p.add_argument("--preset", default="published", help=f"one of {', '.join(PRESETS)} (default published)")
    p.add_argument("--seeds", type=int, default=30, help="number of seeds, 0..SEEDS-1 (default 30)")
    p.add_argument("--rounds", type=int, help="online rounds T (default: the preset's)")
    p.add_argument("--algorithms", help=f"comma-separated, of {', '.join(ALGORITHMS)} (default bridge,pbrl,bc)")
    p.add_argument("--fit", help="exact or adam: how the preference weights are fitted (default: the preset's)")
    p.add_argument("--features", choices=("exact", "sampled"), help="sampled: 100 rollouts a policy, as in the paper")
    p.add_argument("--demos", metavar="FILE", help="demonstrations (.npz) that every seed uses instead of the expert's")
    p.add_argument("--radius", help="of the offline set: a number, stated, repaired or zero (default: the preset's)")
    p.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="any other entry of the configuration"
    )
    p.add_argument("--jobs", type=int, default=-1, help="processes (default: all cores); does not change the numbers")
    p.add_argument("--out", type=Path, help="results directory (default out/ENVIRONMENT-PRESET)")
    p.add_argument("--log", action="store_true", help="keep each seed's log, which 'bridge-rl verify' checks")


def main(argv: list[str]) -> int:
    """Run, print the table, write the figures; finished seeds are kept and skipped on the next call."""
    options = parser().parse_args(argv)
    config = configuration(options)
    if options.show_config:
        print(json.dumps(json.loads(config.to_json()), indent=2))
        return 0
    from bridge_algos.run import plots
    from bridge_algos.run.runner import run
    from bridge_algos.run.summary import table

    directory = options.out or Path("out") / f"{Path(options.environment).stem}-{options.preset}"
    results = run(config, directory, options.seeds, options.jobs, log=options.log)
    print(table(results))
    paths = plots.save(plots.figure(results), directory / "regret")
    print("\nfigures: " + ", ".join(str(path) for path in paths))
    return 0


def configuration(options: argparse.Namespace) -> RunConfig:
    """The configuration that parsed options describe; ``options.environment`` names the environment."""
    from bridge_algos.run.world import digest

    changes: dict[str, Any] = dict(_assignment(text) for text in options.set)
    if options.rounds is not None:
        changes["rounds"] = options.rounds
    if options.algorithms is not None:
        changes["algorithms"] = tuple(options.algorithms.split(","))
    if options.demos is not None:
        changes |= {"demonstrations": options.demos, "demonstrations_digest": digest(options.demos)}
    if options.fit is not None:
        changes["fit"] = options.fit
    if options.features is not None:
        changes["rollouts"] = 100 if options.features == "sampled" else None
    if options.radius is not None:
        changes["radius"] = _number_or_text(options.radius)
    return preset(options.preset, options.environment).but(**changes)


def _assignment(text: str) -> tuple[str, Any]:
    name, sign, value = text.partition("=")
    known = [f.name for f in fields(RunConfig) if f.name != "environment"]
    if not sign or name not in known:
        raise InputError(f"--set {text!r} is not NAME=VALUE with NAME one of {', '.join(known)}.")
    return name, _number_or_text(value)


def _number_or_text(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text
