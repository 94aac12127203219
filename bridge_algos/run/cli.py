"""``bridge-rl run``: an environment name in, results, a table and figures out."""

from __future__ import annotations

import argparse
import json
from dataclasses import fields
from pathlib import Path
from typing import Any

from bridge_algos.continuous.config import SHORT_NAMES, ContinuousConfig, continuous_preset, is_continuous
from bridge_algos.envs.registry import mdp_names
from bridge_algos.online.loop import FITS
from bridge_algos.run.config import PRESETS, RADII, RunConfig, preset
from bridge_algos.run.configuration import ALGORITHMS, Configuration
from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError


def parser() -> argparse.ArgumentParser:
    """The options of ``bridge-rl run``."""
    p = Parser(prog="bridge-rl run", description="Run BRIDGE, PbRL and BC on an environment.")
    names = (*mdp_names(), *SHORT_NAMES)
    p.add_argument("environment", help=f"one of {', '.join(names)}, an MDP's .npz file, or a MuJoCo environment's id")
    p.add_argument("--preset", default="published", help=f"one of {', '.join(PRESETS)} (default published)")
    p.add_argument("--seeds", type=int, help="number of seeds, 0..SEEDS-1 (default 30; MuJoCo 20)")
    p.add_argument("--algorithms", help=f"comma-separated, of {', '.join(ALGORITHMS)} (default bridge,pbrl,bc)")
    add_options(p)
    p.add_argument("--out", type=Path, help="results directory (default out/ENVIRONMENT-PRESET)")
    p.add_argument("--log", action="store_true", help="keep each seed's log, which 'bridge-rl verify' checks")
    p.add_argument("--expert", metavar="FILE", help="MuJoCo: the expert's file (default: reacher-zoo or ant, shipped)")
    p.add_argument("--include-expert", action="store_true", help="MuJoCo: search the expert too, as published")
    p.add_argument("--show-config", action="store_true", help="print the configuration as JSON and stop")
    return p


def add_options(p: argparse.ArgumentParser) -> None:
    """The options that change a preset, whoever makes the run; :func:`configuration` reads them."""
    p.add_argument("--rounds", type=int, help="online rounds T (default: the preset's)")
    p.add_argument("--fit", help=f"one of {', '.join(FITS)}: how preference weights are fitted (default: the preset's)")
    p.add_argument("--features", choices=("exact", "sampled"), help="sampled: 100 rollouts a policy, as in the paper")
    p.add_argument("--demos", metavar="FILE", help="demonstrations (.npz) that every seed uses instead of the expert's")
    p.add_argument("--radius", help=f"of the offline set: a number or {', '.join(RADII)} (default: the preset's)")
    p.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="any other entry of the configuration"
    )
    p.add_argument("--jobs", type=int, default=-1, help="processes (default: all cores); does not change the numbers")


def main(argv: list[str]) -> int:
    """Run, print the table, write the figures; finished seeds are kept and skipped on the next call."""
    options = parser().parse_args(argv)
    continuous = is_continuous(options.environment)
    if not continuous and (options.expert or options.include_expert):
        raise InputError(f"--expert and --include-expert are for MuJoCo; {options.environment} computes its expert.")
    config = _continuous_configuration(options) if continuous else configuration(options)
    if options.show_config:
        print(json.dumps(json.loads(config.to_json()), indent=2))
        return 0
    from bridge_algos.run import plots
    from bridge_algos.run.runner import run
    from bridge_algos.run.summary import table

    directory = options.out or Path("out") / f"{Path(options.environment).stem}-{options.preset}"
    seeds = options.seeds if options.seeds is not None else 20 if continuous else 30
    results = run(config, directory, seeds, options.jobs, log=options.log)
    print(table(results))
    paths = plots.save(plots.figure(results), directory / "regret")
    print("\nfigures: " + ", ".join(str(path) for path in paths))
    return 0


def configuration(options: argparse.Namespace) -> RunConfig:
    """The tabular configuration that parsed options describe; ``options.environment`` names the environment."""
    from bridge_algos.run.world import digest

    base = preset(options.preset, options.environment)
    changes = _changes(options, base)
    if options.environment.endswith(".npz") and Path(options.environment).is_file():
        changes["environment_digest"] = digest(options.environment)
    if options.demos is not None:
        changes |= {"demonstrations": options.demos, "demonstrations_digest": digest(options.demos)}
    if options.features is not None:
        changes["rollouts"] = 100 if options.features == "sampled" else None
    return base.but(**changes)


def _continuous_configuration(options: argparse.Namespace) -> ContinuousConfig:
    base = continuous_preset(options.preset, options.environment)
    changes = _changes(options, base)
    if options.features is not None:
        raise InputError("--features does not apply to MuJoCo, where all are sampled; use --set rollouts=NUMBER.")
    if options.expert:
        changes["expert"] = options.expert
    if options.include_expert:
        changes["include_expert"] = True
    if options.demos is not None:
        changes["demonstrations"] = options.demos
    return base.but(**changes)


def _changes(options: argparse.Namespace, base: Configuration) -> dict[str, Any]:
    """What the options that both kinds of configuration have change in ``base``."""
    changes: dict[str, Any] = dict(_assignment(text, base) for text in options.set)
    if options.rounds is not None:
        changes["rounds"] = options.rounds
    if options.algorithms is not None:
        changes["algorithms"] = tuple(options.algorithms.split(","))
    if options.fit is not None:
        changes["fit"] = options.fit
    if options.radius is not None:
        changes["radius"] = _number_or_text(options.radius)
    return changes


def _assignment(text: str, base: Configuration) -> tuple[str, Any]:
    name, sign, value = text.partition("=")
    known = [f.name for f in fields(base) if f.name != "environment"]
    if not sign or name not in known:
        raise InputError(f"--set {text!r} is not NAME=VALUE with NAME one of {', '.join(known)}.")
    return name, _number_or_text(value)


def _number_or_text(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text
