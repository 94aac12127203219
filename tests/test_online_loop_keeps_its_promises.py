"""What the loop records is exact; the confidence set of the theory keeps the optimum; settings mean what they say."""

import numpy as np
import pytest

from bridge_algos.evaluation import expected_return
from bridge_algos.online.confidence import RoundState, fixed, repaired, stated
from bridge_algos.run.config import preset
from bridge_algos.run.seed import run_seed
from bridge_algos.run.world import build_oracle, build_world
from bridge_theory.errors import InputError

STAR = preset("published", "starmdp").but(rounds=6)


def test_first_round_rules_nothing_out_and_bc_never_changes() -> None:
    result = run_seed(STAR, build_world(STAR), 0)
    assert result.set_size.sel(algorithm="pbrl")[0] == 1024
    assert result.set_size.sel(algorithm="bridge")[0] == result.offline_set_count
    assert np.ptp(result.suboptimality.sel(algorithm="bc").values) == 0
    expected = result.attrs["expert_return"] - result.clone_return
    assert float(result.suboptimality.sel(algorithm="bc")[0]) == pytest.approx(float(expected))


@pytest.mark.parametrize("algorithms", [("bridge-known", "pbrl"), ("bridge", "pbrl")])
def test_theory_preset_keeps_the_optimum_and_never_has_negative_pseudo_regret(algorithms) -> None:
    config = preset("theory", "starmdp").but(algorithms=algorithms, rounds=15, n_demonstrations=1)
    world = build_world(config)
    for seed in range(5):
        result = run_seed(config, world, seed)
        assert result.optimum_in_offline_set == 1
        assert result.expert_in_zero == 1
        assert result.expert_distance == 0
        assert bool((result.optimum_kept == 1).all())
        assert bool((result.pseudo_regret >= -1e-9).all())
        assert bool((result.weight_error < 2 * world.weight_bound + 1e-9).all())
        assert bool((result.log_det.diff("round") >= -1e-9).all())


def test_regret_is_not_clipped_when_the_expert_is_not_the_maximiser() -> None:
    """An expert that discounts strongly is beaten by the search, and the regret goes below zero."""
    config = preset("published", "chain").but(discount=0.05, fit="exact", algorithms=("pbrl",))
    world = build_world(config)
    assert world.expert.gap_to_stationary > 1
    result = run_seed(config, world, 0)
    assert float(result.suboptimality.min()) < 0
    assert float(result.pseudo_regret.min()) >= -1e-9


def test_exact_and_sampled_features_tell_the_same_story() -> None:
    config = STAR.but(rounds=3, algorithms=("bridge-known",), pair_rule="max_uncertainty")
    world = build_world(config)
    exact, sampled = (run_seed(config.but(rollouts=r), world, 1) for r in (None, 400))
    assert sampled.set_size[0, 0] == exact.set_size[0, 0]
    assert float(exact.uncertainty[0, 0]) > 1
    assert float(sampled.uncertainty[0, 0]) == pytest.approx(float(exact.uncertainty[0, 0]), rel=0.2)


@pytest.mark.parametrize("rule", ["uncertainty_and_bonus", "max_uncertainty", "ucb", "greedy_vs_random"])
@pytest.mark.parametrize("confidence", ["fixed", "stated", "repaired", "likelihood"])
def test_every_rule_and_multiplier_runs(rule: str, confidence: str) -> None:
    config = preset("theory", "starmdp").but(
        rounds=3, pair_rule=rule, confidence=confidence, algorithms=("bridge", "bridge-known", "pbrl")
    )
    result = run_seed(config, build_world(config), 0)
    assert bool((result.gamma > 0).all())


def test_imperfect_teachers_and_skipped_queries_run() -> None:
    for options in (
        {"mistakes": 0.3},
        {"skip_below": 1e9},
        {"equal_within": 5.0},
        {"myopia": 0.5},
        {"rationality": 1.0},
    ):
        config = STAR.but(oracle_options=options, algorithms=("bridge",))
        assert bool(np.isfinite(run_seed(config, build_world(config), 0).suboptimality).all())
    for options, message in (
        ({"noise": 0.1}, "the oracle has no option 'noise'; its options are rationality, mistakes,"),
        ({"mistakes": "many"}, "the oracle's mistakes is 'many', expected a number"),
        ({"mistakes": 2}, "the oracle's mistakes is 2, expected a probability"),
    ):
        with pytest.raises(InputError, match=message):
            build_oracle(STAR.but(oracle_options=options), build_world(STAR))


def test_noise_in_demonstrations_can_expel_the_expert_from_radius_zero() -> None:
    config = STAR.but(noise=0.5, n_demonstrations=20, rounds=1, algorithms=("bc",))
    world = build_world(config)
    shares = [float(run_seed(config, world, seed).expert_in_zero) for seed in range(10)]
    assert min(shares) == 0.0


def test_bradley_terry_needs_linear_utilities() -> None:
    config = preset("theory", "starmdp").but(embedding="identity_short")
    with pytest.raises(InputError, match="state_action_counts"):
        build_oracle(config, build_world(config))


def test_utility_is_the_return_up_to_scale() -> None:
    config = preset("theory", "gridworld")
    world = build_world(config)
    assert world.w_star is not None
    assert np.linalg.norm(world.w_star) == pytest.approx(world.weight_bound)
    weights = world.w_star.reshape(world.mdp.n_states, world.mdp.n_actions)
    from bridge_algos.occupancy import state_action_occupancies

    utility = float((state_action_occupancies(world.mdp.dynamics, world.optimum) * weights).sum())
    assert utility == pytest.approx(world.utility_scale * expected_return(world.mdp, world.optimum))


def test_published_bonus_is_the_documented_one() -> None:
    confidence = fixed(0.2, 0.01, n_states=5, n_actions=4, horizon=8, lam=1.0)
    bonus = confidence.step_bonus(np.array([[0, 1, 4, 10**6]]))
    log = np.log(20)
    np.testing.assert_allclose(bonus[0], 0.01 * np.array([log, np.sqrt(log), np.sqrt(log / 4), np.sqrt(log / 1e6)]))
    with pytest.raises(InputError, match="bonus_multiplier"):
        fixed(0.2, -1.0, 5, 4, 8, 1.0)


def test_stated_multiplier_grows_and_dwarfs_the_repaired_one() -> None:
    state = RoundState(1, np.eye(3) * 9.0, 0.0, [], [])
    later = RoundState(9, np.eye(3) * 9.0, 0.0, [], [])
    wide = stated(1.0, 1.0, 3, 5, 4, 8, rounds=10, lam=1.0, delta=0.05, known=True)
    assert wide.multiplier(later) > wide.multiplier(state)
    narrow = repaired(1.0, 1.0, 3, 5, 4, 8, lam=1.0, delta_w=0.05, delta_p=0.05)
    started = RoundState(1, np.eye(3) * narrow.initial_scale, 0.0, [], [])
    assert narrow.multiplier(started) < wide.multiplier(state)
    assert narrow.multiplier(RoundState(1, started.matrix, 1.0, [], [])) > narrow.multiplier(started)


def test_a_time_dependent_expert_demonstrates_too() -> None:
    config = STAR.but(expert="finite-horizon-lp", n_demonstrations=50, algorithms=("bridge", "bc"))
    world = build_world(config)
    assert world.expert.policy.shape == (8, 5)
    result = run_seed(config, world, 0)
    assert result.attrs["expert_return"] >= result.attrs["optimum_return"]
    assert 0 <= float(result.expert_distance) <= 1
