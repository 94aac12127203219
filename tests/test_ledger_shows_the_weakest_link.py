"""No claim shows more than its weakest necessary link, and evidence that is called exact compares no floats."""

from __future__ import annotations

import json
from html import escape
from typing import Any

import pytest
from float_comparisons import is_float, noted

from experiments.compare.ledger import false_word
from experiments.report.ledger import ledger_html
from proofs_checks import cli
from proofs_checks.claim import Claim, Link, Repair, link
from proofs_checks.context import Context
from proofs_checks.evidence import STRENGTH, Evidence, Kind, cited, exact, mutant, proved, proved_step
from proofs_checks.html.entry import anchor, entry
from proofs_checks.ledger import all_evidence, claims, evidence_by_key, repairs, resting_on
from proofs_checks.outcome import Outcome
from proofs_checks.record import record
from proofs_checks.run import Job, Report
from proofs_checks.standing import standing
from proofs_checks.strength import weakest
from proofs_checks.terminal import table, verdict_lines

CLAIMS_CALLED_TRUE = [claim for claim in claims() if claim.verdict.startswith("true")]
EXACT: tuple[Kind, ...] = ("proved", "refuted", "step proved", "exact on instances")


def first(*, size: int = 0) -> Outcome:
    return Outcome(1)


def second(*, size: int = 0) -> Outcome:
    return Outcome(1)


def step(*, size: int = 0) -> Outcome:
    return Outcome(1)


FIRST = proved("first", first, mutant("wrong", size=1))
SECOND = exact("second", second, mutant("wrong", size=1))
STEP = proved_step("step", step, mutant("wrong", size=1))


def claim(*links: Link, proof: str = "text", **changes: Any) -> Claim:
    given: dict[str, Any] = {
        "label": "local:kappa", "name": "n", "topic": "setting", "verdict": "true", "statement": "s", "because": "b",
        "evidence": (FIRST, SECOND, STEP, cited("a book")), "links": links, "proof": proof,
    }  # fmt: skip
    return Claim(**given | changes)


def reports(*held: Evidence) -> dict[Job, Report]:
    return {Job(item.key): Report(Job(item.key), "holds", "", 1, 0.0) for item in held}


def by_hand(statement: Claim | Repair) -> Kind:
    """The weakest link from the definition: over the links the worst, over what supports a link the best."""
    worst = 0
    for one in statement.links:
        best = len(STRENGTH) if one.by else STRENGTH.index("text")
        for part in one.by:
            kinds = [by_hand(part)] if isinstance(part, Repair) else [
                item.kind for item in statement.evidence if item.handle == part
            ]  # fmt: skip
            best = min(best, *map(STRENGTH.index, kinds))
        worst = max(worst, best)
    return STRENGTH[worst]


@pytest.mark.parametrize(
    ("links", "shown"),
    [
        ((link("a", "first"),), "proved"),
        ((link("a", "first"), link("b", "second")), "exact on instances"),
        ((link("a", "first", "second"),), "proved"),
        ((link("a", "first"), link("b", "step"), link("the rest")), "text"),
        ((link("a", "first"), link("b", "cited")), "cited"),
        ((link("a", "second"), link("b", "step")), "exact on instances"),
        ((link("a", Repair("X", "t", "s", (SECOND,))), link("b", "first")), "exact on instances"),
    ],
)
def test_a_chain_is_as_strong_as_its_weakest_link(links: tuple[Link, ...], shown: Kind) -> None:
    assert weakest(claim(*links)) == shown


def test_a_link_that_did_not_hold_leaves_the_whole_without_evidence() -> None:
    two = claim(link("a", "first"), link("b", "second"))
    assert standing(two, reports(FIRST, SECOND)).weakest == "exact on instances"
    found = standing(two, reports(FIRST))
    assert (found.weakest, found.unsupported) == (None, True)
    assert found.links == (("a", "proved"), ("b", None))


def test_links_that_lead_nowhere_are_refused() -> None:
    with pytest.raises(TypeError, match="links to nothing"):
        claim(link("a", "nothing"))
    with pytest.raises(TypeError, match="has none"):
        claim(link("a", "first"), link("in words"), proof="")
    with pytest.raises(TypeError, match="all steps"):
        claim(link("a", "step"))
    with pytest.raises(TypeError, match="say in its links"):
        claim()
    with pytest.raises(TypeError, match="say in its links"):
        claim(evidence=(STEP,))


def test_every_statement_called_true_and_every_repaired_one_has_links() -> None:
    assert len(CLAIMS_CALLED_TRUE) >= 28
    assert [item.name for item in (*CLAIMS_CALLED_TRUE, *repairs()) if not item.links] == []


def test_what_a_link_rests_on_is_run_and_shown() -> None:
    shown = {repair.name for repair in repairs()}
    for one in claims():
        assert {repair.name for repair in resting_on(one)} <= shown
        keys = {item.key for item in all_evidence(one)}
        assert {item.key for repair in resting_on(one) for item in repair.evidence} <= keys


