"""The whole page: counts, filters, the claims in the order of the paper, the repaired theory."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from importlib import resources

from proofs_checks.claim import MEANING as VERDICTS
from proofs_checks.evidence import MEANING as KINDS
from proofs_checks.evidence import STRENGTH, Evidence
from proofs_checks.html.development import development
from proofs_checks.html.entry import anchor, badge, entry, repair_entry
from proofs_checks.html.sections import section_title
from proofs_checks.kernel.manifest import shipped
from proofs_checks.kernel.recorded import theorem
from proofs_checks.ledger import all_evidence
from proofs_checks.run import Job, Report
from proofs_checks.standing import Standing, item_holds


def page(standings: Sequence[Standing], reports: Mapping[Job, Report], *, quick: bool) -> str:
    """A complete HTML document that needs nothing else."""
    sections: dict[str, list[str]] = {}
    for item in standings:
        heading = section_title(item.claim.section)
        sections.setdefault(heading, []).append(entry(item, reports))
    body = "".join(
        f"<section><h2>{escape(heading)}</h2>{''.join(articles)}</section>" for heading, articles in sections.items()
    )
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1"><link rel="icon" href="data:,">'
        f"<title>BRIDGE: the ledger of its statements</title><style>{_resource('style.css')}</style></head><body>"
        f"{_top(standings, reports, quick)}<main>{body}{_repaired(standings, reports)}{_development(standings)}</main>"
        f"<script>{_resource('filter.js')}</script></body></html>"
    )


def _top(standings: Sequence[Standing], reports: Mapping[Job, Report], quick: bool) -> str:
    kinds = Counter(item.weakest for item in standings)
    verdicts = Counter(item.claim.verdict for item in standings)
    held = {item.key or id(item): item.kind for one in standings for item in all_evidence(one.claim)
            if item_holds(item, reports)}  # fmt: skip
    pieces = Counter(held.values())
    evidence = "".join(
        f'<div class="count"><b>{kinds[kind]}</b>{badge(kind, KINDS[kind])}<small>{_pieces(pieces[kind])}</small></div>'
        for kind in STRENGTH
    )
    filters = "".join(
        f'<button type="button" data-verdict="{escape(verdict)}" aria-pressed="false" title="{escape(meaning)}">'
        f"{escape(verdict)} <b>{verdicts[verdict]}</b></button>"
        for verdict, meaning in VERDICTS.items()
        if verdicts[verdict]
    )
    problems = list(dict.fromkeys(text for item in standings for text in item.problems))
    mutants = [report for job, report in reports.items() if job.mutant and report.status != "not run"]
    planted = (
        f" {sum(r.status == 'fails' for r in mutants)} of {len(mutants)} planted mutants were rejected."
        if mutants
        else ""
    )
    state = f"{len(problems)} problems." if problems else "Everything that should hold holds."
    meanings = "".join(f"<dt>{badge(kind)}</dt><dd>{escape(meaning)}</dd>" for kind, meaning in KINDS.items())
    meanings += "".join(f"<dt>{badge(word)}</dt><dd>{escape(meaning)}</dd>" for word, meaning in VERDICTS.items())
    return (
        '<header class="top"><h1>Is each statement of the paper true?</h1>'
        "<p>Every numbered statement of BRIDGE with its verdict as printed, the evidence that a machine checked, a "
        "counterexample where it is false, and a statement that does hold instead.</p>"
        '<p class="title">Claims by the weakest link of their verdict, and all pieces of evidence that hold</p>'
        f'<div class="counts">{evidence}</div>'
        f'<p class="state{" bad" if problems else ""}">{len(standings)} claims, {"quick" if quick else "full"} run. '
        f"{state}{planted}</p>"
        f"<details><summary>What the words mean</summary><dl>{meanings}</dl></details>"
        f'<nav class="filters" aria-label="Show claims by verdict">{filters}'
        '<input type="search" placeholder="label or name" aria-label="Search labels and names"></nav></header>'
    )


def _pieces(count: int) -> str:
    return f"{count} piece{'' if count == 1 else 's'}"


def _repaired(standings: Sequence[Standing], reports: Mapping[Job, Report]) -> str:
    repairs = {repair.name: repair for item in standings for repair in item.claim.repairs}
    users = {
        name: [item.claim.key for item in standings if any(repair.name == name for repair in item.claim.repairs)]
        for name in repairs
    }
    articles = "".join(repair_entry(repair, users[name], reports) for name, repair in repairs.items())
    return f'<section class="theory"><h2>The repaired theory</h2>{articles}</section>' if articles else ""


def _development(standings: Sequence[Standing]) -> str:
    """The graph of the theorems, each leading to the first entry or repaired statement that it is evidence for."""
    places: dict[str, str] = {}
    for item in standings:
        for place, evidence in ((item.claim.key, item.claim.evidence), *_pieces_of(item)):
            for piece in evidence:
                if piece.check is theorem:
                    places.setdefault(piece.handle, anchor(place))
    return development(shipped(), places)


def _pieces_of(item: Standing) -> list[tuple[str, Sequence[Evidence]]]:
    return [(repair.name, repair.evidence) for repair in item.claim.repairs]


def _resource(name: str) -> str:
    return resources.files("proofs_checks.html").joinpath(name).read_text(encoding="utf-8")
