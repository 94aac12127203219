"""A theorem counts as kernel-checked only if nothing is assumed, switched off, shadowed or vacuous."""

from __future__ import annotations

import os
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from proofs_checks.kernel import agreement, recorded, refutations
from proofs_checks.kernel.build import REALS, assumptions, foreign
from proofs_checks.kernel.gate import inspect
from proofs_checks.kernel.manifest import Development, Mutant, Theorem, shipped
from proofs_checks.kernel.recorded import Record, counts, expected_digest
from proofs_checks.kernel.sentences import faults, sentences

TOY = """Require Import Reals Lra.
Open Scope R_scope.
Section Doubling.
Variable x : R.
Hypothesis positive : 0 < x.
Theorem twice : x < 2 * x.
Proof. lra. Qed.
End Doubling.
Example twice_nonvacuous : 1 < 2 * 1.
Proof. apply twice. lra. Qed.
"""
EXPORTED = {"twice": Theorem("twice", "Toy", "T0", "a positive number is less than its double", "twice_nonvacuous")}
WRONG = Mutant("twice", "2 * x", "1 * x", "specialize (claim 1 ltac:(lra)). lra.")


@pytest.fixture
def coqc() -> None:
    """Coq; a machine of one's own may lack it, the continuous integration may not."""
    if shutil.which("coqc") is None:
        if os.environ.get("CI"):
            pytest.fail("coqc must be installed where CI is set (Debian: apt install coq), got none")
        pytest.skip("coqc is not installed")


def judged(folder: Path, monkeypatch: pytest.MonkeyPatch, source: str, *planted: Mutant) -> tuple[Record, str]:
    monkeypatch.setattr(refutations, "generated", lambda numerical: {})
    monkeypatch.setattr(agreement, "generated", dict)
    monkeypatch.setattr("proofs_checks.kernel.gate.expected_digest", str)  # that of the shipped sources is kept
    what = Development({"Toy": source}, EXPORTED, planted)
    record, problems = inspect(folder, what, jobs=1, numerical=False)
    return record, "; ".join(problems)


@pytest.mark.parametrize(
    "trick",
    [
        "Axiom c : False.", "Axioms c d : False.", "Parameter c : False.", "Parameters c : False.",
        "Conjecture c' : False.", "Hypothesis c : False.", "Variable c : False.", "Context (c : False).",
        "Section S. End S. Variables c : False.", "Lemma c : False. Proof. Admitted.", "Lemma c : False. Proof. admit.",
        "Lemma c : False. Proof. give_up. Qed.", "Admit Obligations.", "Unset Guard Checking.",
        "Unset Positivity Checking.", "Unset Universe Checking.", "Set Universe Polymorphism.",
        "#[bypass_check(guard)] Fixpoint c (n : nat) : False := c n.", "Local Axiom c : False.",
        "Global Parameter c : False.", "Declare Module M : T.", "Module Type T. End T.", "Module M. End M.",
        'Declare ML Module "plugin".', 'Add LoadPath "x".', 'Load "x".', "From Ltac2 Require Import Ltac2.",
        "Require Import Classical.", "From Coq Require Import ClassicalEpsilon.", "From Coq Require Import Uint63.",
        "From Other Require Import Tricks.", "Lemma c : False. Proof. native_compute. Qed.",
        "Lemma c : False. Proof. Unset Guard Checking. Qed.", "Primitive c := #int63_add.",
        "Register c as core.False.", 'Notation "x <= y" := True.', 'Infix "<" := Rgt.', 'Reserved Notation "x < y".',
        "Definition exp (x : R) := x.", "Notation Rle := Rge.", "Local Definition ln (x : R) := x.",
        "Coercion f : nat >-> R.", "Time Axiom c : False.", "Fail Axiom c : False.", "Program Definition c := 1.",
        "Unset Printing Notations.", "Instance c : False.", "Canonical c := 1.", "- Axiom c : False.",
        '(* fine *) Axiom c : False. (* fine *)', "Redirect \"x\" Check 1.",
    ],
)  # fmt: skip
def test_a_source_may_not_say(trick: str) -> None:
    assert faults(f"Lemma fine : True. Proof. exact I. Qed. {trick} Lemma also : True. Proof. exact I. Qed.")


