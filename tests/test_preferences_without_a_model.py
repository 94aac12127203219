"""Without a model of utility: certificates for pairs of few items hold, and cycles have no winner."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom

from bridge_algos.asking.no_model import PairwiseSession
from bridge_algos.asking.session_file import load_session
from bridge_algos.asking.stakes import excluded, lower_bound
from bridge_theory.errors import InputError
from experiments.cli import main

CYCLE = np.array([[0.5, 0.9, 0.1], [0.1, 0.5, 0.9], [0.9, 0.1, 0.5]])


def _run(chances: np.ndarray, eps: float, seed: int, most: int = 2000) -> PairwiseSession:
    rng = np.random.default_rng(seed)
    session = PairwiseSession(len(chances), eps, 0.05, rng)
    while not session.done and len(session.history) < most:
        question = session.ask()
        session.tell(question, int(rng.random() < chances[question.first, question.second]))
    return session


def test_the_mean_stake_is_one_and_reaches_its_level_seldom_exactly() -> None:
    """All paths of 60 answers, by dynamic programming: the true p is ever excluded with probability at most 1/20."""
    for p in (0.4, 0.5, 0.9):
        alive, gone = {0: 1.0}, 0.0
        for t in range(1, 61):
            after: dict[int, float] = {}
            for won, mass in alive.items():
                for step, chance in ((1, p), (0, 1 - p)):
                    after[won + step] = after.get(won + step, 0.0) + mass * chance
            out = [won for won in after if excluded(p, won, t - won, np.log(20))]
            gone += sum(after.pop(won) for won in out)
            alive = after
        assert gone <= 0.05
        assert gone > 0.001


def test_certified_winners_are_winners() -> None:
    """Of 60 sessions at delta = .05 more than 14 fail with probability below 1e-6."""
    assert binom.sf(14, 60, 0.05) < 1e-6
    eps, wrong, certified = 0.1, 0, 0
    for seed in range(60):
        rng = np.random.default_rng(1000 + seed)
        chances = np.full((3, 3), 0.5)
        for i, j in ((0, 1), (0, 2), (1, 2)):
            chances[i, j] = rng.uniform(0.3, 0.7)
            chances[j, i] = 1 - chances[i, j]
        session = _run(chances, eps, seed, 600)
        fine = (chances >= 0.5 - eps).all(axis=1)
        wrong += (session.certified and not fine[session.recommended]) or (session.no_winner and fine.any())
        certified += session.certified
    assert wrong <= 14
    assert certified >= 20


def test_a_cycle_has_no_winner() -> None:
    for seed in range(10):
        session = _run(CYCLE, 0.2, seed)
        assert session.no_winner
        assert not session.certified
        assert "No winner at eps = 0.2" in session.certificate.sentence
    with pytest.raises(InputError, match="nothing is left to ask"):
        session.ask()


def test_a_winner_is_certified_in_words() -> None:
    session = _run(np.array([[0.5, 0.8], [0.2, 0.5]]), 0.1, 0)
    certificate = session.certificate
    assert session.recommended == 0
    assert certificate.certified
    assert 0.4 <= certificate.least <= 0.8
    assert "preferred to every other with probability at least 0.4" in certificate.sentence


def test_preferences_that_drift_are_called_so() -> None:
    session = PairwiseSession(3, 0.1, 0.05, np.random.default_rng(0))
    for answer in [1] * 40 + [0] * 400:
        session._pending = None
        question = session.ask() if not session.done else None
        if question is None:
            break
        object.__setattr__(question, "first", 0)
        object.__setattr__(question, "second", 1)
        session.tell(question, answer)
    assert session.contradicted
    assert not session.certified
    assert "stay the same" in session.certificate.sentence


def test_a_session_without_a_model_goes_on_where_it_stopped() -> None:
    session = _run(CYCLE, 0.2, 3, most=20)
    resumed = PairwiseSession(3, 0.2, 0.05, np.random.default_rng(9))
    resumed.restore(json.loads(json.dumps(session.record())))
    assert resumed.ask() == session.ask()
    with pytest.raises(InputError, match="same arguments"):
        PairwiseSession(3, 0.3, 0.05, np.random.default_rng(9)).restore(session.record())


def test_lower_bounds_are_excluded_below_and_not_above() -> None:
    low = lower_bound(60, 40, 3.0)
    assert excluded(low, 60, 40, 3.0)
    assert not excluded(low + 1e-6, 60, 40, 3.0)


@pytest.mark.parametrize(
    ("items", "eps", "delta", "words"),
    [
        (0, 0.1, 0.05, "items must be a whole number"),
        (51, 0.1, 0.05, "items must be a whole number"),
        (True, 0.1, 0.05, "items must be a whole number"),
        (3, 0.5, 0.05, "eps must lie strictly"),
        (3, float("nan"), 0.05, "eps must lie strictly"),
        (3, 0.1, 0.0, "delta must lie strictly"),
    ],
)
def test_wrong_settings_are_one_sentence(items: int, eps: float, delta: float, words: str) -> None:
    with pytest.raises(InputError, match=words):
        PairwiseSession(items, eps, delta, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--model", "none", "--until", "5%"], "--until needs a model"),
        (["--model", "none", "--asking", "random"], "--asking needs a model"),
        (["--eps", "0.1"], "--eps belongs to --model none"),
        (["--model", "none", "--eps", "0.7"], "eps must lie strictly"),
        (["--model", "none", "--demonstrations", "0", "--jobs", "1"], "at most 50 candidates, got 1024"),
    ],
)
def test_mistakes_on_the_command_line_are_one_sentence(
    arguments: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["ask", "starmdp", "--seeds", "1", "--out", str(tmp_path), *arguments]) == 2
    assert words in capsys.readouterr().err


def test_sessions_without_a_model_are_stored_and_told_apart(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = ["ask", "starmdp", "--model", "none", "--eps", "0.2", "--seeds", "1", "--jobs", "1", "--out", str(tmp_path)]
    assert main([*line, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["model"] == "none"
    assert found["certified"] == 1
    assert main(line) == 0  # from the stored session
    assert "preferred to every other candidate with probability at least 0.3" in capsys.readouterr().out
    with pytest.raises(InputError, match="a file of another kind, expected a 'bridge-rl asking session'"):
        load_session(tmp_path / "session-0000.json")
    capsys.readouterr()
    assert main(["verify", str(tmp_path)]) == 2  # nothing is said of it, rather than something wrong
    assert "a session without a model of utility, which is not verified" in capsys.readouterr().err
