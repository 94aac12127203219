"""The page shows every entry with its formulas rendered, needs nothing from elsewhere, and runs without an error."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

from bridge_theory import paper
from bridge_theory.errors import InputError
from proofs_checks.counterexample import load
from proofs_checks.html.diagram import diagram, drawable
from proofs_checks.html.entry import anchor
from proofs_checks.html.mathml import mathml
from proofs_checks.html.page import page
from proofs_checks.html.prose import line, paragraphs, sentence
from proofs_checks.html.sections import section_title
from proofs_checks.ledger import all_evidence, claims, repairs
from proofs_checks.run import jobs_for, run_all
from proofs_checks.standing import standing

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--hide-scrollbars",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--enable-logging=stderr",
)  # fmt: skip


@pytest.fixture(scope="module")
def document() -> str:
    """The whole ledger, with reports of the quickest topic; the others appear as not run."""
    jobs = jobs_for(
        [item for claim in claims() if claim.topic == "experiments" for item in all_evidence(claim)], mutants=True
    )
    reports = run_all(jobs, quick=True)
    return page([standing(claim, reports) for claim in claims()], reports, quick=True)


def test_every_text_of_the_ledger_converts() -> None:
    wrong = []
    for item in [*claims(), *repairs()]:
        texts = [item.statement, item.proof, *item.assumptions, *(piece.words for piece in item.evidence)]
        for text in [*texts, getattr(item, "because", "")]:
            try:
                paragraphs(text)
            except InputError as mistake:
                wrong.append(f"{item.name}: {mistake}")
    assert wrong == []


def test_every_claim_and_repaired_form_has_an_article(document: str) -> None:
    articles = set(re.findall(r'<article id="([^"]*)"', document))
    assert articles == {anchor(claim.key) for claim in claims()} | {anchor(repair.name) for repair in repairs()}
    assert set(re.findall(r'href="#([^"]*)"', document)) <= articles


def test_every_counterexample_is_shown(document: str) -> None:
    for claim in claims():
        for item in claim.evidence:
            if item.counterexample is not None:
                assert f"counterexamples/{item.counterexample.name}.json" in document


def test_no_raw_latex_is_left(document: str) -> None:
    body = re.sub(r"<(style|script)>.*?</\1>", "", document, flags=re.DOTALL)
    assert re.findall(r"\\[A-Za-z]+|\$", re.sub(r"<[^>]*>", " ", body)) == []


def test_every_section_has_a_title() -> None:
    titles = {section_title(entry.section) for entry in paper.entries().values()}
    assert [title for title in titles if re.search(r"^(sub)?sec:|^app(dx)?:|[\\_]", title)] == []


def test_nothing_is_loaded_from_elsewhere(document: str) -> None:
    assert re.findall(r'(?:src|href)="(?!#|data:)[^"]*"|url\((?!#)[^)]*\)|@import', document) == []


def test_diagrams_are_well_formed_and_name_every_state() -> None:
    names = {item.counterexample.name for c in claims() for item in c.evidence if item.counterexample is not None}
    drawn = [load(name).data for name in sorted(names) if drawable(load(name).data)]
    for data in drawn:
        tree = ElementTree.fromstring(diagram(data))
        circles = [element for element in tree.iter("circle") if element.get("class") == "state"]
        assert len(circles) == len(data["states"])


def test_an_arrow_carries_the_probability_of_each_kernel_that_takes_it() -> None:
    data = {
        "states": ["s", "x"],
        "initial": ["1", "0"],
        "kernels": {"P^*": [[["1/3", "2/3"]], [["0", "1"]]], r"\hat P": [[["1", "0"]], [["0", "1"]]]},
    }
    texts = ["".join(text.itertext()) for text in ElementTree.fromstring(diagram(data)).iter("text")]
    assert texts == ["P* 2/3", "P* 1/3P̂ 1", "s", "x"]


@pytest.mark.parametrize(
    ("latex", "expected"),
    [
        (r"\log n", '<mo lspace="0" rspace="0.167em">log</mo><mi>n</mi>'),
        (r"2\log(n)", '<mn>2</mn><mo lspace="0.167em" rspace="0">log</mo>'),
        (r"\sigma'", "<mrow><mi>σ</mi>"),
        (r"x := y", "≔"),
        (r"\begin{aligned} a &= b \\ c &= d \end{aligned}", 'style="text-align: right"'),
    ],
)
def test_formulas_are_spaced_as_in_print(latex: str, expected: str) -> None:
    assert expected in mathml(latex)


@pytest.mark.parametrize("latex", [r"\nosuchmacro x", r"a & b", r"\frac{1}"])
def test_a_formula_that_cannot_be_translated_is_an_error(latex: str) -> None:
    with pytest.raises(InputError, match="cannot"):
        mathml(latex)


@pytest.mark.parametrize("text", [r"\alpha without dollars", "one $ alone"])
def test_latex_outside_of_dollars_is_an_error(text: str) -> None:
    with pytest.raises(InputError, match="outside of dollars"):
        line(text)


def test_prose_is_escaped_and_finished() -> None:
    assert line("a < b & c") == "a &lt; b &amp; c"
    assert sentence("one round") == "One round."


@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
def test_a_browser_shows_the_page_without_an_error(document: str, tmp_path: Path) -> None:
    probe = (
        "<script>addEventListener('load', () => { const flat = [...document.querySelectorAll('article math')]"
        ".filter(m => m.getBoundingClientRect().height < 4 && m.checkVisibility({contentVisibilityAuto: true}));"
        " const wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;"
        " document.querySelectorAll('.filters button').forEach(b => { b.click(); b.click(); });"
        " console.log(`ledger: ${document.querySelectorAll('article:not([hidden])').length} articles,"
        " ${document.querySelectorAll('math').length} formulas, ${flat.length} flat, ${wide} too wide`); })</script>"
    )
    file = tmp_path / "ledger.html"
    file.write_text(document.replace("</body>", f"{probe}</body>"), encoding="utf-8")
    command = [str(CHROMIUM), *FLAGS, f"--user-data-dir={tmp_path / 'profile'}", "--window-size=500,900"]
    shot = tmp_path / "page.png"
    seen = subprocess.run(
        [*command, f"--screenshot={shot}", file.as_uri()], capture_output=True, text=True, timeout=120, check=True
    )
    console = [entry for entry in seen.stderr.splitlines() if "CONSOLE" in entry]
    formulas = document.count("<math")
    assert len(console) == 1, console
    expected = f"ledger: {len(claims()) + len(repairs())} articles, {formulas} formulas, 0 flat, 0 too wide"
    assert expected in console[0]
    assert shot.stat().st_size > 10_000
