"""Each teacher answers with the probabilities it documents, and names the assumption it breaks."""

import numpy as np
import pytest

from bridge_algos.embeddings import make_embedding
from bridge_algos.online.oracles import BradleyTerryOracle, ReturnOracle, sigmoid
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError

N = 40_000
TOLERANCE = np.sqrt(np.log(2 / 1e-8) / (2 * N))
"""Hoeffding: a share over N answers is off by more than this with probability below 1e-8."""


def with_rewards(rewards: list[float]) -> Trajectories:
    zeros = np.zeros((N, len(rewards)), dtype=np.int64)
    return Trajectories(zeros, zeros, np.broadcast_to(np.array(rewards), (N, len(rewards))))


HIGH, LOW = with_rewards([1.0, 2.0]), with_rewards([2.0, 0.5])


@pytest.mark.parametrize(
    ("oracle", "share", "breaks"),
    [
        (ReturnOracle(), 1.0, "step function"),
        (ReturnOracle(rationality=2.0), sigmoid(np.array([1.0]))[0], "nothing"),
        (ReturnOracle(mistakes=0.25), 0.75, "flipped"),
        (ReturnOracle(equal_within=0.6), 0.5, "ties"),
        (ReturnOracle(myopia=0.1), 1.0, "late steps"),
    ],
)
def test_share_of_first_preferred(oracle: ReturnOracle, share: float, breaks: str, rng: np.random.Generator) -> None:
    assert oracle(HIGH, LOW, rng).mean() == pytest.approx(share, abs=TOLERANCE)
    assert breaks in oracle.breaks


def test_equal_returns_are_decided_by_a_fair_coin(rng: np.random.Generator) -> None:
    answers = ReturnOracle()(HIGH, HIGH, rng)
    assert set(np.unique(answers)) == {0.0, 1.0}
    assert answers.mean() == pytest.approx(0.5, abs=TOLERANCE)


def test_myopia_reverses_a_preference(rng: np.random.Generator) -> None:
    early, late = with_rewards([5.0, 0.0]), with_rewards([0.0, 1.0])
    assert ReturnOracle()(early, late, rng).all()
    assert not ReturnOracle(myopia=0.1)(early, late, rng).any()


def test_skips_are_not_answers(rng: np.random.Generator) -> None:
    oracle = ReturnOracle(skip_below=2.8)
    assert np.isnan(oracle(LOW, LOW, rng)).all()
    assert (oracle(HIGH, LOW, rng) == 1).all()


def test_bradley_terry_follows_the_logistic_model(rng: np.random.Generator) -> None:
    embedding = make_embedding("state_counts", 2, 1, 2)
    zeros = np.zeros((N, 2), dtype=np.int64)
    first, second = Trajectories(zeros, zeros), Trajectories(zeros + 1, zeros)
    oracle = BradleyTerryOracle(embedding, np.array([0.4, 0.1]))
    assert oracle(first, second, rng).mean() == pytest.approx(sigmoid(np.array([0.6]))[0], abs=TOLERANCE)
    assert oracle.breaks == "nothing"


@pytest.mark.parametrize(
    "options",
    [{"rationality": 0.0}, {"mistakes": 1.5}, {"equal_within": -1.0}, {"myopia": 0.0}, {"skip_below": float("nan")}],
)
def test_options_out_of_range_are_refused(options: dict[str, float]) -> None:
    with pytest.raises(InputError, match=next(iter(options))):
        ReturnOracle(**options)


def test_returns_must_have_been_observed(rng: np.random.Generator) -> None:
    with pytest.raises(InputError, match="rewards"):
        ReturnOracle()(Trajectories(HIGH.states, HIGH.actions), LOW, rng)
