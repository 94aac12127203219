"""A check passes only if it decided something in favour of its claim, and a claim stands only on evidence."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bridge_theory import offline_radius
from bridge_theory.errors import InputError
from proofs_checks import counterexample, ledger
from proofs_checks.claim import Claim, Repair
from proofs_checks.context import Context
from proofs_checks.counterexample import load, parse, replay
from proofs_checks.evidence import Evidence, cited, exact, mutant, proved
from proofs_checks.outcome import Outcome, Tally, skipped, together
from proofs_checks.run import Job, Report, jobs_for, run_all, run_job
from proofs_checks.standing import standing


def at_most(*, limit: int = 3, value: int = 2) -> Outcome:
    return Outcome(1) if value <= limit else Outcome(1, (f"{value} exceeds {limit}",))


def decides_nothing(*, size: int = 0) -> Outcome:
    return together(*(Outcome(1) for _ in range(size)))


def raises(*, divisor: int = 0) -> Outcome:
    return Outcome(1 // divisor)


def forgets_to_return(*, size: int = 0) -> Outcome:
    return None  # type: ignore[return-value]


def not_here(*, size: int = 0) -> Outcome:
    return skipped("the tool is not installed")


def draws(context: Context, *, limit: float = 1.0) -> Outcome:
    value = context.rng().random()
    return Outcome(1, () if value < limit else ("too large",), f"{value!r}")


SMALL = exact("a small number", at_most, mutant("limit 1", limit=1))


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Any:
    def run_one(item: Evidence, planted: str = "", **options: Any) -> Report:
        monkeypatch.setattr("proofs_checks.run.evidence_by_key", lambda: {item.key: item})
        return run_job(Job(item.key, planted), quick=options.get("quick", False), seed=options.get("seed", 0))

    return run_one


def test_a_true_statement_holds_and_its_mutant_is_rejected(run: Any) -> None:
    assert run(SMALL).status == "holds"
    assert not run(SMALL).bad
    assert run(SMALL, "limit 1").status == "fails"
    assert not run(SMALL, "limit 1").bad


@pytest.mark.parametrize(
    ("check", "status"),
    [(decides_nothing, "fails"), (raises, "error"), (forgets_to_return, "error"), (at_most, "holds")],
)
def test_only_decisions_in_favour_pass(run: Any, check: Any, status: str) -> None:
    name = {"decides_nothing": "size", "forgets_to_return": "size", "raises": "divisor"}.get(check.__name__, "limit")
    report = run(exact("words", check, mutant("another", **{name: -1})))
    assert report.status == status
    assert report.bad == (status != "holds")


def test_a_surviving_mutant_is_bad_and_so_is_one_that_raises(run: Any) -> None:
    assert run(exact("words", at_most, mutant("limit 9", limit=9)), "limit 9").bad
    assert run(exact("words", at_most, mutant("limit None", limit=None)), "limit None").bad


def test_a_skipped_check_is_neither_bad_nor_evidence(run: Any) -> None:
    item = proved("words", not_here, mutant("size 1", size=1))
    report = run(item)
    assert (report.status, report.bad) == ("skipped", False)
    claim = Claim("local:kappa", "name", "setting", "true", "statement", "because", (item,))
    found = standing(claim, {report.job: report})
    assert (found.weakest, found.unsupported, found.problems) == (None, True, ())


def test_long_checks_are_left_out_of_quick_runs(run: Any) -> None:
    item = exact("words", at_most, mutant("limit 1", limit=1), full_only=True)
    assert run(item, quick=True).status == "not run"
    assert run(item).status == "holds"


def test_a_decision_is_a_boolean() -> None:
    tally = Tally()
    tally.expect(np.bool_(True), "never")
    for undecided in (None, 1, "unknown", np.array(True)):
        with pytest.raises(TypeError, match="must be True or False"):
            tally.expect(undecided, "undecided")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="number of decisions"):
        Outcome(True, "holds")  # type: ignore[arg-type]


def test_a_check_without_a_mutant_is_refused() -> None:
    with pytest.raises(TypeError, match="plant a mutant"):
        exact("words", at_most)
    with pytest.raises(TypeError, match="changes nothing"):
        mutant("the same")
    with pytest.raises(TypeError, match="does not take size"):
        exact("words", at_most, mutant("size", size=2))
    with pytest.raises(TypeError, match="needs a check"):
        Evidence("proved", "words")


@pytest.mark.parametrize("verdict", ["true", "true, proof wrong", "false", "undefined", "cited", "open"])
def test_a_verdict_without_fitting_evidence_is_refused(verdict: Any) -> None:
    misfit = SMALL if verdict in ("false", "cited", "open") else cited("a book")
    with pytest.raises(TypeError, match="without evidence"):
        Claim("local:kappa", "name", "setting", verdict, "statement", "because", (misfit,))


def test_a_claim_names_a_statement_of_the_paper_and_a_reason() -> None:
    with pytest.raises(InputError, match="no statement named"):
        Claim("local:nowhere", "name", "setting", "definition", "statement", "because")
    with pytest.raises(TypeError, match="no reason"):
        Claim("local:kappa", "name", "setting", "definition", "statement", "")


def test_evidence_of_a_repaired_form_does_not_support_the_claim(run: Any) -> None:
    repair = Repair("X1", "title", "statement", (SMALL,))
    claim = Claim("local:kappa", "name", "setting", "open", "statement", "because", (Evidence("open", "?"),), (repair,))
    report = run(SMALL)
    found = standing(claim, {report.job: report})
    assert (found.weakest, found.repaired) == ("open", (("X1", "exact on instances"),))


def test_randomness_depends_on_the_seed_and_the_check_alone(run: Any) -> None:
    item = exact("a draw", draws, mutant("limit 0", limit=0.0))
    assert run(item).detail == run(item).detail
    assert run(item).detail != run(item, seed=1).detail


def test_results_do_not_depend_on_the_number_of_processes() -> None:
    some = [item for claim in ledger.claims() if claim.topic == "experiments" for item in ledger.all_evidence(claim)]
    jobs = jobs_for(some, mutants=True)
    alone, together_ = (run_all(jobs, quick=True, processes=n) for n in (1, 2))
    assert list(alone) == list(together_) == list(jobs)
    assert [(r.status, r.detail) for r in alone.values()] == [(r.status, r.detail) for r in together_.values()]


RECORD: dict[str, Any] = {
    "label": "tab:continuous_embeddings",
    "sentence": "A long vector.",
    "kind": "squared-norm-against-dimension",
    "data": {"vector": ["4"]},
    "left": {"latex": "x", "value": "16"},
    "relation": "<=",
    "right": {"latex": "y", "value": ["1/2", "3/2"]},
    "controls": [{"name": "short", "data": {"vector": ["1"]}}],
}


@pytest.fixture
def stored(monkeypatch: pytest.MonkeyPatch) -> Any:
    def store(**changes: Any) -> None:
        monkeypatch.setattr(counterexample, "load", lambda name: parse(name, json.loads(json.dumps(RECORD | changes))))

    return store


def test_a_counterexample_is_replayed_and_its_control_is_not_one(stored: Any) -> None:
    stored()
    assert replay(name="test").holds
    assert not replay(name="test", control="short").holds


@pytest.mark.parametrize(
    "changes",
    [
        {"data": {"vector": ["1"]}},
        {"left": {"latex": "x", "value": "17"}},
        {"right": {"latex": "y", "value": ["2", "3"]}},
        {"relation": ">="},
    ],
)
def test_a_wrong_counterexample_does_not_hold(stored: Any, changes: dict[str, Any]) -> None:
    stored(**changes)
    assert not replay(name="test").holds


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"controls": []}, "has no control"),
        ({"data": {"vector": [4.0]}}, "is a float"),
        ({"relation": "<<"}, "is none of"),
        ({"colour": "red"}, "unknown fields"),
    ],
)
def test_a_malformed_counterexample_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse("test", RECORD | changes)


def test_an_undecided_enclosure_is_no_violation() -> None:
    third, overlapping = Fraction(1, 3), (Fraction(1, 4), Fraction(1, 2))
    assert not any(counterexample.violated(relation, third, overlapping) for relation in ("<=", "<", ">=", ">", "=="))


def test_stored_counterexamples_are_read_once_and_frozen() -> None:
    example = load("apparatus-unbounded-observation")
    assert load("apparatus-unbounded-observation") is example
    assert replace(example, name="other").name == "other"


def test_statements_of_order_are_refuted_by_size_and_not_by_a_sign() -> None:
    refuting = [
        item.counterexample
        for claim in ledger.claims()
        for item in claim.evidence
        if item.counterexample is not None and "O(" in claim.statement and item.counterexample.relation == "<="
    ]
    assert len(refuting) >= 10
    for example in refuting:  # O(f) bounds by a multiple of |f|: a negative f would refute nothing
        assert _lowest(example.right.value) > 0, example.name


def test_what_the_radius_hides_belongs_to_the_dynamics_and_not_to_the_known_first_state() -> None:
    example = load("offline-hidden-visitation")
    assert int(example.data["H"]) >= 2
    point = {name: Fraction(example.data[name]) for name in ("S", "A", "H", "n", "delta")}
    for rare, side in (("rare_1", example.left), ("rare_2", example.right)):
        radius = offline_radius.enclosure(gamma_min=example.data[rare], **point)
        assert _lowest(side.value) <= radius.lower < radius.upper <= -_lowest(side.value, sign=-1)


def _lowest(value: Fraction | tuple[Fraction, Fraction], *, sign: int = 1) -> Fraction:
    return min(sign * end for end in (value if isinstance(value, tuple) else (value,)))
