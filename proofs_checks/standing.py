"""Where each claim stands after a run: what its evidence amounts to, and whether anything that should hold failed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from proofs_checks.claim import SETTLED_BY, Claim
from proofs_checks.evidence import Evidence, Kind
from proofs_checks.ledger import all_evidence
from proofs_checks.run import Job, Report
from proofs_checks.strength import link_kind, weakest


@dataclass(frozen=True)
class Standing:
    """One claim after a run.

    Attributes:
        claim: the claim.
        weakest: the kind of evidence behind the weakest link of the verdict; None where a link has none in this run.
        links: what each link says, and the strongest evidence for it that held.
        repaired: for each repaired form, its name and the evidence behind its weakest link.
        seconds: time its own checks and those of its repaired forms took.
        problems: what should hold and does not, one sentence each.
        unsupported: a link that its verdict needs had no evidence (it was skipped, or left out of a quick run).
    """

    claim: Claim
    weakest: Kind | None
    links: tuple[tuple[str, Kind | None], ...]
    repaired: tuple[tuple[str, Kind | None], ...]
    seconds: float
    problems: tuple[str, ...]
    unsupported: bool


def standing(claim: Claim, reports: Mapping[Job, Report]) -> Standing:
    """Sum up one claim; jobs that were not run count as evidence for nothing."""
    keys = {item.key for item in all_evidence(claim)}
    mine = [report for job, report in reports.items() if job.key in keys]

    def holds(item: Evidence) -> bool:
        return item_holds(item, reports)

    found = weakest(claim, holds)
    return Standing(
        claim,
        found,
        tuple((one.says, link_kind(one, claim.evidence, holds)) for one in claim.links),
        tuple((repair.name, weakest(repair, holds)) for repair in claim.repairs),
        sum(report.seconds for report in mine),
        tuple(problem(report) for report in mine if report.bad),
        claim.verdict in SETTLED_BY and found is None,
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
