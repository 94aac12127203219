"""Every check of the ledger holds in quick mode, and rejects every mutant planted for it."""

from __future__ import annotations

import pytest

from proofs_checks.ledger import all_evidence, claims
from proofs_checks.run import Job, jobs_for, run_job
from proofs_checks.standing import problem

JOBS = jobs_for([item for claim in claims() for item in all_evidence(claim)], mutants=True)


@pytest.mark.parametrize("job", JOBS, ids=lambda job: f"{job.key} | {job.mutant}" if job.mutant else job.key)
def test_statements_hold_and_mutants_are_rejected(job: Job) -> None:
    report = run_job(job, quick=True, seed=0)
    if report.status in ("skipped", "not run"):
        pytest.skip(report.detail)
    assert not report.bad, problem(report)
