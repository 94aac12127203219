"""Policies come back as they went; what is no policy, or might run a program, is refused in a sentence."""

import io
import json
import zipfile
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="experts need MuJoCo (the extra 'continuous')")
safetensors_numpy = pytest.importorskip("safetensors.numpy", reason="expert files need safetensors")

from networks import random_policy  # noqa: E402

from bridge_algos.continuous.environments import make_environment  # noqa: E402
from bridge_algos.continuous.expert_cards import PUBLISHED_RETURNS, evaluation  # noqa: E402
from bridge_algos.continuous.experts import SHIPPED, expert_card, load_expert, shipped_path  # noqa: E402
from bridge_algos.continuous.policies import MlpPolicy  # noqa: E402
from bridge_algos.continuous.policy_files import load_policy, save_policy  # noqa: E402
from bridge_theory.errors import InputError  # noqa: E402


@pytest.fixture(scope="module")
def reacher():
    return make_environment("reacher")


@pytest.mark.parametrize("normalised", [False, True])
def test_policies_come_back_as_they_went(reacher, tmp_path, normalised):
    policy = random_policy(reacher, 0)
    if normalised:
        policy = replace(
            policy,
            std=None,
            activation="relu",
            observation_mean=np.arange(10.0),
            observation_scale=np.full(10, 0.1),
            observation_clip=5.0,
            squashed=True,
            action_low=np.array([-2.0, 0.0]),
            action_high=np.array([2.0, 0.5]),
            squash_clip=np.ones(2),
        )
    save_policy(tmp_path / "p.safetensors", policy, {"seed": 7})
    again = load_policy(tmp_path / "p.safetensors")
    assert again.digest() == policy.digest()
    observations = np.random.default_rng(0).normal(size=(50, 10))
    np.testing.assert_array_equal(again(observations), policy(observations))
    assert expert_card(tmp_path / "p.safetensors") == {"seed": 7}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["p.json", "p.safetensors"]


def test_digests_tell_policies_apart(reacher):
    policy = random_policy(reacher, 0)
    others = [
        policy.with_parameters(policy.parameters + 1e-12),
        replace(policy, std=None),
        replace(policy, activation="relu"),
        replace(policy, squashed=True),
        replace(policy, observation_mean=np.zeros(10)),
        replace(policy, observation_scale=np.ones(10)),
        replace(policy, squashed=True, action_low=-np.ones(2), action_high=np.ones(2)),
        replace(policy, squashed=True, squash_clip=np.ones(2)),
    ]
    assert len({policy.digest(), *(other.digest() for other in others)}) == 9
    assert policy.with_parameters(policy.parameters).digest() == policy.digest()


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_experts_return_what_their_cards_say(name):
    """The card's mean over 1,000 episodes is not below the published one; 100 of the same episodes agree with it."""
    environment = make_environment(name.removesuffix("-zoo"))
    published = PUBLISHED_RETURNS[environment.name]
    card = expert_card(name)
    stated = card["evaluation"]
    assert stated["episodes"] >= 1000
    assert stated["return"] - 1.96 * stated["standard_error"] > published == card["published_return"]
    measured = evaluation(environment, load_expert(name, environment), episodes=100, seed=stated["seed"])
    error = np.hypot(measured["standard_error"], stated["standard_error"])
    assert abs(measured["return"] - stated["return"]) < 5 * error, "false alarm less often than once in 10^6"


def test_shipped_files_are_small():
    for name in SHIPPED:
        assert shipped_path(name).stat().st_size < 300_000


def write_zip(path, policy_bytes, settings):
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("policy.pth", policy_bytes)
        archive.writestr("data", json.dumps(settings))
    return path


def test_a_zip_with_a_program_in_it_is_refused_and_not_run(reacher, tmp_path):
    torch = pytest.importorskip("torch")

    class Program:
        def __reduce__(self):
            return (open, (str(tmp_path / "executed"), "w"))

    content = io.BytesIO()
    torch.save({"action_net.weight": Program()}, content)
    path = write_zip(tmp_path / "evil.zip", content.getvalue(), {})
    with pytest.raises(InputError, match=r"evil\.zip are no plain tensors") as refused:
        load_expert(path, reacher)
    assert "weights_only" not in str(refused.value)
    assert not (tmp_path / "executed").exists()