def test_no_claim_shows_a_standing_stronger_than_its_weakest_link() -> None:
    everything = reports(*evidence_by_key().values())
    for one in claims():
        found = standing(one, everything)
        wanted = by_hand(one) if one.links else None
        assert found.weakest == wanted == weakest(one), one.key
        assert record(found, everything)["weakest"] == wanted
        assert f">{wanted}</span>" in entry(found, everything).split("</header>")[0] or wanted is None
        row = table([found], width=None, colour=False).splitlines()[1]
        assert f"  {one.verdict}  " in row
        assert f"  {wanted or '-'}  " in row
    for repair in repairs():
        assert weakest(repair) == by_hand(repair), repair.name


@pytest.mark.parametrize("one", CLAIMS_CALLED_TRUE, ids=lambda one: one.key)
def test_losing_any_link_is_seen(one: Claim) -> None:
    for index, lost in enumerate(one.links):
        for part in (*one.evidence, *(item for repair in lost.by if isinstance(repair, Repair) for item in
                                      repair.evidence)):  # fmt: skip

            def holds(item: Evidence, part: Evidence = part) -> bool:
                return item.key != part.key

            shown = weakest(one, holds)
            assert shown is None or STRENGTH.index(shown) >= STRENGTH.index(by_hand(one)), (one.key, index)


def test_a_statement_of_order_is_refuted_along_a_family_or_in_words() -> None:
    false = [one for one in claims() if one.verdict == "false" and "O(" in one.statement]
    orders = [one for one in false if "operations" not in one.statement]  # a count of operations is not what is refuted
    alone = [one.key for one in orders if not any("unbounded" in part.by or not part.by for part in one.links)]
    assert len(orders) > 10
    assert alone == []


def test_the_list_the_counts_and_the_report_tell_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--list"]) == 0
    listed = capsys.readouterr().out.splitlines()
    page = ledger_html(None, 1)
    for one, line in zip(claims(), listed, strict=True):
        kind = weakest(one)
        assert line.startswith(
            f"{one.key}  ({one.verdict}" + (f"; {kind})" if kind not in (None, one.verdict) else ")")
        )
        if one.verdict.startswith("true"):
            row = page.split(f"<code>{escape(one.key)}</code>")[1].split("</tr>")[0]
            assert f">{kind}</span>" in row, one.key
    lines = verdict_lines((one.verdict, weakest(one)) for one in claims())
    assert all(line in page for line in lines)
    assert sum(int(line.split()[0]) for line in lines) == len(claims())


def test_what_is_false_by_a_weaker_link_says_so() -> None:
    words = {one.label: false_word(one.label) for one in claims() if one.verdict == "false" and not one.part}
    argued = "false by an argument in words"
    assert words["lem:transition_covering_number_stationary_tabular_stochastic_transitions"] == (
        "false given a cited theorem"
    )
    assert {label for label, word in words.items() if word == argued} >= {
        "thm:main_simplified", "local:main_simplified_display", "lem:online_confidence_set",
        "local:regime_large_horizon",
    }  # fmt: skip
    assert words["thm:main_known"] == "false"
    assert false_word("local:kappa") == ""


def test_the_json_names_what_shows_each_link(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--only", "local:hellinger_recursion", "--json", "--quick", "--jobs", "1"]) == 0
    (found, _) = json.loads(capsys.readouterr().out)["claims"]
    assert [part["says"] for part in found["links"]] == ["the recursion"]
    assert found["weakest"] == found["links"][0]["shown"]
    assert {piece["check"] for piece in found["evidence"]} >= set(found["links"][0]["by"])


def test_anchors_and_kinds_have_no_surprises() -> None:
    assert len({anchor(one.key) for one in claims()}) == len(claims())
    assert is_float(1.0)
    assert is_float([1, (2, 3.0)])
    assert not is_float(1)


def test_comparisons_of_floats_are_seen_and_the_code_is_put_back() -> None:
    from proofs_checks.offline.checks import covering, distances

    before = covering.covering_number_grid.__code__
    with noted() as places:
        assert covering.covering_number_grid().holds
        assert {place.split(":")[0] for place in places} == {"proofs_checks.offline.checks.covering"}
        places.clear()
        assert distances.triangle().holds
        assert not places
    assert covering.covering_number_grid.__code__ is before


def test_evidence_called_exact_compares_no_floats() -> None:
    pieces = {
        key: item for key, item in evidence_by_key().items() if item.kind in EXACT and "kernel.theorem" not in key
    }
    floats = {}
    with noted() as places:
        for key, item in pieces.items():
            places.clear()
            assert item.run(Context(True, 0, key)).holds, key
            if places:
                floats[key] = sorted(places)
    assert len(pieces) > 150
    assert floats == {}
