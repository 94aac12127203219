"""Run checks and their mutants, in parallel; what comes out does not depend on how many processes there are."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from joblib import Parallel, delayed, effective_n_jobs
from threadpoolctl import threadpool_limits
from tqdm import tqdm

from proofs_checks.context import Context
from proofs_checks.evidence import Evidence
from proofs_checks.ledger import evidence_by_key

_WORTH_A_PROCESS = 5

Status = Literal["holds", "fails", "error", "skipped", "not run"]


@dataclass(frozen=True)
class Job:
    """One check to run: the statement itself, or one of its mutants by name."""

    key: str
    mutant: str = ""


@dataclass(frozen=True)
class Report:
    """What one job said. For a mutant, ``holds`` means that the check did not notice, and so is bad news."""

    job: Job
    status: Status
    detail: str
    decisions: int
    seconds: float

    @property
    def bad(self) -> bool:
        """Something that should hold does not: a failed check, a surviving mutant, an exception in either."""
        wanted: Status = "fails" if self.job.mutant else "holds"
        return self.status not in (wanted, "skipped", "not run")


def jobs_for(evidence: Iterable[Evidence], *, mutants: bool) -> tuple[Job, ...]:
    """Every check once, each followed by its mutants if they are wanted."""
    unique = {item.key: item for item in evidence if item.check is not None}
    jobs = [Job(key) for key in unique]
    if mutants:
        jobs += [Job(key, mutant.name) for key, item in unique.items() for mutant in item.mutants]
    return tuple(jobs)


def run_job(job: Job, *, quick: bool, seed: int) -> Report:
    """Run one job here. An exception is a finding (``error``), never a pass and never a rejected mutant."""
    item = evidence_by_key()[job.key]
    if quick and item.full_only:
        return Report(job, "not run", "left out of quick runs", 0, 0.0)
    variant = next((mutant.variant for mutant in item.mutants if mutant.name == job.mutant), {})
    start = time.perf_counter()
    try:
        with threadpool_limits(1):  # matrices are tiny; threads only wait for each other
            outcome = item.run(Context(quick, seed, job.key), variant)
    except Exception as error:  # whatever a check raises belongs in its report, beside the other checks
        return Report(job, "error", f"{type(error).__name__}: {error}", 0, time.perf_counter() - start)
    status: Status = "skipped" if outcome.skipped else "holds" if outcome.holds else "fails"
    text = outcome.skipped or "; ".join(outcome.failures) or outcome.details
    return Report(job, status, text, outcome.decisions, time.perf_counter() - start)


def run_all(jobs: Sequence[Job], *, quick: bool, seed: int = 0, processes: int = 1) -> dict[Job, Report]:
    """Run all jobs, with a progress bar where standard error is a terminal."""
    # starting a process takes as long as a few checks
    processes = min(effective_n_jobs(processes), max(1, len(jobs) // _WORTH_A_PROCESS))
    tasks = (delayed(run_job)(job, quick=quick, seed=seed) for job in jobs)
    with Parallel(processes, return_as="generator_unordered", pre_dispatch="all", batch_size=1) as pool:
        reports = tqdm(pool(tasks), total=len(jobs), unit="check", disable=not sys.stderr.isatty(), leave=False)
        found = {report.job: report for report in reports}
    return {job: found[job] for job in jobs}
