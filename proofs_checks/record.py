"""The ledger after a run as JSON data: every claim, its evidence with what was found, its repaired forms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from proofs_checks.claim import Repair
from proofs_checks.evidence import Evidence
from proofs_checks.ledger import formula_evidence
from proofs_checks.run import Job, Report
from proofs_checks.standing import Standing


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
        "strongest": item.strongest,
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
        "evidence": [_evidence(piece, reports) for piece in (*repair.evidence, *formula_evidence(repair))],
    }


def _evidence(item: Evidence, reports: Mapping[Job, Report]) -> dict[str, Any]:
    found: dict[str, Any] = {"kind": item.kind, "words": item.words, "check": item.key or None}
    if item.counterexample is not None:
        found["counterexample"] = item.counterexample.name
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
