"""The map of the paper names every statement of the LaTeX, no other, and knows which ones a revision changed."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from bridge_theory import paper
from bridge_theory.catalog import FORMULAS
from bridge_theory.errors import InputError
from bridge_theory.latex_statements import paragraph_around, read_statements, strip_comments

BESIDE_THE_REPOSITORY = Path(__file__).resolve().parents[3] / "shared" / "paper" / "bridge.tex"


@pytest.fixture(scope="module")
def tex() -> str:
    path = Path(os.environ.get("BRIDGE_TEX", BESIDE_THE_REPOSITORY))
    if not path.is_file():
        pytest.skip("the paper's LaTeX is not here; set BRIDGE_TEX to its path")
    return path.read_text(encoding="utf-8")


def test_every_statement_of_the_paper_has_an_entry_and_no_entry_is_invented(tex: str) -> None:
    assert list(paper.locate(tex)) != []
    assert set(paper.locate(tex)) == set(paper.entries())


def test_every_label_is_a_statement_or_a_heading(tex: str) -> None:
    source = strip_comments(tex)
    labels = set(re.findall(r"\\label(?:\[\w+\])?\{([^}]*)\}", source))
    headings = {
        match[1]
        for line in re.findall(r"\\(?:sub)*section.*(?:\n\\label.*)?", source)
        if (match := re.search(r"\\label\{([^}]*)\}", line))
    }
    assert labels - headings == {name for name in paper.entries() if not name.startswith("local:")}


def test_entries_record_what_the_paper_says_about_them(tex: str) -> None:
    located = paper.locate(tex)
    for name, entry in paper.entries().items():
        statement = located[name]
        assert (entry.kind, entry.title, entry.section) == (statement.kind, statement.title, statement.section)


def test_nothing_is_stale_against_the_paper_this_was_written_for(tex: str) -> None:
    assert paper.stale_entries(tex) == ()


def test_a_changed_constant_makes_exactly_its_statement_stale(tex: str) -> None:
    revised = tex.replace(r"\sqrt{4 \cdot |\statespace| \cdot \log(|\actionspace| \cdot 2/\delta)}", r"\sqrt{|S|}", 1)
    assert revised != tex
    assert paper.stale_entries(revised) == ("thm:tabular_confidence_set",)


def test_comments_and_line_breaks_make_nothing_stale(tex: str) -> None:
    revised = tex.replace("Then, with probability", "Then, % a remark\n   with probability")
    assert revised != tex
    assert paper.stale_entries(revised) == ()


def test_a_removed_label_is_stale_and_its_statement_shows_as_unnamed(tex: str) -> None:
    revised = tex.replace(r"\label{thm:main_known}", "")
    assert paper.stale_entries(revised) == ("thm:main_known",)
    assert [name for name in paper.locate(revised) if name.startswith("unnamed:theorem")] != []


def test_a_new_statement_shows_as_unknown(tex: str) -> None:
    revised = tex.replace(r"\end{document}", r"\begin{lemma}\label{lem:new} $1=1$ \end{lemma}\end{document}")
    assert set(paper.locate(revised)) - set(paper.entries()) == {"lem:new"}


def test_a_label_given_to_an_unlabelled_statement_replaces_its_local_name(tex: str) -> None:
    revised = tex.replace(r"\begin{lemma}[Concentrability coefficient bound] ", r"\begin{lemma}\label{lem:new}", 1)
    assert paper.stale_entries(revised) == ("local:concentrability_main",)
    assert set(paper.locate(revised)) - set(paper.entries()) == {"lem:new"}


def test_statements_are_found_by_label_by_anchor_and_by_paragraph() -> None:
    lemma, passage = paper.entry("local:regret_known_dynamics"), paper.entry("local:kappa")
    found = paper.locate(
        rf"""\section{{A}} \begin{{lemma}} {lemma.anchor} \end{{lemma}} \begin{{remark}} r \end{{remark}}

        Here ${passage.anchor}$ is defined. % and not here

        \begin{{lemma}} \label{{lem:b}} {paper.entry("local:realizability").anchor} \end{{lemma}}"""
    )
    assert {name for name in found if not name.startswith("unnamed")} == {"lem:b", lemma.name, passage.name}
    assert [statement.kind for name, statement in found.items() if name.startswith("unnamed")] == ["remark"]
    assert found[passage.name].text.endswith("is defined. ")


def test_an_unknown_name_is_refused_with_near_names() -> None:
    with pytest.raises(InputError, match=r"no statement named 'feature_diff_b'; did you mean lemma:feature_diff_b"):
        paper.entry("feature_diff_b")
    with pytest.raises(InputError, match=r"paper\.entries\(\) lists all names"):
        paper.entry("lemma:nowhere")


def test_a_label_belongs_to_the_innermost_statement_around_it() -> None:
    tex = r"""
    \section{Bounds}\label{sec:bounds}
    \begin{theorem}[A \emph{title}] \label{thm:a} \begin{align} x \label{eq:b} \end{align}
      \begin{align*} y \end{align*} \end{theorem}
    \begin{proof} \label{proof:a} z \end{proof} \begin{proof} unlabelled \end{proof}
    \begin{figure}[ht] \caption{Small} \caption{Whole} \label{fig:c} \end{figure} \begin{table} \end{table}"""
    found = [(s.kind, s.title, s.section, s.labels) for s in read_statements(tex)]
    assert found == [
        ("theorem", r"A \emph{title}", "sec:bounds", ("thm:a",)),
        ("align", "", "sec:bounds", ("eq:b",)),
        ("proof", "", "sec:bounds", ("proof:a",)),
        ("figure", "Whole", "sec:bounds", ("fig:c",)),
        ("table", "", "sec:bounds", ()),
    ]


def test_an_environment_that_closes_nothing_is_an_error() -> None:
    with pytest.raises(ValueError, match="closes nothing open"):
        read_statements(r"\begin{lemma} \end{theorem}")


def test_fingerprints_ignore_wrapping_and_nothing_else() -> None:
    one, wrapped, other = (paragraph_around(text, "let") for text in ("let x  be", "let x\nbe", "let y be"))
    assert one.fingerprint == wrapped.fingerprint != other.fingerprint


def test_a_paragraph_is_found_only_by_an_unambiguous_anchor() -> None:
    assert paragraph_around("one\n\ntwo % hidden\n\nthree", "two").text == "two "
    with pytest.raises(LookupError, match="occurs 2 times"):
        paragraph_around("one\n\none", "one")
    with pytest.raises(LookupError, match="occurs 0 times"):
        paragraph_around("one % two", "two")


def test_every_statement_lives_in_a_formula_or_says_why_not() -> None:
    homeless = [name for name in paper.entries() if not paper.where(name)]
    assert homeless == []
    assert paper.where("local:beta_t") == "bridge_theory.online.confidence.beta_t"


def test_no_statement_has_both_a_formula_and_an_excuse() -> None:
    sources = {formula.source for formula in FORMULAS.values()}
    assert [name for name, entry in paper.entries().items() if entry.note and name in sources] == []


def test_every_formula_comes_from_the_paper_the_audit_or_the_companion() -> None:
    for formula in FORMULAS.values():
        assert formula.source in paper.entries() or formula.source.startswith(("audit ", "companion ")), formula


def test_statements_said_to_be_repeated_point_to_one_with_a_formula() -> None:
    repeated = [
        match[1] for e in paper.entries().values() if (match := re.search(r"same statement as (\S+?)(,|$)", e.note))
    ]
    assert len(repeated) == 5
    assert all(not paper.entry(name).note for name in repeated)
