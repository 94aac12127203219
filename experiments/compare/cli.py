"""``bridge-rl compare``: stored runs, or an environment, beside every version of the theory."""

from __future__ import annotations

import argparse
import json
import textwrap
from pathlib import Path

from bridge_algos.envs.counterexamples import is_counterexample
from bridge_algos.envs.registry import mdp_names
from bridge_algos.files import atomic_write_text
from bridge_algos.run import cli as run_cli
from bridge_algos.run.config import PRESETS
from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError
from experiments.compare.subject import COMPARED, compared_algorithms


def main(argv: list[str]) -> int:
    """Compare; print tables and sentences; write ``compare.png``, ``.pdf``, ``.txt`` and ``.json``."""
    options = _parser().parse_args(argv)
    directories = _stored_runs(options.what)
    if directories is None:
        directories = [_run(options)]
        out = directories[0]
    else:
        _refuse_run_options(argv)
        out = options.out or (directories[0] if len(directories) == 1 else Path("out") / "compare")
    from bridge_algos.run import plots
    from experiments.compare import compare, figure, table, words
    from experiments.compare.record import record

    comparisons = [comparison for directory in directories for comparison in compare(directory, options.jobs)]
    text = "\n\n".join(
        f"{table(found)}\n\n{textwrap.fill(words(found), 120, break_long_words=False, break_on_hyphens=False)}"
        for found in comparisons
    )
    print(text)
    atomic_write_text(out / "compare.txt", text + "\n")
    atomic_write_text(out / "compare.json", json.dumps([record(found) for found in comparisons], indent=2) + "\n")
    paths = plots.save(figure(comparisons), out / "compare")
    print("\nfigures: " + ", ".join(str(path) for path in paths))
    return 0


def _parser() -> argparse.ArgumentParser:
    p = Parser(prog="bridge-rl compare", description="Empirical regret beside every version of the theory.")
    p.add_argument(
        "what",
        nargs="+",
        metavar="RUN_OR_ENVIRONMENT",
        help=f"directories of stored runs; or an environment, which is run first: one of {', '.join(mdp_names())}, or "
        "an MDP's .npz file, with the options of 'bridge-rl run'",
    )
    p.add_argument(
        "--preset", help=f"one of {', '.join(PRESETS)} (default: theory; counterexample for a counterexample)"
    )
    p.add_argument("--seeds", type=int, help="number of seeds, 0..SEEDS-1 (default 30; 1 for a counterexample)")
    p.add_argument("--algorithms", help=f"comma-separated; {' and '.join(COMPARED)} are compared (default both)")
    run_cli.add_options(p)
    p.add_argument("--out", type=Path, help="where to write (default: the run; out/compare for several runs)")
    return p


def _stored_runs(what: list[str]) -> list[Path] | None:
    """The directories, or None for one environment."""
    paths = [Path(text) for text in what]
    if all((path / "configuration.json").exists() for path in paths):
        return paths
    if len(what) == 1 and not paths[0].is_dir():
        return None
    wrong = next(str(path) for path in paths if not (path / "configuration.json").exists())
    raise InputError(
        f"{wrong} is not the directory of a run; give directories that 'bridge-rl run --out' wrote, or one environment."
    )


def _refuse_run_options(argv: list[str]) -> None:
    given = [text for text in argv if text.startswith("--") and not text.startswith(("--out", "--jobs"))]
    if given:
        raise InputError(
            f"{given[0].split('=')[0]} belongs to a run that is made here; stored runs take --out and --jobs only."
        )


def _run(options: argparse.Namespace) -> Path:
    """Run an environment, or find its finished seeds; by default with both algorithms, and one seed if one is all."""
    from bridge_algos.run.runner import run
    from bridge_algos.run.world import build_world

    options.environment = options.what[0]
    counterexample = is_counterexample(options.environment)
    if options.preset is None:
        options.preset = "counterexample" if counterexample else "theory"
    if options.seeds is None:
        options.seeds = 1 if options.preset == "counterexample" else 30
    if options.algorithms is None and options.preset != "counterexample":
        options.algorithms = ",".join(COMPARED)
    config = run_cli.configuration(options)
    compared_algorithms(config, build_world(config))  # what cannot be compared is refused before it is run
    own_preset = "" if options.preset == "counterexample" else f"-{options.preset}"
    directory = options.out or Path("out") / f"compare-{Path(options.environment).stem}{own_preset}"
    run(config, directory, options.seeds, options.jobs, log=True)
    return directory
