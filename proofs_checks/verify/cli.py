"""``bridge-rl verify``: does a run's log prove its regret bounds?"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError

if TYPE_CHECKING:
    from proofs_checks.verify.certificate import Certificate


def main(argv: list[str]) -> int:
    """Verify logs. Returns 0 when all are certified, else 1; an unreadable log is a user's mistake."""
    options = _parser().parse_args(argv)
    from proofs_checks.verify.certificate import table

    certificates = [item for path in _paths(options.run, options.seed) for item in _checked(path, options.run)]
    if options.json:
        print(json.dumps([item.record() for item in certificates], indent=2))
    else:
        print(table(certificates))
    return int(not all(item.certified for item in certificates))


def _checked(path: Path, run: Path) -> tuple[Certificate, ...]:
    from bridge_algos.run.log_file import load_log, log_path
    from proofs_checks.verify.checker import verify

    log = load_log(path)
    try:
        certificates = verify(log)
    except InputError as error:
        raise InputError(f"{path} cannot be checked: {error}") from None
    if path != run and path != log_path(run, certificates[0].seed):  # else a copy would count as another seed
        raise InputError(f"{path} is the log of seed {certificates[0].seed}; give it that seed's name, or remove it.")
    return certificates


def _parser() -> argparse.ArgumentParser:
    p = Parser(prog="bridge-rl verify", description="Recompute a run from its log and certify its regret bounds.")
    p.add_argument("run", type=Path, metavar="RUN", help="directory of 'bridge-rl run ... --log', or one log file")
    p.add_argument("--seed", type=int, help="only this seed (default: all)")
    p.add_argument("--json", action="store_true", help="print JSON with the bounds of every round")
    return p


def _paths(run: Path, seed: int | None) -> list[Path]:
    from bridge_algos.run.log_file import log_files, log_path

    if run.is_file():
        if seed is not None:
            raise InputError(f"{run} is one log; give its directory to choose a seed.")
        return [run]
    if seed is not None:
        if not log_path(run, seed).exists():
            raise InputError(f"{run} holds no log of seed {seed}; choose another, or 'bridge-rl run ... --log' again.")
        return [log_path(run, seed)]
    paths = log_files(run)
    if not run.exists():
        raise InputError(f"{run} does not exist; give a directory that 'bridge-rl run ... --log --out' wrote.")
    if not paths:
        raise InputError(f"{run} holds no logs (log-*.npz); make some with 'bridge-rl run ... --log --out {run}'.")
    return paths
