"""Refutations for Coq's kernel say what the stored counterexamples say, and fail on instances that violate nothing."""

from __future__ import annotations

import os
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from proofs_checks.counterexample import load
from proofs_checks.kernel import refutations
from proofs_checks.kernel.build import compile_sources, run
from proofs_checks.kernel.manifest import shipped
from proofs_checks.kernel.recorded import Record, refutation
from proofs_checks.kernel.sentences import faults
from proofs_checks.ledger import claims

SOURCES = refutations.generated(numerical=True)
NAMED = {
    "thm:main_known": "online-linear-regret", "lemma:technical_result/step-1": "offline-step-1",
    "lemma:technical_result/step-2": "offline-step-2", "lemma:technical_result/step-3": "offline-step-3",
    "lemma:technical_result": "offline-support-gap",
    "lemma:technical_result/history-dependent": "offline-history-expert",
    "local:feature_difference_main": "offline-feature-difference",
}  # fmt: skip


@pytest.fixture
def coqc() -> None:
    """Coq; a machine of one's own may lack it, the continuous integration may not."""
    if shutil.which("coqc") is None:
        if os.environ.get("CI"):
            pytest.fail("coqc must be installed where CI is set (Debian: apt install coq), got none")
        pytest.skip("coqc is not installed")


def test_every_generated_refutation_is_recorded_and_belongs_to_a_claim() -> None:
    names = {refutations.example_of(file) for file in SOURCES}
    assert names == set(Record.stored().refutations)
    told = {item.counterexample.name for claim in claims() for item in claim.evidence if item.counterexample}
    assert names <= told
    assert set(NAMED.values()) <= names


@pytest.mark.parametrize("key", NAMED)
def test_the_claims_that_matter_most_are_refuted_in_the_kernel(key: str) -> None:
    claim = next(claim for claim in claims() if claim.key == key)
    assert NAMED[key] in {item.counterexample.name for item in claim.evidence if item.counterexample}


@pytest.mark.parametrize("file", SOURCES)
def test_a_refutation_is_of_one_claim_and_plays_no_tricks(file: str) -> None:
    (statement,) = [line for line in SOURCES[file].splitlines() if line.startswith("Theorem refuted : ~ ")]
    claim = statement.removeprefix("Theorem refuted : ~ ").removesuffix(".")
    assert sum(f"Definition {claim} : Prop :=" in text for text in shipped().sources.values()) == 1
    assert faults(SOURCES[file]) == []


def test_an_instance_that_violates_nothing_refutes_nothing(coqc: None, tmp_path: Path) -> None:
    needed = ("Sums", "Process", "Mdp", "Distances", "Arithmetic", "Formulas", "Tables", "Claims", "Evaluation")
    texts = {name: shipped().sources[name] for name in needed}
    example = load("offline-step-1")
    assert compile_sources(tmp_path, {**texts, "Real": refutations.source(example)}, jobs=2) == ""
    assert (tmp_path / "Real.vo").exists()
    for number, control in enumerate(example.controls):
        harmless = replace(example, data={**example.data, **control.data})
        (tmp_path / f"Control{number}.v").write_text(refutations.source(harmless), encoding="utf-8")
        assert "Error" in run(tmp_path, "coqc", "-q", "-Q", ".", "Bridge", f"Control{number}.v").stderr
    assert example.controls
    assert not list(tmp_path.glob("Control*.vo"))


def test_what_is_shown_beside_a_counterexample_is_recorded() -> None:
    assert "refuted in Coq" in refutation("offline-step-1")
    assert refutation("offline-radius-rate") == ""
