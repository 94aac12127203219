"""The stored campaign is of the configurations that it names, and a session run now is the stored one."""

import json

import pytest

from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.study import prepare, run_session
from bridge_theory.errors import InputError
from experiments.asking_campaign import KEPT, SETTINGS, STORED, main, row, table

STARMDP = "StarMDP, range 5, n = 2"


def test_stored_sessions_are_of_the_named_configurations_and_rarely_wrong() -> None:
    for name, part in json.loads(STORED.read_text()).items():
        entries, seeds = SETTINGS[name]
        assert part["configuration"] == AskConfig(**entries).record()
        found = row(part)
        assert found["seeds"] == len(part["sessions"]) == seeds
        assert found["wrong"] == 0
        assert found["chance"] > 1e-3


def test_a_session_run_now_is_the_stored_one() -> None:
    stored = json.loads(STORED.read_text())[STARMDP]["sessions"]
    config = AskConfig(**SETTINGS[STARMDP][0])
    outcome = run_session(config, *prepare(config), 0)["outcome"]
    assert outcome["questions"] == stored[0]["questions"]
    assert outcome["true_gap"] == pytest.approx(stored[0]["true_gap"], abs=1e-9)
    assert set(KEPT) == set(stored[0])


def test_the_table_counts_sessions_without_a_certificate_as_infinite(capsys: pytest.CaptureFixture[str]) -> None:
    session = {"questions": None, "certified_gap": 1.0, "true_gap": 0.0, "covered": True, "candidates": 2}
    part = {"configuration": {"max_questions": 7}, "sessions": [session] * 3}
    assert "> 7" in table({"a setting": part})
    assert main(["--show"]) == 0
    assert STARMDP in capsys.readouterr().out
    with pytest.raises(InputError, match="a setting must be one of"):
        main(["nothing"])
