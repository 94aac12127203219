"""The ledger of the paper's statements in short: what is true, what is not, and what holds instead."""

from __future__ import annotations

import re
from collections import Counter
from functools import cache
from html import escape
from typing import Any

from experiments.report.text import table_html
from proofs_checks.ledger import missing_engines

_HEADER = ("statement", "verdict", "why", "repaired by")
ANCHOR = "ledger"


@cache
def available() -> bool:
    """Whether the engines that the ledger loads are installed."""
    return not missing_engines()


def row_anchor(source: str) -> str | None:
    """The fragment of the ledger's first row on a label of the paper, or None where there is none."""
    if not available():
        return None
    from proofs_checks.html.entry import anchor

    return f"{ANCHOR}-{anchor(source)}" if source in _labels() else None


def refuted(source: str) -> str | None:
    """How the ledger calls a label's statement that it holds to be false; "" for any other.

    None where its engines are not installed.
    """
    from experiments.compare.ledger import false_word

    return false_word(source)


def link_labels(html: str) -> str:
    """Lead from every label of the paper in some HTML text to its verdict.

    >>> link_labels("no label: none")
    'no label: none'
    """

    def linked(match: re.Match[str]) -> str:
        target = row_anchor(match.group())
        return f'<a href="#{target}">{match.group()}</a>' if target else match.group()

    return re.sub(r"\b[a-z]+(?::\w+)+", linked, html)


def ledger_html(check: str | None, jobs: int) -> str:
    """The verdict on every statement.

    Args:
        check: None shows the verdicts as recorded; ``"quick"`` and ``"full"`` replay the evidence first.
        jobs: processes of the replay.
    """
    if not available():
        return "<p>The ledger needs its engines: <code>pip install 'bridge-rl[checks]'</code> adds them.</p>"
    from proofs_checks.claim import MEANING
    from proofs_checks.html.entry import badge
    from proofs_checks.ledger import claims
    from proofs_checks.strength import weakest
    from proofs_checks.terminal import verdict_lines

    every = claims()
    counts = Counter(claim.verdict for claim in every)
    lines = verdict_lines((claim.verdict, weakest(claim)) for claim in every)
    verdicts = "".join(
        f'<div class="count"><b>{counts[verdict]}</b>{badge(verdict, meaning)}</div>'
        for verdict, meaning in MEANING.items()
        if counts[verdict]
    )
    summary = f'<p class="quiet">With the weakest link of each: {escape("; ".join(lines))}.</p>'
    rows = _rows(every)
    state = _replayed(every, check, jobs) if check else (
        '<p class="quiet">Verdicts as recorded; <code>bridge-rl check</code> replays the evidence, and '
        "<code>bridge-rl report --check quick</code> does so for this page.</p>"
    )  # fmt: skip
    table = table_html(_HEADER, rows, "ledger")
    return (
        f'<div class="counts">{verdicts}</div>{summary}{state}'
        f'<details class="long"><summary>All {len(every)} statements</summary>{table}</details>'
    )


def _rows(every: tuple[Any, ...]) -> list[tuple[str, str, str, str]]:
    from proofs_checks.claim import MEANING
    from proofs_checks.html.entry import anchor, badge, weakest_badge
    from proofs_checks.html.prose import line
    from proofs_checks.strength import weakest

    rows, seen = [], set()
    for claim in every:
        mark = "" if claim.label in seen else f' id="{ANCHOR}-{anchor(claim.label)}"'
        seen.add(claim.label)
        repairs = "<br>".join(f"{escape(repair.name)}: {escape(repair.title)}" for repair in claim.repairs)
        rows.append(
            (
                f"<span{mark}>{escape(claim.name)}</span><br><code>{escape(claim.key)}</code>",
                badge(claim.verdict, MEANING[claim.verdict]) + weakest_badge(weakest(claim)),
                line(claim.because),
                repairs,
            )
        )
    return rows


def _replayed(every: tuple[Any, ...], check: str, jobs: int) -> str:
    from proofs_checks.ledger import all_evidence
    from proofs_checks.run import jobs_for, run_all
    from proofs_checks.standing import standing

    work = jobs_for([item for claim in every for item in all_evidence(claim)], mutants=False)
    reports = run_all(work, quick=check == "quick", processes=jobs)
    ran = [report for report in reports.values() if report.status not in ("not run", "skipped")]
    problems = list(dict.fromkeys(text for claim in every for text in standing(claim, reports).problems))
    result = "".join(f'<p class="problem">{escape(text)}</p>' for text in problems) or (
        '<p class="state">Everything that should hold holds.</p>'
    )
    return f"<p>{len(ran)} of {len(work)} checks replayed for this page ({check}).</p>{result}"


@cache
def _labels() -> frozenset[str]:
    from proofs_checks.ledger import claims

    return frozenset(claim.label for claim in claims())