@pytest.mark.parametrize("suffix", [".pt", ".pkl"])
def test_pickles_are_refused(reacher, suffix):
    with pytest.raises(InputError, match="may be a pickle"):
        load_expert(f"expert{suffix}", reacher)


LAYER = {"weights.0": np.zeros((2, 2)), "biases.0": np.zeros(2)}
HEADER = {"format": "bridge-rl policy 1", "activation": "tanh", "observation_clip": "inf", "squashed": "false"}


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "is not a readable .safetensors file"),
        (b"\x00" * 100, "is not a readable .safetensors file"),
        (b"\xff" * 100, "is not a readable .safetensors file"),
        (safetensors_numpy.save({"x": np.zeros(3)}), "holds no policy of the format 'bridge-rl policy 1'"),
        (safetensors_numpy.save({"weights.0": np.zeros((2, 2))}, {"format": "bridge-rl policy 1"}), "holds no policy"),
        (
            safetensors_numpy.save(
                {"weights.0": np.zeros((2, 2)), "biases.0": np.zeros(2)}, {"format": "bridge-rl policy 1"}
            ),
            "expected activation, format, observation_clip, squashed",
        ),
        (safetensors_numpy.save(LAYER, HEADER | {"observation_clip": "ten"}), "has no number observation_clip"),
        (safetensors_numpy.save(LAYER, HEADER | {"observation_clip": "nan"}), "observation_clip goes down to nan"),
        (safetensors_numpy.save(LAYER, HEADER | {"squashed": "True"}), "and 'squashed' true or false"),
        (safetensors_numpy.save(LAYER, HEADER | {"temperature": "2"}), "has the header .*temperature"),
        (safetensors_numpy.save(LAYER | {"action_low": np.zeros(2)}, HEADER), "but only squashed means are rescaled"),
    ],
)
def test_files_that_are_no_experts_get_one_sentence(reacher, tmp_path, content, sentence):
    path = tmp_path / "expert.safetensors"
    path.write_bytes(content)
    with pytest.raises(InputError, match=sentence):
        load_expert(path, reacher)


def test_mistakes_get_one_sentence(reacher, tmp_path):
    policy = random_policy(reacher, 0)
    save_policy(tmp_path / "p.safetensors", policy, {})
    cases = {
        r"'reacher' takes 10 observations and gives 2 actions, expected 105 and 8": lambda: load_expert(
            "reacher", make_environment("ant")
        ),
        r"there is no expert 'walker'; give one of reacher, reacher-zoo, ant, or your own": lambda: load_expert(
            "walker", reacher
        ),
        r"nowhere\.safetensors does not exist": lambda: load_expert("nowhere.safetensors", reacher),
        r"nowhere\.zip does not exist": lambda: load_expert("nowhere.zip", reacher),
        r"expected a name that ends in '\.safetensors'": lambda: save_policy("p.npz", policy, {}),
        r"parameters have shape \(3,\), expected \(482,\)": lambda: policy.with_parameters(np.zeros(3)),
        r"parameters that are not finite": lambda: policy.with_parameters(policy.parameters * np.nan),
        r"the activation is 'gelu', expected one of tanh, relu": lambda: replace(policy, activation="gelu"),
        r"std has shape \(3,\), expected \(2,\)": lambda: replace(policy, std=np.ones(3)),
        r"observation_scale goes down to 0\.0": lambda: replace(policy, observation_scale=np.zeros(10)),
        r"observation_clip goes down to -1": lambda: replace(policy, observation_clip=-1),
        r"only action_low is given, expected action_low and": lambda: replace(
            policy, squashed=True, action_low=np.zeros(2)
        ),
        r"action_low is not below action_high": lambda: replace(
            policy, squashed=True, action_low=np.zeros(2), action_high=np.zeros(2)
        ),
        r"each layer taking what the one before gives": lambda: MlpPolicy((np.zeros((2, 3)),), (np.zeros(2),)),
    }
    for sentence, mistake in cases.items():
        with pytest.raises(InputError, match=sentence):
            mistake()


def test_a_module_in_memory_is_a_policy(reacher):
    torch = pytest.importorskip("torch")
    from bridge_algos.continuous.foreign_policies import policy_from_module

    module = torch.nn.Linear(10, 2)
    observations = np.random.default_rng(0).normal(size=(50, 10))
    expected = observations @ module.weight.detach().numpy().T + module.bias.detach().numpy()
    np.testing.assert_allclose(policy_from_module(module)(observations), expected, rtol=1e-4, atol=1e-5)
