"""Independent pieces of work, each of which stores its own result: joblib's current backend does them."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Any

from joblib import Parallel, delayed
from tqdm import tqdm

from bridge_theory.errors import InputError


def check_jobs(jobs: int) -> None:
    """Refuse a number of processes that joblib would refuse later, in other words."""
    if jobs == 0:
        raise InputError("jobs is 0, expected a positive number of processes, or -1 for all cores.")


def for_each(
    work: Callable[..., object],
    arguments: Sequence[tuple[Any, ...]],
    jobs: int,
    label: str,
    unit: str,
    finished: int = 0,
    progress: bool | None = None,
) -> None:
    """Call ``work(*a)`` for every ``a`` of ``arguments``, in any order, with a bar that starts at ``finished``.

    Args:
        jobs: processes, -1 for all cores. A Dask or Ray cluster does the work inside
            ``with joblib.parallel_config(backend="dask")``.
        progress: show the bar; None shows one when standard error is a terminal.
    """
    show = sys.stderr.isatty() if progress is None else progress
    total = finished + len(arguments)
    with tqdm(total=total, initial=finished, unit=unit, desc=label, disable=not show) as bar:
        if arguments:
            parallel = Parallel(n_jobs=jobs, return_as="generator_unordered", batch_size=1)
            for _ in parallel(delayed(work)(*a) for a in arguments):
                bar.update()
