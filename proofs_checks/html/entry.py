"""One claim, and one repaired statement, as articles of the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from urllib.parse import quote

from proofs_checks.claim import MEANING, Repair
from proofs_checks.evidence import MEANING as KINDS
from proofs_checks.evidence import Evidence, Kind
from proofs_checks.html.instance import instance
from proofs_checks.html.prose import line, paragraphs, sentence
from proofs_checks.kernel.recorded import refutation
from proofs_checks.ledger import formula_evidence
from proofs_checks.run import Job, Report
from proofs_checks.standing import Standing, item_holds
from proofs_checks.strength import link_kind, weakest

Reports = Mapping[Job, Report]


def entry(item: Standing, reports: Reports) -> str:
    """The article of one claim."""
    claim = item.claim
    part = f' <span class="part">{escape(claim.part)}</span>' if claim.part else ""
    title = claim.name[:1].upper() + claim.name[1:]
    verdict = badge(claim.verdict, MEANING[claim.verdict]) + weakest_badge(item.weakest)
    parts = [
        f'<header><h3><a href="#{anchor(claim.key)}">{escape(title)}</a></h3>{verdict}'
        f'<p class="where">{escape(claim.kind)} <code>{escape(claim.label)}</code>{part}</p></header>',
        f'<div class="statement">{paragraphs(claim.statement)}</div>',
        _listed("Assumptions", claim.assumptions),
        f'<div class="because">{paragraphs(claim.because)}</div>',
        *(f'<p class="problem">{escape(text)}</p>' for text in item.problems),
        *(instance(piece.counterexample) for piece in claim.evidence if piece.counterexample is not None),
        _links(item.links),
        _evidence(claim.evidence, reports),
        *(_repaired(repair) for repair in claim.repairs),
        _folded("Proof" if claim.verdict.startswith("true") else "Details", claim.proof),
    ]
    if any(piece.check for piece in claim.evidence) or claim.repairs:
        parts.append(f"<p class=\"replay\">Replay: <code>bridge-rl check --only '{escape(claim.key)}'</code></p>")
    if claim.search is not None:
        parts.append(f"<p class=\"replay\">Attack: <code>bridge-rl check --search '{escape(claim.key)}'</code></p>")
    words = escape(f"{claim.key} {claim.name}".lower())
    return (
        f'<article id="{anchor(claim.key)}" data-verdict="{escape(claim.verdict)}" data-topic="{claim.topic}" '
        f'data-words="{words}">{"".join(parts)}</article>'
    )


def repair_entry(repair: Repair, users: Sequence[str], reports: Reports) -> str:
    """The article of one repaired statement; ``users`` are the keys of the claims that it serves."""
    serves = ", ".join(f'<a href="#{anchor(key)}"><code>{escape(key)}</code></a>' for key in users)
    formulas = ", ".join(f"<code>bridge_theory.{escape(name)}</code>" for name in repair.formulas)

    def holds(piece: Evidence) -> bool:
        return item_holds(piece, reports)

    return (
        f'<article id="{anchor(repair.name)}" class="repair"><header><h3><a href="#{anchor(repair.name)}">'
        f"{escape(repair.name)}: {escape(repair.title)}</a></h3>{weakest_badge(weakest(repair, holds))}</header>"
        f'<div class="statement">{paragraphs(repair.statement)}</div>{_listed("Assumptions", repair.assumptions)}'
        f"{_links([(one.says, link_kind(one, repair.evidence, holds)) for one in repair.links])}"
        f"{_evidence((*repair.evidence, *formula_evidence(repair)), reports)}{_folded('Proof', repair.proof)}"
        + (f'<p class="quiet">Computed by {formulas}.</p>' if formulas else "")
        + f'<p class="quiet">Serves {serves}.</p>'
        f"<p class=\"replay\">Replay: <code>bridge-rl check --only '{escape(repair.name)}'</code></p></article>"
    )


def anchor(key: str) -> str:
    """A fragment identifier for a label, a part or the name of a repaired statement."""
    return quote(key.replace(" ", "_").replace("/", "--"), safe=":-_")


def badge(word: str, meaning: str = "") -> str:
    """A verdict or a kind of evidence, coloured by its class."""
    kind = word.replace(",", "").replace(" ", "-")
    return f'<span class="badge {kind}" title="{escape(meaning)}">{escape(word)}</span>'


def weakest_badge(kind: Kind | None) -> str:
    """How far a statement is shown at its weakest link; nothing where it needs none."""
    return f'<span class="quiet weakest">weakest link {badge(kind, KINDS[kind])}</span>' if kind else ""


def _links(links: Sequence[tuple[str, Kind | None]]) -> str:
    rows = "".join(f"<li>{badge(kind or 'not run')} {line(sentence(says))}</li>" for says, kind in links)
    return f'<p class="title">What has to hold for it</p><ul class="links">{rows}</ul>' if len(links) > 1 else ""


def _repaired(repair: Repair) -> str:
    return (
        f'<div class="repaired"><p class="title">Repaired, {escape(repair.name)}: {escape(repair.title)}</p>'
        f"{paragraphs(repair.statement)}"
        f'<p class="quiet"><a href="#{anchor(repair.name)}">assumptions, proof and evidence</a></p></div>'
    )


def _evidence(items: Sequence[Evidence], reports: Reports) -> str:
    rows = "".join(f"<li>{_piece(item, reports)}</li>" for item in items)
    return f'<ul class="evidence">{rows}</ul>' if rows else ""


def _piece(item: Evidence, reports: Reports) -> str:
    words = _replayed(item.counterexample.name) if item.counterexample else line(sentence(item.words))
    text = f"{badge(item.kind)} {words}"
    if (report := reports.get(Job(item.key))) is None:
        return text if item.check is None else f'{text} <span class="quiet">Not run.</span>'
    tried = [reports[job] for mutant in item.mutants if (job := Job(item.key, mutant.name)) in reports]
    ran = sum(found.status != "not run" for found in tried)
    rejected = sum(found.status == "fails" for found in tried)
    mutants = f" Mutants rejected: {rejected} of {ran}." if ran else ""
    mark = {"holds": "✓", "skipped": "skipped:", "not run": "–"}.get(report.status, f"{report.status}:")
    detail = "" if item.counterexample is not None and report.status == "holds" else f"{report.detail}."
    return (
        f'{text} <span class="result {report.status.replace(" ", "-")}">{mark} {escape(detail)} '
        f"{report.seconds:.2f} s.{mutants}</span>"
    )


def _replayed(name: str) -> str:
    in_coq = refutation(name)
    return f"Replayed in exact arithmetic; {escape(in_coq)}." if in_coq else "Replayed in exact arithmetic."


def _listed(title: str, sentences: Sequence[str]) -> str:
    rows = "".join(f"<li>{line(sentence(text))}</li>" for text in sentences)
    return f'<div class="assumptions"><p class="title">{title}</p><ul>{rows}</ul></div>' if rows else ""


def _folded(title: str, text: str) -> str:
    return f"<details><summary>{title}</summary>{paragraphs(text)}</details>" if text else ""
