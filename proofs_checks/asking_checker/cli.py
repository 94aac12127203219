"""``bridge-rl verify`` of asking sessions: the part of the command that reads their files."""

from __future__ import annotations

import json
from pathlib import Path

from bridge_theory.errors import InputError
from proofs_checks.asking_checker.file import NAME, read_record, session_files


def holds_sessions(run: Path) -> bool:
    """Whether this is a session's file, or a directory of them.

    Raises:
        InputError: for a directory that holds logs of the online loop too.
    """
    if not run.is_dir():
        return run.suffix == ".json"
    sessions = bool(session_files(run))
    if sessions and any(run.glob("log-*.npz")):
        raise InputError(f"{run} holds sessions and logs of runs; keep them in directories of their own.")
    return sessions


def verify_sessions(run: Path, seed: int | None, as_json: bool) -> int:
    """Print the verdicts. Returns 0 when every claim is certified, else 1; an unreadable file is a user's mistake."""
    from proofs_checks.asking_checker.checker import check
    from proofs_checks.asking_checker.verdict import table

    records = [(path, read_record(path)) for path in _chosen(run, seed)]
    for path, record in records:
        match = NAME.fullmatch(path.name)
        if path != run and match and record.get("seed") != int(match[1]):  # else a copy would count as another seed
            raise InputError(f"{path} is the session of seed {record.get('seed')}; give it that seed's name.")
    verdicts = [check(record) for _, record in records]
    print(json.dumps([v.record() for v in verdicts], indent=2, allow_nan=False) if as_json else table(verdicts))
    return int(not all(v.stands for v in verdicts))


def _chosen(run: Path, seed: int | None) -> list[Path]:
    if run.is_file():
        if seed is not None:
            raise InputError(f"{run} is one session; give its directory to choose a seed.")
        return [run]
    paths = [path for path in session_files(run) if seed is None or int(path.stem.split("-")[1]) == seed]
    if not paths:
        raise InputError(f"{run} holds no session of seed {seed}; choose another seed.")
    return paths
