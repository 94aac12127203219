"""``python -m proofs_checks.mutate``: does a changed constant or operator in a formula make some check fail?

Each numeric constant, operator, square root, minimum and maximum of the formula modules is changed once. Every mutant
runs in a process of its own against the checks of the ledger that reach it (quick mode, cheapest first), then the
examples in its module's docstrings, then the tests of the theory. Printed: the share noticed, and every survivor.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bridge_theory.cli.options import Parser
from bridge_theory.cli.status import exit_status
from bridge_theory.errors import InputError
from proofs_checks.mutation.campaign import Fate, campaign, observe_all
from proofs_checks.mutation.killers import STAGES, Killer, Stage, example_killers, file_killers, ledger_killers
from proofs_checks.mutation.sites import Site, formula_modules, sites
from proofs_checks.mutation.survivors import explanation

GOAL = 0.95
TESTS = ("tests/theory/test_*.py", "tests/test_offline_formulas_*.py", "tests/test_formulas_*.py")
"""The tests that hold formulas to numbers, relative to the root of the repository."""


def main(argv: list[str]) -> int:
    """Run the campaign; returns 1 if less than ``GOAL`` is noticed or a survivor has no explanation."""
    options = _parser().parse_args(argv)
    chosen = _chosen(options.module, options.sample, options.seed)
    killers = [killer for stage in options.stages for killer in _killers(stage)]
    start = time.perf_counter()
    observed = observe_all(killers, options.jobs)
    baselines = [baseline for baseline in observed if baseline.passes]
    broken = [baseline.killer.name for baseline in observed if not baseline.passes]
    print(f"{len(chosen)} mutants, {len(baselines)} killers; not used: {len(killers) - len(observed)} too slow", end="")
    print(f", {', '.join(broken)} not passing on the formulas as written" if broken else "", flush=True)
    fates = campaign(chosen, baselines, options.jobs)
    print(report(fates))
    print(f"{time.perf_counter() - start:.0f} s")
    return int(share(fates) < GOAL or any(fate.killer is None and not explanation(fate.site) for fate in fates))


def _killers(stage: Stage) -> list[Killer]:
    if stage == "ledger":
        return ledger_killers()
    if stage == "examples":
        return example_killers()
    return file_killers(sorted(path for pattern in TESTS for path in Path().glob(pattern)))


def share(fates: Sequence[Fate]) -> float:
    """The share of the mutants that something noticed."""
    return sum(fate.killer is not None for fate in fates) / len(fates)


def report(fates: Sequence[Fate]) -> str:
    """The share noticed, by what, and the survivors with their explanations."""
    stages = Counter(fate.stage for fate in fates)
    lines = [f"noticed: {share(fates):.1%} of {len(fates)} mutants"]
    so_far = 0
    for stage in STAGES:
        so_far += stages[stage]
        lines.append(f"  with {stage:<9} {so_far / len(fates):6.1%}  (+{stages[stage]})")
    for fate in fates:
        if fate.killer is None:
            why = explanation(fate.site) or "UNEXPLAINED"
            reached = f"{fate.tried} killers reach it" if fate.tried else "nothing reaches it"
            lines.append(f"survives: {fate.site} in {fate.site.functions[:1]} ({reached}): {why}")
    return "\n".join(lines)


def _chosen(module: str, sample: int | None, seed: int) -> list[Site]:
    wanted = [name for name in formula_modules() if module in name]
    if not wanted:
        raise InputError(f"no formula module is called {module!r}; they are {', '.join(formula_modules())}")
    for name, value, least in (("sample", sample, 1), ("seed", seed, 0)):
        if value is not None and value < least:
            raise InputError(f"--{name} must be at least {least}, got {value}.")
    everything = [site for name in wanted for site in sites(name)]
    if sample is None or sample >= len(everything):
        return everything
    picked = np.random.default_rng(seed).choice(len(everything), size=sample, replace=False)
    return [everything[index] for index in sorted(picked)]


def _parser() -> argparse.ArgumentParser:
    p = Parser(prog="python -m proofs_checks.mutate", description=(__doc__ or "").split("\n\n")[1])
    p.add_argument("--module", default="", metavar="TEXT", help="only formula modules whose name contains this")
    p.add_argument("--sample", type=int, metavar="N", help="only N mutants, drawn at random")
    p.add_argument("--stages", nargs="+", choices=STAGES, default=STAGES, help="what may notice (default: all three)")
    p.add_argument("--seed", type=int, default=0, help="of the sample (default 0)")
    p.add_argument("--jobs", type=int, default=os.cpu_count(), help="mutants at a time (default: all cores)")
    return p


if __name__ == "__main__":
    sys.exit(exit_status("python -m proofs_checks.mutate", main, sys.argv[1:]))
