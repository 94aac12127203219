"""A counterexample of the ledger that is an environment runs in the ordinary loop, with the ledger's own numbers."""

from fractions import Fraction

import numpy as np
import pytest

from bridge_algos.embeddings import expected_features, return_embedding
from bridge_algos.envs.counterexamples import instance, is_counterexample
from bridge_algos.envs.registry import make_mdp, mdp_names
from bridge_algos.evaluation import expected_returns
from bridge_algos.offline.radius import named_radii
from bridge_algos.policies import all_policies, random_policies
from bridge_algos.run.config import preset
from bridge_algos.run.seed import run_seed
from bridge_algos.run.world import build_world
from bridge_algos.trajectories import sample_trajectories
from bridge_theory import offline_radius_known
from bridge_theory.errors import InputError
from proofs_checks.counterexample import load, on_environment, parse

NAME = "counterexample-known-model"
RECORD = {
    "label": "thm:main_known",
    "sentence": "a test",
    "kind": "online-two-policies",
    "left": {"latex": "x", "value": "1"},
    "relation": "<=",
    "right": {"latex": "y", "value": "0"},
    "controls": [{"name": "short", "data": {"T": "1"}}],
}


def test_the_names_are_among_the_environments():
    named = [name for name in mdp_names() if is_counterexample(name)]
    assert named == [NAME]
    for name in named:
        assert on_environment(name)
        assert preset("counterexample", name).environment == name


def test_the_ledger_reads_the_numbers_of_the_environment():
    example = load("online-linear-regret")
    assert {key: example.data[key] for key in instance(NAME)} == dict(instance(NAME))
    own = parse("test", {**RECORD, "data": {"environment": NAME, "T": "7"}}).data
    assert (own["T"], own["B"]) == ("7", instance(NAME)["B"])
    with pytest.raises(InputError, match="no environment 'elsewhere'"):
        parse("test", {**RECORD, "data": {"environment": "elsewhere"}})


def test_both_actions_are_compared_in_every_round_whatever_the_seed():
    config = preset("counterexample", NAME).but(rounds=60)
    world = build_world(config)
    answers = set()
    for seed in range(4):
        result = run_seed(config, world, seed).sel(algorithm="bridge-known")
        assert (result.set_size == 2).all()
        assert (result.first != result.second).all()
        regret = np.asarray(result.pseudo_regret) * world.utility_scale
        assert (regret == float(Fraction(instance(NAME)["B"]) * Fraction(instance(NAME)["W"]))).all()
        answers.add(tuple(np.asarray(result.weight_error)))
    assert len(answers) == 4  # the answers differ, the regret does not


@pytest.mark.parametrize(("n", "kept"), [(22, 2), (23, 1)])
def test_the_stated_radius_decides_whether_the_worse_action_is_in_the_offline_set(n, kept):
    config = preset("counterexample", NAME).but(rounds=1, n_demonstrations=n)
    assert run_seed(config, build_world(config), 0).set_size.item() == kept
    radius = named_radii(make_mdp(NAME).dynamics, np.array([0]), n, 0.05)["stated-known"]
    assert radius == offline_radius_known.enclosure(S=1, A=2, n=n, delta=0.05).upper
    assert (radius >= 1) == (kept == 2)


@pytest.mark.parametrize("name", ["starmdp", "garnet", "cliff", NAME])
def test_the_return_is_a_feature(name):
    mdp, rng = make_mdp(name), np.random.default_rng(0)
    policies = all_policies(1, 2) if name == NAME else random_policies(20, mdp.n_states, mdp.n_actions, rng)
    embedding = return_embedding(mdp)
    features, _ = expected_features(mdp.dynamics, policies, embedding)
    assert features[:, 0] == pytest.approx(expected_returns(mdp, policies), rel=1e-12, abs=1e-12)
    paths = sample_trajectories(mdp, policies[0], 50, rng)
    assert (np.abs(embedding.of_trajectories(paths)) <= embedding.bound * (1 + 1e-12)).all()


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: preset("counterexample", "starmdp"), "'starmdp' is not one of the counterexamples"),
        (lambda: preset("fast", "starmdp"), "expected one of published, theory, counterexample"),
        (lambda: make_mdp(NAME, horizon=0), "horizon is 0"),
        (lambda: preset("theory", "starmdp").but(radius="known"), "stated-known"),
    ],
)
def test_bad_arguments_get_one_sentence(call, sentence):
    with pytest.raises(InputError) as caught:
        call()
    assert sentence in str(caught.value)
