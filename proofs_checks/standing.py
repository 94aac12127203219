"""Where each claim stands after a run: what its evidence amounts to, and whether anything that should hold failed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from proofs_checks.claim import SETTLED_BY, Claim
from proofs_checks.evidence import STRENGTH, Evidence, Kind
from proofs_checks.ledger import all_evidence
from proofs_checks.run import Job, Report


@dataclass(frozen=True)
class Standing:
    """One claim after a run.

    Attributes:
        claim: the claim.
        strongest: the strongest kind of evidence for the verdict that held in this run; None if none did.
        repaired: for each repaired form, its name and the strongest evidence that held.
        seconds: time its own checks and those of its repaired forms took.
        problems: what should hold and does not, one sentence each.
        unsupported: no evidence of a kind that its verdict needs held (it was skipped, or left out of a quick run).
    """

    claim: Claim
    strongest: Kind | None
    repaired: tuple[tuple[str, Kind | None], ...]
    seconds: float
    problems: tuple[str, ...]
    unsupported: bool


def standing(claim: Claim, reports: Mapping[Job, Report]) -> Standing:
    """Sum up one claim; jobs that were not run count as evidence for nothing."""
    keys = {item.key for item in all_evidence(claim)}
    mine = [report for job, report in reports.items() if job.key in keys]
    needed = SETTLED_BY.get(claim.verdict, ())
    supporting = tuple(item for item in claim.evidence if not needed or item.kind in needed)
    strongest = _strongest(supporting, reports)
    return Standing(
        claim,
        strongest,
        tuple((repair.name, _strongest(repair.evidence, reports)) for repair in claim.repairs),
        sum(report.seconds for report in mine),
        tuple(problem(report) for report in mine if report.bad),
        bool(needed) and strongest is None,
    )


def problem(report: Report) -> str:
    """What is wrong, in one sentence."""
    job = report.job
    if not job.mutant:
        verb = "raised" if report.status == "error" else "fails:"
        return f"{job.key} {verb} {report.detail}"
    if report.status == "error":
        return f"{job.key}: the mutant {job.mutant!r} raised {report.detail}; a rejection is an outcome, not an error"
    return f"{job.key}: the mutant {job.mutant!r} survives, so that the check proves nothing ({report.detail})"


def item_holds(item: Evidence, reports: Mapping[Job, Report]) -> bool:
    """Evidence without a check stands by itself; otherwise its check must have held in this run."""
    if item.check is None:
        return True
    report = reports.get(Job(item.key))
    return report is not None and report.status == "holds"


def _strongest(items: tuple[Evidence, ...], reports: Mapping[Job, Report]) -> Kind | None:
    kinds = {item.kind for item in items if item_holds(item, reports)}
    return next((kind for kind in STRENGTH if kind in kinds), None)
