"""A session as one JSON file: what was asked, what was answered, and what is claimed; whole or absent, never a pickle.

Questions and answers are all that a checker needs; claims and the teacher's weights stand beside, to be compared.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.asking.elicitation import PRIOR_SCALES, Elicitation
from bridge_algos.asking.tabular import Problem
from bridge_algos.files import atomic_write_text
from bridge_algos.run.versions import package_versions
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError

KIND, FORMAT = "bridge-rl asking session", 1
LARGEST_FILE = 2**28
"""Bytes of a session file that is read."""


def session_path(directory: Path, seed: int) -> Path:
    """Where the session of a seed lies."""
    return directory / f"session-{seed:04d}.json"


def session_record(
    configuration: dict[str, Any], seed: int, problem: Problem, session: Elicitation, outcome: dict[str, Any]
) -> dict[str, Any]:
    """What is stored of a session of a tabular problem."""
    certificate = session.certificate
    demonstrations = problem.demonstrations
    shown = sorted({item for row in session.history for item in row[:2]}) or [0]  # the others need not be kept
    place = {item: number for number, item in enumerate(shown)}
    record = {
        "kind": KIND,
        "format": FORMAT,
        "configuration": configuration,
        "seed": seed,
        "versions": package_versions(),
        "delta": session.delta,
        "until": session.goal.text,
        "goal_nats": session.goal.nats,
        "rho": session.goal.rho,
        "reference": None if session.reference is None else session.reference.tolist(),
        "utility_range": problem.utility.utility_range,
        "weight_bound": session.weight_bound,
        "prior_precisions": [scale * session.features.shape[1] / session.weight_bound**2 for scale in PRIOR_SCALES],
        "demonstrations": None if demonstrations is None else _trajectories(demonstrations),
        "complete": problem.candidates.complete,
        "candidates": None if problem.candidates.complete else problem.candidates.policies.tolist(),
        "pool": _trajectories(Trajectories(problem.pool.states[shown], problem.pool.actions[shown])),
        "questions": [[place[first], place[second], answer] for first, second, answer in session.history],
        "recommended": problem.candidates.policies[session.recommended].tolist(),
        "claims": {
            "certified": certificate.certified,
            "contradicted": session.contradicted,
            "gap": session.gap.value,
            "answers": certificate.answers,
            "candidates": certificate.candidates,
            "sentence": certificate.sentence,
        },
        "teacher": {"weights": problem.utility.weights.tolist()},
        "outcome": outcome,
    }
    return {**record, "digest": record_digest(record)}


def record_digest(record: dict[str, Any]) -> str:
    """SHA-256 of a record without its digest, in canonical JSON."""
    content = {name: value for name, value in record.items() if name != "digest"}
    return hashlib.sha256(json.dumps(content, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def save_session(path: Path, record: dict[str, Any]) -> None:
    """Write a record, whole or not at all."""
    atomic_write_text(path, json.dumps(record, separators=(",", ":")) + "\n")


def load_session(path: Path, kind: str = KIND) -> dict[str, Any]:
    """Read a record whose digest fits its content.

    Raises:
        InputError: for a file that is missing, too large, not such a record, or changed.
    """
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise InputError(
                f"{path} must be smaller than {LARGEST_FILE:,} bytes; it is not a session of this program."
            )
        record = json.loads(path.read_bytes())
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}); give the file of a session.") from None
    except (ValueError, RecursionError):
        raise InputError(f"{path} must hold JSON, and does not; give the file of a session.") from None
    if not isinstance(record, dict) or record.get("kind") != kind:
        raise InputError(f"{path} is a file of another kind, expected a {kind!r} of 'bridge-rl ask'.")
    if record.get("format") != FORMAT:
        raise InputError(f"{path} has format {record.get('format')!r}, expected {FORMAT}; run the session again.")
    if record.get("digest") != record_digest(record):
        raise InputError(
            f"{path} has been changed since it was written: its digest does not fit; run the session again."
        )
    return record


def _trajectories(trajectories: Trajectories) -> dict[str, Any]:
    return {"states": np.asarray(trajectories.states).tolist(), "actions": np.asarray(trajectories.actions).tolist()}