def test_words_in_comments_and_names_are_no_tricks() -> None:
    assert not faults("(* no Axiom (* and nothing Admitted *) here either: admit *) Lemma parametric : True.")
    assert not faults("Section S. Hypothesis fine : True. Variable x : R. End S. Lemma admitted' : True.")
    assert not faults("From Coq Require Import Reals Lra. Require Import Bridge.Sums. From Bridge Require Import Mdp.")
    assert sentences("(* a.b *) Lemma x : f.(y) = 1.5. Proof. lra. Qed.")[0] == "Lemma x : f.(y) = 1.5"


@pytest.mark.parametrize("name", shipped().sources)
def test_the_shipped_sources_play_no_tricks(name: str) -> None:
    assert faults(shipped().sources[name]) == []


def test_only_the_axioms_of_the_reals_are_allowed() -> None:
    assert not foreign(REALS)
    for cheat in ("cheat", "cheat'", "classic", "Classical_Prop.classic'", "Uint63.add_spec", "Uint63.add_spec'"):
        assert foreign({*REALS, cheat}) == [cheat]
    assert not foreign({*REALS, "Uint63.add_spec", "PrimInt63.add"}, numerical=True)
    for cheat in ("cheat", "Uint63.add_spec'", "My.Uint63.add_spec", "PrimFloat.add"):
        assert foreign({*REALS, cheat}, numerical=True) == [cheat]


@pytest.mark.parametrize("printed", ["", "Axioms:\n", "1 = 1\n", "Closed\n", "x is defined\nAxioms:\nx : y", "axioms"])
def test_a_list_of_assumptions_that_cannot_be_read_is_none(printed: str) -> None:
    assert assumptions(printed) is None


def test_a_theorem_with_an_instance_and_a_refuted_mutant_counts(
    coqc: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    record, problems = judged(tmp_path, monkeypatch, TOY, WRONG)
    assert not problems
    assert set(record.theorems) == {"twice"}
    assert record.mutants == 1


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("x < 2 * x", "x < 1 * x", "the kernel refuses"),
        ("Example twice_nonvacuous", "Example other", "missing"),
        ("1 < 2 * 1.\nProof. ", "0 < 1 -> 1 < 2 * 1.\nProof. intros _. ", "has premises"),
        ("apply twice. lra", "lra", "does not apply twice"),
        ("Theorem twice", "Theorem once", "refuses"),
        ("Hypothesis positive", "End Doubling. Hypothesis positive", "outside of a section"),
    ],
)
def test_a_theorem_does_not_count(
    coqc: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, old: str, new: str, problem: str
) -> None:
    record, problems = judged(tmp_path, monkeypatch, TOY.replace(old, new))
    assert problem in problems
    assert not record.theorems


def test_an_axiom_that_the_words_do_not_show_is_found(
    coqc: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("proofs_checks.kernel.gate.faults", lambda source: [])
    assumed = TOY.replace("Section Doubling.", "Axiom lie' : False.\nSection Doubling.")
    proof = "Proof. pose proof positive. destruct lie'. Qed."
    record, problems = judged(tmp_path, monkeypatch, assumed.replace("Proof. lra. Qed.", proof))
    assert "rests on Toy.lie'" in problems
    assert not record.theorems


@pytest.mark.parametrize(
    "survivor",
    [
        replace(WRONG, new="3 * x"),
        replace(WRONG, refutation="lra."),
        replace(WRONG, refutation="admit."),
        replace(WRONG, old="7 * x"),
        replace(WRONG, old="x"),
    ],
)
def test_a_mutant_that_is_not_refuted_is_reported(
    coqc: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, survivor: Mutant
) -> None:
    record, problems = judged(tmp_path, monkeypatch, TOY, survivor)
    assert "not refuted" in problems or "must occur once" in problems
    assert record.mutants == 0


def test_the_record_is_about_the_shipped_sources() -> None:
    record = Record.stored()
    assert record.digest == expected_digest(), "run python -m proofs_checks.kernel.gate --record"
    assert set(record.theorems) == set(shipped().theorems)
    assert record.mutants == len(shipped().mutants)
    assert counts() == {"kernel_checked": len(record.theorems), "kernel_refuted": len(record.refutations)}


def test_changed_sources_are_not_those_of_the_record(monkeypatch: pytest.MonkeyPatch) -> None:
    what = shipped()
    changed = replace(what, sources={**what.sources, "Formulas": what.sources["Formulas"].replace("4 *", "5 *", 1)})
    monkeypatch.setattr(recorded, "shipped", lambda: changed)
    assert expected_digest.__wrapped__() != Record.stored().digest
