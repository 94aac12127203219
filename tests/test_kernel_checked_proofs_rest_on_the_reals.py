"""A proof counts as checked by Coq's kernel only if it is complete and rests on the axioms of the reals alone."""

from __future__ import annotations

import os
import re
import shutil
import subprocess

import pytest

from proofs_checks.ledger import evidence_by_key
from proofs_checks.offline.checks import kernel
from proofs_checks.offline.checks.kernel import ALLOWED, assumptions, compiled, judged, theorem, unfinished

CLOSED = "Closed under the global context\n"
REALS = """Axioms:
ClassicalDedekindReals.sig_not_dec : forall P : Prop, {~ ~ P} + {~ P}
ClassicalDedekindReals.sig_forall_dec
  : forall P : nat -> Prop,
    (forall n : nat, {P n} + {~ P n}) -> {n : nat | ~ P n} + {forall n : nat, P n}
FunctionalExtensionality.functional_extensionality_dep
  : forall (A : Type) (B : A -> Type) (f g : forall x : A, B x),
    (forall x : A, f x = g x) -> f = g
"""
PROOF = "Require Import Bridge.finite_sums.\nTheorem easy : 1 + 1 = 2.\nProof. reflexivity. Qed.\n"


@pytest.fixture
def coqc() -> None:
    """Coq; a machine of one's own may lack it, the continuous integration may not."""
    if shutil.which("coqc") is None:
        if os.environ.get("CI"):
            pytest.fail("coqc must be installed where CI is set (Debian: apt install coq), got none")
        pytest.skip("coqc is not installed")


def test_what_coq_prints_is_read_entry_by_entry() -> None:
    assert assumptions(CLOSED) == set()
    assert assumptions(REALS) == ALLOWED
    assert assumptions("Axioms:\ncheat' : False\n") == {"cheat'"}
    assert assumptions("Axioms:\nA.b.cheat\n  : forall x : nat, x = x\n") == {"A.b.cheat"}
    assert assumptions("Axioms:\nf is assumed to be guarded.\n") == {"f"}


@pytest.mark.parametrize(
    "printed", ["", "Axioms:\n", "1 = 1\n", f"easy is defined\n{CLOSED}", f"{CLOSED}{REALS}", "axioms"]
)
def test_a_list_that_cannot_be_read_is_no_proof(printed: str) -> None:
    assert assumptions(printed) is None
    assert "unreadable" in judged("easy", printed).failures[0]


def test_only_the_axioms_of_the_reals_are_allowed() -> None:
    assert judged("easy", CLOSED).details == "easy: accepted by the kernel, 0 axioms of the reals"
    assert judged("easy", REALS).details == "easy: accepted by the kernel, 3 axioms of the reals"
    for cheat in ("cheat", "cheat'", "Classical_Prop.classic", "ClassicalDedekindReals.sig_forall_dec'"):
        assert judged("easy", f"{REALS}{cheat} : False\n").failures == (f"easy rests on {cheat}",)
        assert judged("easy", f"Axioms:\n{cheat}\n  : False\n").failures == (f"easy rests on {cheat}",)
    assert {axiom.split(".")[0] for axiom in ALLOWED} == {"ClassicalDedekindReals", "FunctionalExtensionality"}


@pytest.mark.parametrize(
    "cheat",
    ["Axiom c : False.", "Axioms c d : False.", "Parameter c : False.", "Parameters c : False.",
     "Conjecture c : False.", "Lemma c : False. Admitted.", "Lemma c : False. Proof. admit. Qed.",
     "Unset Guard Checking.", "#[bypass_check(guard)] Fixpoint c (n : nat) : False := c n.",
     "(* fine *) Axiom c : False. (* fine *)"],
)  # fmt: skip
def test_a_source_that_leaves_something_unproved_is_refused(cheat: str) -> None:
    assert unfinished(cheat)
    outcome = compiled("cheat", "easy", f"{PROOF}{cheat}\n")
    assert "leaves something unproved" in outcome.failures[0]


def test_words_in_comments_leave_nothing_unproved() -> None:
    assert not unfinished("(* no Axiom (* and nothing Admitted *) here either: admit *) Lemma c : True.")
    assert not unfinished("Lemma parametric : True. Proof. exact I. Qed.")


def test_without_coq_nothing_is_checked_and_nothing_is_claimed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel.shutil, "which", lambda _: None)
    outcome = theorem(file="total_variation", name="hellinger_below_total_variation")
    assert outcome.skipped
    assert not outcome.holds


def test_a_refused_compilation_is_no_proof(monkeypatch: pytest.MonkeyPatch, tmp_path: object) -> None:
    def refuses(folder: object, file: str, source: str) -> subprocess.CompletedProcess[str]:
        assert source.endswith("Print Assumptions easy.\n")
        return subprocess.CompletedProcess([], 1, CLOSED, "Error: no")

    for part in ("finite_sums.v", "finite_sums.vo"):
        (tmp_path / part).write_text("")  # type: ignore[operator]
    monkeypatch.setattr(kernel, "_compiled_library", lambda: str(tmp_path))
    monkeypatch.setattr(kernel, "_compile", refuses)
    assert compiled("easy", "easy", PROOF).failures == ("easy: the kernel refuses: Error: no",)


def test_a_proof_by_coq_is_accepted_and_a_false_one_is_not(coqc: None) -> None:
    assert compiled("easy", "easy", PROOF).details.endswith("0 axioms of the reals")
    assert "refuses" in compiled("easy", "easy", PROOF.replace("= 2", "= 3")).failures[0]
    assert "refuses" in compiled("easy", "nothing", PROOF).failures[0]


def test_an_axiom_that_hides_from_the_words_is_found_in_what_the_proof_rests_on(coqc: None) -> None:
    start = "Require Import Bridge.finite_sums Classical.\n"
    classical = f"{start}Theorem easy (P : Prop) : P \\/ ~ P.\nProof. apply classic. Qed.\n"
    assert not unfinished(classical)
    assert compiled("classical", "easy", classical).failures == ("easy rests on classic",)
    assumed = f"{start}Hypothesis wrong' : False.\nTheorem easy : 1 = 2.\nProof. destruct wrong'. Qed.\n"
    assert compiled("assumed", "easy", assumed).failures == ("easy rests on wrong'",)


KERNEL = {key: item for key, item in evidence_by_key().items() if item.check is theorem}


@pytest.mark.parametrize("key", KERNEL)
def test_the_theorems_of_the_ledger_are_checked(key: str, coqc: None) -> None:
    item = KERNEL[key]
    outcome = theorem(**item.arguments)
    assert outcome.holds, outcome.failures
    assert re.search(r"accepted by the kernel, [0-3] axioms", outcome.details)
