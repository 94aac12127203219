"""The file of an asking session, read as JSON; its digest must fit its content."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path
from typing import Any

from bridge_theory.errors import InputError

KIND, FORMAT = "bridge-rl asking session", 1
WITHOUT_MODEL = "bridge-rl asking session without a model of utility"
LARGEST_FILE = 2**28
NAME = re.compile(r"session-(\d+)\.json")


def session_files(directory: Path) -> list[Path]:
    """The files of sessions in a directory, in the order of their seeds."""
    named = [(int(match[1]), path) for path in directory.iterdir() if (match := NAME.fullmatch(path.name))]
    return [path for _, path in sorted(named)]


def read_record(path: Path) -> dict[str, Any]:
    """The content of a session's file.

    Raises:
        InputError: for a file that is missing, too large, not such a record, or whose digest does not fit.
    """
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise InputError(f"{path} must be smaller than {LARGEST_FILE:,} bytes; it is no session of this program.")
        record = json.loads(path.read_bytes())
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}); give the file of a session.") from None
    except (ValueError, RecursionError):
        raise InputError(f"{path} must hold JSON, and does not; give the file of a session.") from None
    if isinstance(record, dict) and record.get("kind") == WITHOUT_MODEL:
        raise InputError(
            f"{path} is a session without a model of utility, which is not verified; see its own sentence."
        )
    if not isinstance(record, dict) or record.get("kind") != KIND:
        raise InputError(f"{path} is a file of another kind, expected the session of 'bridge-rl ask'.")
    if record.get("format") != FORMAT:
        raise InputError(f"{path} has format {record.get('format')!r}, expected {FORMAT}; run the session again.")
    if record.get("digest") != digest(record):
        raise InputError(f"{path} has been changed: its digest does not fit; run the session again.")
    return record


def digest(record: dict[str, Any]) -> str:
    """SHA-256 of a record without its digest, in canonical JSON.

    >>> digest({"seed": 1, "digest": "x"}) == digest({"seed": 1})
    True
    """
    content = {name: value for name, value in record.items() if name != "digest"}
    return hashlib.sha256(json.dumps(content, sort_keys=True, separators=(",", ":")).encode()).hexdigest()
