"""The ledger after a run as JSON data: every claim, its evidence with what was found, its repaired forms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from proofs_checks.claim import Claim, Repair
from proofs_checks.evidence import Evidence
from proofs_checks.kernel.recorded import refutation
from proofs_checks.ledger import formula_evidence
from proofs_checks.run import Job, Report
from proofs_checks.standing import Standing, item_holds
from proofs_checks.strength import link_kind, weakest


def record(item: Standing, reports: Mapping[Job, Report]) -> dict[str, Any]:
    """One claim with everything a reader of the JSON needs; texts keep their LaTeX."""
    claim = item.claim
    return {
        "label": claim.label,
        "part": claim.part,
        "name": claim.name,
        "topic": claim.topic,
        "verdict": claim.verdict,
        "statement": claim.statement,
        "because": claim.because,
        "assumptions": list(claim.assumptions),
        "proof": claim.proof,
        "weakest": item.weakest,
        "links": _links(claim, reports),
        "unsupported": item.unsupported,
        "problems": list(item.problems),
        "seconds": item.seconds,
        "evidence": [_evidence(piece, reports) for piece in claim.evidence],
        "repairs": [_repair(repair, reports) for repair in claim.repairs],
    }


def _repair(repair: Repair, reports: Mapping[Job, Report]) -> dict[str, Any]:
    return {
        "name": repair.name,
        "title": repair.title,
        "statement": repair.statement,
        "assumptions": list(repair.assumptions),
        "proof": repair.proof,
        "formulas": list(repair.formulas),
        "weakest": weakest(repair, lambda item: item_holds(item, reports)),
        "links": _links(repair, reports),
        "evidence": [_evidence(piece, reports) for piece in (*repair.evidence, *formula_evidence(repair))],
    }


def _links(statement: Claim | Repair, reports: Mapping[Job, Report]) -> list[dict[str, Any]]:
    """What each link says, how far it is shown, and by what: checks by their keys, repaired forms by their names."""
    return [
        {
            "says": one.says,
            "shown": link_kind(one, statement.evidence, lambda item: item_holds(item, reports)),
            "by": [
                *(item.key or item.kind for item in statement.evidence if item.handle in one.by),
                *(part.name for part in one.by if isinstance(part, Repair)),
            ],
        }
        for one in statement.links
    ]


def _evidence(item: Evidence, reports: Mapping[Job, Report]) -> dict[str, Any]:
    found: dict[str, Any] = {"kind": item.kind, "words": item.words, "check": item.key or None}
    if item.counterexample is not None:
        found["counterexample"] = item.counterexample.name
        found["kernel"] = refutation(item.counterexample.name) or None
    if report := reports.get(Job(item.key)):
        found |= {
            "status": report.status,
            "detail": report.detail,
            "decisions": report.decisions,
            "seconds": report.seconds,
        }
    tried = {mutant.name: reports[job] for mutant in item.mutants if (job := Job(item.key, mutant.name)) in reports}
    return found | {"mutants": {name: _mutant_word(report) for name, report in tried.items()}}


def _mutant_word(report: Report) -> str:
    return {"fails": "rejected", "holds": "survives"}.get(report.status, report.status)
