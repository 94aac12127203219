"""Rounds compare two policies while two are left; the checker holds a log to that."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bridge_algos.online import loop
from bridge_algos.online.confidence import fixed
from bridge_algos.online.loop import Learner
from bridge_algos.online.pair_rules import choose_pair
from bridge_algos.online.policy_filter import widest_pair
from bridge_algos.policies import all_policies
from bridge_algos.run.config import preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.log_file import RunLog
from bridge_algos.run.seed import run_seed
from bridge_algos.run.world import build_world
from bridge_theory.errors import InputError
from proofs_checks.verify import verify

RULES = ("uncertainty_and_bonus", "max_uncertainty", "ucb", "greedy_vs_random")


@given(st.integers(0, 10**6), st.sampled_from([1, 2, 3, 63, 64, 65, 130]), st.sampled_from([0.0, 0.1, 3.0]))
def test_the_pair_is_the_best_of_two_policies(seed: int, n: int, gamma: float) -> None:
    """One policy whose bonus dwarfs the rest would be its own best partner; features may all be equal."""
    rng = np.random.default_rng(seed)
    z, bonus, scores = rng.normal(size=(n, 2)) * rng.integers(2), rng.random(n), rng.normal(size=n)
    bonus[rng.integers(n)] += 10
    norms = gamma * np.linalg.norm(z[:, None] - z, axis=2)
    for own in (None, scores):
        values = norms + bonus[:, None] + bonus + (0 if own is None else own[:, None] - own)
        np.fill_diagonal(values, -np.inf)
        pair = widest_pair(z, gamma, bonus, own)
        if n == 1:
            assert pair == (0, 0)
        else:
            assert pair[0] != pair[1]
            assert values[pair] == pytest.approx(values.max(), abs=1e-7)


@pytest.mark.parametrize("rule", RULES)
def test_every_rule_names_two_policies_unless_one_is_left(rule, rng: np.random.Generator) -> None:
    scores, z, bonus = np.array([0.0, 1.0, 2.0]), np.zeros((3, 2)), np.array([0.1, 5.0, 0.1])
    for kept in ([1, 1, 1], [1, 1, 0], [0, 1, 1]):
        first, second = choose_pair(rule, np.array(kept, dtype=bool), scores, z, 1.0, bonus, rng)
        assert first != second
        assert kept[first]
        assert kept[second]
    assert choose_pair(rule, np.array([False, True, False]), scores, z, 1.0, bonus, rng) == (1, 1)


def test_a_run_compares_a_policy_with_itself_only_where_it_is_alone() -> None:
    config = preset("theory", "starmdp").but(algorithms=("bridge", "bridge-known", "pbrl"))
    world, alone = build_world(config), 0
    for seed in range(4):
        result = run_seed(config, world, seed)
        itself = (result["first"] == result["second"]).values
        np.testing.assert_array_equal(itself, (result.set_size == 1).values)
        alone += int(itself.sum())
    assert alone > 0


def with_itself(rule, kept, scores, z, gamma, bonus, rng):
    """The paper's arg-max where one policy's bonus is largest of all."""
    best = int(np.where(kept, bonus, -np.inf).argmax())
    return best, best


def test_a_log_that_compares_a_policy_with_itself_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    config = preset("theory", "starmdp").but(rounds=3, algorithms=("bridge",))
    world = build_world(config)
    assert verify(logged_seed(config, world, 1)[1])[0].certified
    monkeypatch.setattr(loop, "choose_pair", with_itself)
    (certificate,) = verify(logged_seed(config, world, 1)[1])
    assert not certificate.certified
    told = "round 1: the stored pair is of a policy with itself, but the policies left are claimed to be"
    assert any(told in reason for reason in certificate.reasons)


def test_a_log_that_searches_a_policy_twice_is_refused() -> None:
    config = preset("theory", "starmdp").but(rounds=3, algorithms=("bridge",))
    log = logged_seed(config, build_world(config), 1)[1]
    policies = log.arrays["bridge/policies"]
    doubled = RunLog(log.header, {**log.arrays, "bridge/policies": np.concatenate([policies, policies[:1]])})
    (certificate,) = verify(doubled)
    assert any("of them different, which no run does" in reason for reason in certificate.reasons)


def test_a_learner_takes_each_policy_once() -> None:
    twice = np.concatenate([all_policies(2, 2)] * 2)
    with pytest.raises(InputError, match="8 rows but 4 different policies, expected each once"):
        Learner("x", twice, None, fixed(1.0, 0.0, 2, 2, 3, 1.0), "ucb", 1.0)
