"""The log of a seed: what an independent checker needs to recompute every round, beside what the run claims of it.

One ``.npz`` file a seed, of plain arrays (no pickle), written whole or not at all. Shared entries: ``header`` (JSON:
configuration, seed, horizon, weight bound W, algorithms, versions, and in words how each one's policies were found),
``digest`` (SHA-256 of everything else), ``transitions`` (S, A, S), ``initial`` (S,), ``demonstrations/states`` and
``demonstrations/actions`` (n, H) as the learners saw them. For each algorithm NAME but the clone, over T rounds of K
comparisons and d features:

=====================  ==================  ====================================================================
entry                  shape               meaning
=====================  ==================  ====================================================================
NAME/policies          (N, S) integers     the policies searched
NAME/pairs             (T, 2) integers     the two played
NAME/states, /actions  (T, 2, K, H)        the trajectories compared
NAME/outcomes          (T, K)              answers: 1, 0, 1/2, or NaN for none
NAME/w                 (T + 1, d)          weights used in each round, and after the last
NAME/gamma, log_det,   (T,)                claims: multiplier, log det of the data matrix, size of Pi_t,
set_size, uncertainty                      norm of the pair's feature difference in the inverse matrix
NAME/bonus             (T, 2)              claim: bonuses of the pair
NAME/solver_error      (T + 1,)            claim: residual of the estimating equation at w
=====================  ==================  ====================================================================

The claims are there to be contradicted: ``bridge-rl verify`` recomputes each from the rest.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge_algos.files import atomic_write
from bridge_algos.npz import read_arrays
from bridge_theory.errors import InputError

FORMAT = "bridge-rl log 2"
"""Changes whenever an entry or a rule of a run gets another meaning: since 2 no policy is compared with itself while
another one is left."""


@dataclass(frozen=True, eq=False)
class RunLog:
    """A log as it was read: nothing in it is checked but that it is whole.

    Args:
        header: the JSON object of the header.
        arrays: all entries by name, for example ``"bridge/w"``.
    """

    header: dict[str, Any]
    arrays: dict[str, NDArray[Any]]

    @property
    def algorithms(self) -> tuple[str, ...]:
        """Names of the algorithms logged, in the order of the run."""
        return tuple(self.header["algorithms"])


def content_digest(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> str:
    """SHA-256 over the header and every array with its name, type and shape: it shows damage, not forgery."""
    total = hashlib.sha256(json.dumps(header, sort_keys=True).encode())
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        total.update(f"\n{name} {array.dtype.str} {array.shape}\n".encode())
        total.update(array.tobytes())
    return total.hexdigest()


def save_log(path: Path, log: RunLog) -> None:
    """Write a log, whole or not at all."""
    entries: dict[str, Any] = {
        **log.arrays,
        "header": np.array(json.dumps(log.header)),
        "digest": np.array(content_digest(log.header, log.arrays)),
    }
    with atomic_write(path) as handle:
        np.savez_compressed(handle, **entries)


def load_log(path: str | Path) -> RunLog:
    """Read a log; nothing in it is executed, and nothing but its wholeness is checked.

    Raises:
        InputError: when it is missing, damaged, of another format, or its digest does not fit.
    """
    arrays = read_arrays(path, ("header", "digest"))
    text, digest = (arrays.pop(name) for name in ("header", "digest"))
    try:
        header = json.loads(str(text[()]))
    except (ValueError, RecursionError):
        header = None
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise InputError(f"{path} is no log of this version ({FORMAT!r}); store it again with 'bridge-rl run --log'.")
    if str(digest[()]) != content_digest(header, arrays):
        raise InputError(f"{path} is damaged: its content does not fit its digest; store the log again.")
    names = header.get("algorithms")
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InputError(f"{path} names its algorithms as {names!r}, expected a list of names; store the log again.")
    return RunLog(header, arrays)


def log_path(directory: Path, seed: int) -> Path:
    """Where the log of a seed lies."""
    return directory / f"log-{seed:05d}.npz"


def log_files(directory: Path) -> list[Path]:
    """The logs of a run, in order of seed."""
    return sorted(path for path in directory.glob("log-*.npz") if re.fullmatch(r"log-\d{5,}\.npz", path.name))
