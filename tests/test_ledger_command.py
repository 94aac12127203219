"""``bridge-rl check`` prints, filters, exports, attacks, and tells by its exit status whether anything is wrong."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge_theory.errors import InputError
from proofs_checks import attack, cli
from proofs_checks.claim import Claim
from proofs_checks.evidence import exact, mutant, refuted, unsettled
from proofs_checks.kernel.recorded import counts
from proofs_checks.ledger import claims
from proofs_checks.outcome import Outcome
from proofs_checks.search import Attempt, Search
from proofs_checks.standing import standing
from proofs_checks.terminal import table


def below(*, limit: int = 3) -> Outcome:
    return Outcome(1) if limit > 2 else Outcome(1, ("too small",))


def growing_vectors(_: np.random.Generator) -> Iterator[Attempt]:
    size = 0
    while True:
        size += 1
        yield Attempt(size / 3, {"vector": [str(size)]} if size > 1 else {})


@pytest.fixture
def ledger(monkeypatch: pytest.MonkeyPatch) -> Any:
    def install(*items: Claim) -> None:
        for module in ("proofs_checks.ledger", "proofs_checks.cli", "proofs_checks.attack"):
            monkeypatch.setattr(f"{module}.claims", lambda: items)
        evidence = {e.key: e for claim in items for e in claim.evidence if e.check}
        monkeypatch.setattr("proofs_checks.run.evidence_by_key", lambda: evidence)

    return install


def claim(planted: int = 2, **changes: Any) -> Claim:
    given: dict[str, Any] = {
        "label": "local:kappa", "name": "a number", "topic": "setting", "verdict": "true", "statement": "$x$",
        "because": "It is.", "evidence": (exact("a number", below, mutant("planted", limit=planted)),),
    }  # fmt: skip
    return Claim(**given | changes)


def test_everything_holds_exits_with_0_and_says_so(ledger: Any, capsys: pytest.CaptureFixture[str]) -> None:
    ledger(claim())
    assert cli.main(["--jobs", "1", "--mutants"]) == 0
    out = capsys.readouterr().out
    assert "mutants: 1 of 1 rejected" in out
    assert "everything that should hold holds" in out


def test_a_surviving_mutant_exits_with_1_and_is_named(ledger: Any, capsys: pytest.CaptureFixture[str]) -> None:
    ledger(claim(planted=9))
    assert cli.main(["--jobs", "1"]) == 0
    assert cli.main(["--jobs", "1", "--mutants"]) == 1
    assert re.search("PROBLEM .*'planted' survives", capsys.readouterr().out)


def test_a_failing_check_exits_with_1_in_every_format(ledger: Any, capsys: pytest.CaptureFixture[str]) -> None:
    ledger(claim(evidence=(exact("a number", below, mutant("planted", limit=1), limit=0),)))
    assert cli.main(["--jobs", "1"]) == 1
    assert "too small" in capsys.readouterr().out
    assert cli.main(["--jobs", "1", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["claims"][0]["evidence"][0]["status"] == "fails"


def test_filters_choose_claims(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--topic", "experiments", "--status", "false", "--json", "--jobs", "1"]) == 0
    assert {entry["verdict"] for entry in json.loads(capsys.readouterr().out)["claims"]} == {"false"}
    assert cli.main(["--only", "fig:starMDP", "--json", "--jobs", "1"]) == 0
    assert [entry["label"] for entry in json.loads(capsys.readouterr().out)["claims"]] == ["fig:starMDP"]


def test_the_list_names_every_claim(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--list"]) == 0
    assert [line.split("  (")[0] for line in capsys.readouterr().out.splitlines()] == [c.key for c in claims()]


@pytest.mark.parametrize("width", [80, 100, 120, 200])
def test_lines_fit_the_terminal(width: int) -> None:
    lines = table([standing(claim, {}) for claim in claims()], width=width, colour=False).splitlines()
    assert len(lines) == len(claims()) + 1
    assert max(map(len, lines)) <= width


def test_json_is_complete_and_free_of_terminal_codes(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--only", "tab:continuous_embeddings", "--json", "--mutants", "--jobs", "1"]) == 0
    out = capsys.readouterr().out
    found = json.loads(out)
    evidence = found["claims"][0]["evidence"][0]
    assert {name: found[name] for name in ("kernel_checked", "kernel_refuted")} == counts()
    assert "\033" not in out
    assert evidence["counterexample"] == "apparatus-unbounded-observation"
    assert set(evidence["mutants"].values()) == {"rejected"}


def test_the_page_is_written_whole(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "new" / "ledger.html"
    assert cli.main(["--topic", "experiments", "--jobs", "1", "--html", str(target)]) == 0
    assert target.read_text(encoding="utf-8").endswith("</html>")
    assert str(target) in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--only", "nowhere"], "no claim's label contains 'nowhere'"),
        (["--status", "wrong"], "invalid choice"),
        (["--search", "fig:starMDP"], "has no search"),
        (["--budget", "-1", "--search", "fig:starMDP"], "is no time to search"),
        (["--jobs", "0", "--list"], "--jobs 0 is no number of processes"),
        (["--seed", "-1", "--list"], "--seed -1 is negative"),
    ],
)
def test_mistakes_are_explained(arguments: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        cli.main(arguments)


def search_for(relation: Any) -> Search:
    return Search("vectors are short", "squared-norm-against-dimension", "x", relation, "y", growing_vectors)


def test_a_search_certifies_and_writes_what_it_finds(
    ledger: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ledger(claim(verdict="open", evidence=(unsettled("?"),), search=search_for("<=")))
    assert attack.attack("local:kappa", seconds=5, seed=0, directory=tmp_path) == 0
    found = json.loads((tmp_path / "counterexample-local-kappa.json").read_text())
    assert (found["data"], found["left"]["value"], found["right"]["value"]) == ({"vector": ["4"]}, "16", "1")
    assert "VIOLATED: 16 <= 1 fails" in capsys.readouterr().out


def test_a_search_without_success_stops_in_time_and_writes_nothing(
    ledger: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ledger(claim(verdict="open", evidence=(unsettled("?"),), search=search_for(">=")))
    assert attack.attack("local:kappa", seconds=0.2, seed=0, directory=tmp_path) == 0
    assert "no violation was certified" in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == []


def test_refuted_claims_of_the_ledger_can_be_replayed_one_by_one() -> None:
    assert refuted("apparatus-unbounded-observation").key.startswith("counterexample.replay(name=")
