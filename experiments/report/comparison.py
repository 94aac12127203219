"""Regret beside the theory: ``bridge-rl compare`` on the page."""

from __future__ import annotations

from html import escape
from pathlib import Path

from bridge_theory.errors import InputError
from experiments.compare import compare, figure, table, words
from experiments.report.ledger import link_labels
from experiments.report.pictures import picture_html
from experiments.report.text import words_html


def comparison_html(directory: Path, title: str, jobs: int) -> str:
    """Figure, table and words of the comparison, or why there is none."""
    try:
        found = compare(directory, jobs)
    except InputError as error:
        return f"<p>No comparison: {escape(str(error))}</p>"
    texts = "".join(link_labels(words_html(f"{words(item)}\n\n{table(item)}")) for item in found)
    return picture_html(figure(list(found)), f"{title}: regret beside the theory") + texts
