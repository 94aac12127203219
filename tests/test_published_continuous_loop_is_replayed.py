"""The settings of the published continuous runs do in the common loop what those runs did; torch's Adam checks it."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from bridge_algos.mdp import FloatArray
from bridge_algos.online.confidence import Confidence
from bridge_algos.online.loop import Learner, run_online
from bridge_algos.online.oracles import ReturnOracle

N, D, K, HORIZON, ROUNDS = 30, 4, 5, 3, 12
GAMMA, W = 2.0, 10.0


@dataclass
class Played:
    features: FloatArray
    rewards: FloatArray
    states: FloatArray
    actions: FloatArray
    horizon: int = HORIZON

    def __len__(self) -> int:
        return len(self.features)


class Table:
    """Policies are rows of a table; a trajectory's features and rewards are theirs plus noise."""

    def __init__(self) -> None:
        rng = np.random.default_rng(3)
        self.phi = rng.normal(size=(N, D))
        self.returns = self.phi @ rng.normal(size=D)
        self.optimum = np.array([int(self.returns.argmax())])
        self.expert_return, self.w_star = 1.0, None
        self.oracle = ReturnOracle()
        self.embedding = self
        self.dimension = D

    def of_trajectories(self, played: Played) -> FloatArray:
        return played.features

    def standing(self, policies: Any) -> tuple[FloatArray, float, bool]:
        return self.returns[policies[:, 0]], float(self.returns.max()), True

    def look(self, learner: Any, counts: Any, policies: Any, rng: Any) -> tuple[None, FloatArray, FloatArray]:
        return None, self.phi[policies[:, 0]], np.zeros(len(policies))

    def sample_pair(self, pair: Any, n: int, rng: np.random.Generator) -> tuple[Played, Played]:
        return self.sample(int(pair[0, 0]), n, rng), self.sample(int(pair[1, 0]), n, rng)

    def sample(self, i: int, n: int, rng: np.random.Generator) -> Played:
        rewards = self.returns[i] / HORIZON + 0.3 * rng.normal(size=(n, HORIZON))
        shown = np.full((n, HORIZON), i, dtype=float)
        return Played(self.phi[i] + 0.3 * rng.normal(size=(n, D)), rewards, shown, shown)


def play(rule: str, gamma: float = GAMMA, until_decided: bool = True) -> tuple[Table, dict, list]:
    confidence = Confidence("fixed", lambda _: gamma, np.zeros_like, 0, np.inf, "observed", 0.01)
    learner = Learner(
        "x", np.arange(N)[:, None], None, confidence, rule, W, lam=0.0, comparisons=K, fit="continual",  # type: ignore[arg-type]
        until_decided=until_decided,
    )  # fmt: skip
    table, log = Table(), []
    return table, run_online(table, learner, ROUNDS, np.random.default_rng(4), log.append), log


@pytest.mark.parametrize("rule", ["max_uncertainty", "greedy_vs_random", "ucb"])
def test_replay(rule: str) -> None:
    torch = pytest.importorskip("torch", reason="torch's Adam is the oracle here")
    table, record, log = play(rule)
    matrix, x, answers = 0.01 * np.eye(D), np.empty((0, D)), np.empty(0)
    w = torch.full((D,), W / D**0.5, dtype=torch.float64, requires_grad=True)
    rng = np.random.default_rng(4)
    for t, entry in enumerate(log):
        current = w.detach().numpy().copy()
        np.testing.assert_allclose(entry["w"], current, atol=1e-9)
        kept = np.ones(N, dtype=bool)
        width = np.zeros((N, N))
        for i in range(N):
            for j in range(N):
                gap = table.phi[i] - table.phi[j]
                width[i, j] = np.sqrt(gap @ np.linalg.solve(matrix, gap))
                kept[i] &= gap @ current + GAMMA * width[i, j] >= -1e-9
        np.testing.assert_array_equal(entry["kept"], kept)
        first, second = entry["pair"]
        scores = np.where(kept, table.phi @ current, -np.inf)
        if rule == "max_uncertainty":
            assert width[first, second] == pytest.approx(width[np.ix_(kept, kept)].max(), rel=1e-7)
        elif rule == "ucb":
            optimism = (table.phi @ current)[:, None] - table.phi @ current + GAMMA * width
            assert optimism[first, second] == pytest.approx(optimism[np.ix_(kept, kept)].max(), rel=1e-7)
        else:
            others = np.delete(np.flatnonzero(kept), int(scores[kept].argmax()))
            assert first == scores.argmax()
            assert second == rng.choice(others)
        one, two = (table.sample(i, K, rng) for i in (first, second))
        coins = rng.random(K), rng.random(K)
        assert len(coins) == 2
        new = (one.rewards.sum(axis=1) > two.rewards.sum(axis=1)).astype(float)
        np.testing.assert_array_equal(entry["outcomes"], new)
        gaps = one.features - two.features
        x, answers = np.concatenate([x, gaps]), np.concatenate([answers, new])
        matrix = matrix + gaps.T @ gaps
        optimiser = torch.optim.Adam([w], lr=1e-2)
        for _ in range(100):
            optimiser.zero_grad()
            logits = torch.from_numpy(x) @ w
            torch.nn.functional.binary_cross_entropy_with_logits(logits, torch.from_numpy(answers)).backward()
            optimiser.step()
        greedy = (table.phi @ w.detach().numpy()).argmax()
        assert record["greedy"][t] == greedy
        assert record["suboptimality"][t] == pytest.approx(1.0 - table.returns[greedy])
    assert len(log) == ROUNDS or record["set_size"][len(log)] == 1


def test_a_decided_learner_asks_nothing_more() -> None:
    _, record, log = play("max_uncertainty", gamma=1e-9)
    assert record["set_size"][0] == 1
    assert log == []
    assert len(set(record["greedy"])) == 1
    _, _, asked = play("max_uncertainty", gamma=1e-9, until_decided=False)
    assert len(asked) == ROUNDS
