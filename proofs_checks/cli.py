"""``bridge-rl check``: is each statement of the paper true? Run the evidence and see."""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import time
from pathlib import Path

from bridge_algos.files import atomic_write_text
from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError
from proofs_checks.claim import MEANING, Claim
from proofs_checks.evidence import STRENGTH
from proofs_checks.kernel.recorded import counts
from proofs_checks.ledger import all_evidence, claims, matching, missing_engines
from proofs_checks.record import record
from proofs_checks.run import jobs_for, run_all
from proofs_checks.standing import Standing, standing
from proofs_checks.strength import weakest
from proofs_checks.terminal import closing, table

_TOPICS = ("setting", "offline", "hellinger", "online", "regret", "answers", "experiments")


def main(argv: list[str]) -> int:
    """Run ``bridge-rl check``. Returns 1 if anything that should hold does not, else 0."""
    options = _parser().parse_args(argv)
    _check_numbers(options)
    _require_engines()
    if options.search:
        from proofs_checks.attack import attack

        return attack(options.search, seconds=options.budget, seed=options.seed, directory=options.out)
    chosen = _chosen(options)
    if options.list:
        print("\n".join(f"{claim.key}  ({_recorded(claim)}) {claim.name}" for claim in chosen))
        return 0
    start = time.perf_counter()
    evidence = [item for claim in chosen for item in all_evidence(claim)]
    jobs = jobs_for(evidence, mutants=options.mutants)
    reports = run_all(jobs, quick=options.quick, seed=options.seed, processes=options.jobs)
    standings = [item for claim in chosen if _wanted(item := standing(claim, reports), options.status)]
    if options.html:
        from proofs_checks.html.page import page

        atomic_write_text(options.html, page(standings, reports, quick=options.quick))
    if options.json:
        found = {**counts(), "claims": [record(item, reports) for item in standings]}
        print(json.dumps(found, indent=2, ensure_ascii=False))
    else:
        colour = sys.stdout.isatty() and "NO_COLOR" not in os.environ
        width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        tried = [report for job, report in reports.items() if job.mutant and report.status != "not run"]
        rejected = sum(report.status == "fails" for report in tried)
        seconds = time.perf_counter() - start
        print(table(standings, width=width, colour=colour), end="\n\n")
        print(closing(standings, rejected=rejected, planted=len(tried), seconds=seconds, colour=colour))
        if options.html:
            print(f"page: {options.html}")
    return int(any(report.bad for report in reports.values()))


def _parser() -> argparse.ArgumentParser:
    p = Parser(prog="bridge-rl check", description="Run the machine evidence for every statement of the paper.")
    p.add_argument("--only", action="append", default=[], metavar="LABEL", help="claims whose label contains this text")
    p.add_argument(
        "--status",
        action="append",
        default=[],
        choices=tuple(dict.fromkeys((*MEANING, *STRENGTH))),
        help="claims with this verdict, or whose weakest link is shown this way",
    )
    p.add_argument("--topic", action="append", default=[], choices=_TOPICS, help="claims of one part of the paper")
    p.add_argument("--quick", action="store_true", help="smaller instances, under a minute")
    p.add_argument("--mutants", action="store_true", help="also plant every wrong variant; one that survives fails")
    p.add_argument("--json", action="store_true", help="print JSON")
    p.add_argument("--html", type=Path, metavar="FILE", help="write a self-contained page of the ledger")
    p.add_argument("--list", action="store_true", help="list the claims and stop")
    p.add_argument("--jobs", type=int, default=-1, help="processes (default: all cores); does not change the results")
    p.add_argument("--seed", type=int, default=0, help="of the generated instances (default 0)")
    p.add_argument("--search", metavar="LABEL", help="attack one statement: look for a counterexample")
    p.add_argument("--budget", type=float, default=60.0, metavar="SECONDS", help="how long to search (default 60)")
    p.add_argument("--out", type=Path, default=Path("."), help="where --search writes what it finds (default .)")
    return p


def _require_engines() -> None:
    if missing := missing_engines():
        raise InputError(f"check needs {', '.join(missing)}; install them with: pip install 'bridge-rl[checks]'.")


def _check_numbers(options: argparse.Namespace) -> None:
    if not options.budget > 0:
        raise InputError(f"--budget {options.budget:g} is no time to search; give a positive number of seconds")
    if options.seed < 0:
        raise InputError(f"--seed {options.seed} is negative; give a whole number from 0 on")
    if options.jobs < 1 and options.jobs != -1:
        raise InputError(f"--jobs {options.jobs} is no number of processes; give 1 or more, or -1 for all cores")


def _chosen(options: argparse.Namespace) -> list[Claim]:
    by_label = {claim.key for text in options.only for claim in matching(text)} if options.only else None
    return [
        claim
        for claim in claims()
        if (by_label is None or claim.key in by_label) and (not options.topic or claim.topic in options.topic)
    ]


def _recorded(claim: Claim) -> str:
    """The verdict with its weakest link, if all evidence holds."""
    kind = weakest(claim)
    return f"{claim.verdict}; {kind}" if kind and kind != claim.verdict else claim.verdict


def _wanted(item: Standing, statuses: list[str]) -> bool:
    return not statuses or item.claim.verdict in statuses or item.weakest in statuses
