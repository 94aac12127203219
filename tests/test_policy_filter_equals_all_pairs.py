"""Pi_t and the arg-max pair equal a naive evaluation of all pairs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bridge_algos.online.pair_rules import choose_pair
from bridge_algos.online.policy_filter import surviving, whiten, widest_pair
from bridge_theory.errors import InputError


def instance(seed: int, n: int, d: int, spread: float):
    rng = np.random.default_rng(seed)
    features = spread * rng.normal(size=(n, d))
    matrix = np.eye(d) + features[: d + 2].T @ features[: d + 2]
    return features, matrix, rng.normal(size=d), 0.1 * rng.random(n)


def naive(features, matrix, w, gamma, bonus):
    difference = features[:, None] - features[None]
    norms = np.sqrt(np.einsum("ijk,kl,ijl->ij", difference, np.linalg.inv(matrix), difference))
    kept = (difference @ w + gamma * norms + bonus[:, None] + bonus >= 0).all(axis=1)
    objective = gamma * norms + bonus[:, None] + bonus
    if len(objective) > 1:  # no policy is its own partner
        np.fill_diagonal(objective, -np.inf)
    return kept, objective


sizes = st.sampled_from([1, 2, 7, 63, 64, 65, 200])


@given(st.integers(0, 10**6), sizes, st.integers(1, 6), st.sampled_from([0.0, 0.05, 0.5, 3.0]), st.booleans())
def test_filter_and_pair_equal_all_pairs(seed: int, n: int, d: int, gamma: float, with_bonus: bool) -> None:
    features, matrix, w, bonus = instance(seed, n, d, 2.0)
    bonus = bonus * with_bonus
    kept, objective = naive(features, matrix, w, gamma, bonus)
    z, scores = whiten(features, matrix), features @ w
    np.testing.assert_array_equal(surviving(scores + bonus, scores - bonus, z, gamma), kept)
    first, second = widest_pair(z, gamma, bonus)
    assert objective[first, second] == pytest.approx(objective.max(), abs=1e-7)
    optimism = objective + scores[:, None] - scores
    assert optimism[widest_pair(z, gamma, bonus, scores)] == pytest.approx(optimism.max(), abs=1e-7)


def test_challengers_may_be_others(rng: np.random.Generator) -> None:
    features, matrix, w, bonus = instance(5, 50, 3, 1.0)
    z, s = whiten(features, matrix), features @ w
    kept = surviving(s + bonus, (s - bonus)[:30], z, 0.1, z[:30])
    expected = [naive(features[[*range(30), i]], matrix, w, 0.1, bonus[[*range(30), i]])[0][-1] for i in range(50)]
    np.testing.assert_array_equal(kept, expected)


def test_policies_with_equal_features_do_not_rule_each_other_out() -> None:
    """Their scores differ by rounding only; the set may err on the large side alone."""
    features = np.array([[0.1, 0.2, 0.7], [0.1, 0.2, 0.7 + 1e-16], [0.1 + 1e-17, 0.2, 0.7]])
    w = np.array([0.3, -0.7, 0.11])
    scores = features @ w + np.array([0, 3e-17, -3e-17])
    assert surviving(scores, scores, features, 0.0).all()


def test_the_best_policy_always_survives(rng: np.random.Generator) -> None:
    features, matrix, w, _ = instance(9, 300, 4, 1.0)
    scores = features @ w
    assert surviving(scores, scores, whiten(features, matrix), 0.0)[scores.argmax()]


@pytest.mark.parametrize("scale", [1e-12, 1e-8, 1.0, 1e8])
def test_the_widest_pair_does_not_depend_on_the_unit(scale: float) -> None:
    """Where kappa is 10^15 all distances are near 10^-8, and yet not equal."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        z, bonus, scores = rng.normal(size=(30, 4)), rng.random(30), rng.normal(size=30)
        assert widest_pair(scale * z, 0.5, scale * bonus) == widest_pair(z, 0.5, bonus)
        assert widest_pair(scale * z, 0.5, scale * bonus, scale * scores) == widest_pair(z, 0.5, bonus, scores)


def test_pair_rules_do_what_they_say(rng: np.random.Generator) -> None:
    features, matrix, w, bonus = instance(3, 40, 3, 1.0)
    z, scores = whiten(features, matrix), features @ w
    kept = np.arange(40) % 2 == 0
    members = np.flatnonzero(kept)
    greedy = members[scores[members].argmax()]
    _, objective = naive(features, matrix, w, 0.3, bonus)
    _, norms = naive(features, matrix, w, 1.0, 0 * bonus)

    def pair(rule: str) -> tuple[int, int]:
        return choose_pair(rule, kept, scores, z, 0.3, bonus, rng)  # type: ignore[arg-type]

    inside = np.ix_(members, members)
    assert objective[pair("uncertainty_and_bonus")] == pytest.approx(objective[inside].max())
    assert norms[pair("max_uncertainty")] == pytest.approx(norms[inside].max())
    optimism = objective + scores[:, None] - scores
    assert optimism[pair("ucb")] == pytest.approx(optimism[inside].max())
    first, second = pair("greedy_vs_random")
    assert first == greedy
    assert kept[second]
    with pytest.raises(InputError, match="pair rule"):
        pair("best")
