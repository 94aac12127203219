r"""The map of the paper: every statement of ``bridge.tex``, what became of it here, and whether it has changed since.

Each statement has a name: its LaTeX label, or, where the paper gives none, a stable local name that begins with
``local:``. A fingerprint of its LaTeX (comments dropped, white space collapsed) shows which entries a revised paper
makes stale. Formulas that the paper states in running text (kappa, beta_t, gamma_t) have entries too, of kind
``passage``: their paragraph.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib import resources

from bridge_theory.errors import InputError
from bridge_theory.latex_statements import (
    LatexStatement,
    paragraph_around,
    read_statements,
    strip_comments,
)


@dataclass(frozen=True)
class Entry:
    """One statement of the paper.

    Attributes:
        name: LaTeX label, or a local name ``local:...``.
        kind: theorem, lemma, corollary, definition, assumption, claim, remark, algorithm, figure, table, align (a
            numbered display), proof, or passage (a paragraph of running text).
        title: the title the paper gives it, or the caption of a float.
        section: label (or heading) of the section it stands in.
        fingerprint: SHA-256 of its normalised LaTeX.
        note: why no formula here evaluates it (``definition: ...``, ``not computable: ...``), empty where one does.
        anchor: for local names, a snippet that locates the statement in the source.
    """

    name: str
    kind: str
    title: str
    section: str
    fingerprint: str
    note: str = ""
    anchor: str = ""


@cache
def entries() -> dict[str, Entry]:
    """Every entry of the map by name, in the order of the paper.

    >>> entries()["thm:tabular_confidence_set"].title
    'Offline confidence set radius'
    """
    text = resources.files("bridge_theory").joinpath("paper_map.json").read_text(encoding="utf-8")
    return {record["name"]: Entry(**record) for record in json.loads(text)}


def entry(name: str) -> Entry:
    """The entry of one label or local name.

    Raises:
        InputError: the paper has no such statement; the message offers names that contain the text.

    >>> entry("lemma:feature_diff_bound").kind
    'lemma'
    """
    known = entries()
    if name not in known:
        near = [candidate for candidate in known if name.lower() in candidate.lower()][:5]
        hint = f"; did you mean {' or '.join(near)}?" if near else "; bridge_theory.paper.entries() lists all names"
        raise InputError(f"the paper has no statement named {name!r}{hint}")
    return known[name]


def where(name: str) -> str:
    """Where a statement lives: the dotted names of the formulas that come from it, or the note on why there is none.

    Raises:
        InputError: the paper has no such statement.

    >>> where("lemma:regret_analysis")
    'bridge_theory.regret.unknown.regret_unknown_stated'
    >>> where("eq:constr")
    'definition: the projection, computed by bridge_algos'
    """
    from bridge_theory.catalog import FORMULAS  # the map is readable without loading every formula

    note = entry(name).note
    return note or ", ".join(f"{f.function.__module__}.{f.name}" for f in FORMULAS.values() if f.source == name)


def locate(tex: str) -> dict[str, LatexStatement]:
    r"""Every statement of a LaTeX source under its name: its label, its local name, or ``unnamed:KIND:CHARACTER``.

    Args:
        tex: source of the paper (this or a revised version), comments included.

    >>> list(locate(r"\begin{lemma}\label{lem:new} x \end{lemma}"))
    ['lem:new']
    """
    source = strip_comments(tex)
    statements = read_statements(tex)
    located = {label: statement for statement in statements for label in statement.labels}
    unlabelled = {statement.start: statement for statement in statements if not statement.labels}
    for known in entries().values():
        if not known.anchor or source.count(known.anchor) != 1:
            continue
        if known.kind == "passage":
            located[known.name] = paragraph_around(tex, known.anchor)
            continue
        at = source.index(known.anchor)
        around = [s for s in unlabelled.values() if s.start <= at < s.start + len(s.text)]
        if around:
            located[known.name] = unlabelled.pop(max(s.start for s in around))
    located |= {f"unnamed:{s.kind}:{s.start}": s for s in unlabelled.values()}
    return located


def stale_entries(tex: str) -> tuple[str, ...]:
    """Names whose LaTeX differs from the one this package was written against, in the order of the map.

    A statement that has vanished from ``tex`` is stale too. Statements that are new in ``tex`` are those of `locate`
    that `entries` does not know.

    >>> len(stale_entries("")) == len(entries())
    True
    """
    located = locate(tex)
    return tuple(
        name
        for name, known in entries().items()
        if name not in located or located[name].fingerprint != known.fingerprint
    )
