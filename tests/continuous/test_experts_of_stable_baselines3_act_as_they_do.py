"""A zip of Stable-Baselines3 acts as its own library lets it act, to 1e-5, or it is refused in a sentence."""

import io
import json
import warnings
import zipfile

import gymnasium
import numpy as np
import pytest

pytest.importorskip("mujoco", reason="experts need MuJoCo (the extra 'continuous')")
sb3 = pytest.importorskip("stable_baselines3", reason="needs Stable-Baselines3 (the extra 'sb3')")
torch = pytest.importorskip("torch")

from stable_baselines3.common.policies import ActorCriticPolicy  # noqa: E402
from stable_baselines3.common.torch_layers import FlattenExtractor  # noqa: E402
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize  # noqa: E402

from bridge_algos.continuous.environments import Environment  # noqa: E402
from bridge_algos.continuous.experts import load_expert  # noqa: E402
from bridge_theory.errors import InputError  # noqa: E402

RANGES = {
    "of one": ([-1, -1], [1, 1]),
    "wider": ([-2, -2], [2, 2]),
    "narrow": ([-0.4, -0.4], [0.4, 0.4]),
    "lopsided": ([0, -3], [0.5, 1]),
}
RELU = {"activation_fn": torch.nn.ReLU}
HARMLESS = {"normalize_images": False, "features_extractor_class": FlattenExtractor, "features_extractor_kwargs": {}}
UNSHARED = {"share_features_extractor": False}
CPU = {"device": "cpu"}
CASES = [
    ("PPO", {}, {}),
    ("PPO", {}, RELU | UNSHARED),
    ("PPO", {}, {"net_arch": {"pi": [7, 5], "vf": [3]}, "ortho_init": False, "log_std_init": -1.0}),
    ("PPO", {}, {"net_arch": []}),
    ("PPO", {"use_sde": True}, {"full_std": False, "use_expln": True}),
    ("PPO", {"use_sde": True}, {"squash_output": True}),
    ("A2C", {}, HARMLESS),
    ("A2C", {"use_sde": True}, {"squash_output": True, "net_arch": [9]}),
    ("SAC", {}, {"net_arch": [8, 8]}),
    ("SAC", {}, {"net_arch": {"pi": [6], "qf": [4]}, "activation_fn": torch.nn.Tanh, "n_critics": 1}),
    ("SAC", {}, {"net_arch": {"pi": [], "qf": [4]}}),
    ("SAC", {"use_sde": True}, {"net_arch": [8]}),
    ("SAC", {"use_sde": True}, {"net_arch": [8], "clip_mean": 0.3}),
    ("SAC", {"use_sde": True}, {"net_arch": [8], "clip_mean": 0.0}),
    ("TD3", {}, {"net_arch": [8, 8]} | HARMLESS | UNSHARED),
    ("TD3", {}, {"net_arch": [8], "activation_fn": torch.nn.Tanh}),
    ("DDPG", {}, {"net_arch": [8, 8, 8]}),
]


class Box(gymnasium.Env):
    """Random observations of three numbers, and actions of two in a range."""

    def __init__(self, low, high, size=3):
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (size,), dtype=np.float64)
        self.action_space = gymnasium.spaces.Box(np.float32(low), np.float32(high))

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self._observed(), {}

    def step(self, action):
        return self._observed(), 0.0, False, False, {}

    def _observed(self):
        return self.np_random.normal(loc=5.0, scale=[0.1, 1.0, 30.0], size=3)


def environment(name="of one"):
    return Environment("box", "Box-v0", Box(*RANGES[name]), 10, lambda size: None)


def trained(algorithm, venv, options, kwargs):
    """A model with weights so large that its actions fill the range, after a few steps of learning."""
    short = {"PPO": {"n_steps": 8, "batch_size": 8}, "A2C": {}}.get(algorithm, {"buffer_size": 100})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = getattr(sb3, algorithm)("MlpPolicy", venv, policy_kwargs=kwargs, seed=0, **CPU, **short, **options)
        model.learn(8)
    generator = torch.Generator().manual_seed(1)
    with torch.no_grad():
        for values in model.policy.parameters():
            scale = 1.5 / values.shape[1] ** 0.5 if values.ndim == 2 else 0.1
            values.copy_(scale * torch.randn(values.shape, generator=generator))
    return model


def saved(model, path, statistics=None):
    model.save(path)
    if statistics is not None:
        np.savez(path.with_name(f"{path.stem}-statistics.npz"), **statistics)
    return path


def statistics_of(venv):
    return {
        "mean": venv.obs_rms.mean,
        "var": venv.obs_rms.var,
        "epsilon": venv.epsilon,
        "clip_obs": venv.clip_obs,
    }


@pytest.mark.parametrize("actions", RANGES)
@pytest.mark.parametrize("case", range(len(CASES)))
def test_actions_are_those_of_the_library(case, actions, tmp_path):
    algorithm, options, kwargs = CASES[case]
    venv = DummyVecEnv([lambda: Box(*RANGES[actions])])
    model = trained(algorithm, venv, options, dict(kwargs))
    path = saved(model, tmp_path / "m.zip", None if algorithm in ("PPO", "A2C") else {"normalised": False})
    policy = load_expert(path, environment(actions))
    observations = np.random.default_rng(0).normal(size=(200, 3))
    theirs = model.predict(observations, deterministic=True)[0]
    low, high = environment(actions).low, environment(actions).high
    assert np.abs(np.clip(policy(observations), low, high) - theirs).max() < 1e-5
    assert (theirs.std(axis=0) > 0.05 * (high - low)).all(), "the actions must fill the range, or nothing is tested"


@pytest.mark.parametrize("clip", [10.0, 0.7])
@pytest.mark.parametrize("algorithm", ["PPO", "A2C", "SAC", "TD3", "DDPG"])
def test_observations_are_normalised_as_by_the_library(algorithm, clip, tmp_path):
    venv = VecNormalize(DummyVecEnv([lambda: Box(*RANGES["lopsided"])]), clip_obs=clip)
    model = trained(algorithm, venv, {}, {"net_arch": [8]})
    with pytest.raises(InputError, match=r"VecNormalize, and the file .*m-statistics\.npz is missing; write it by"):
        load_expert(saved(model, tmp_path / "m.zip"), environment("lopsided"))
    policy = load_expert(saved(model, tmp_path / "m.zip", statistics_of(venv)), environment("lopsided"))
    observations = np.random.default_rng(0).normal(loc=5.0, scale=[0.1, 1.0, 30.0], size=(200, 3))
    theirs = model.predict(venv.normalize_obs(observations), deterministic=True)[0]
    ours = np.clip(policy(observations), *RANGES["lopsided"])
    assert np.abs(ours - theirs).max() < 1e-5
    np.savez(tmp_path / "m-statistics.npz", normalised=False)
    plain = load_expert(tmp_path / "m.zip", environment("lopsided"))
    assert np.abs(np.clip(plain(observations), *RANGES["lopsided"]) - theirs).max() > 0.1


class Halved(FlattenExtractor):
    """An extractor without weights: nothing but the settings shows it."""

    def forward(self, observations):
        return super().forward(observations) / 2


class Learnt(FlattenExtractor):
    def __init__(self, observation_space):
        super().__init__(observation_space)
        self.layer = torch.nn.Linear(3, 3)

    def forward(self, observations):
        return self.layer(super().forward(observations))


class OwnPolicy(ActorCriticPolicy):
    """A policy that predicts something else from the same weights."""


@pytest.mark.parametrize(
    ("policy", "kwargs", "sentence"),
    [
        (
            "MlpPolicy",
            {"features_extractor_class": Halved},
            r"features_extractor_class=<class .*, expected Flatten",
        ),
        (
            "MlpPolicy",
            {"features_extractor_class": Learnt},
            r"features_extractor_class=<class .*, expected Flatten",
        ),
        ("MlpPolicy", {"activation_fn": torch.nn.ELU}, r"activation_fn=.*ELU.*, expected torch's Tanh or ReLU"),
        (
            OwnPolicy,
            {},
            r"is a class of the module '.*test_experts_of_sta.*, expected MlpPolicy of PPO, A2C, TD3, DDPG or SAC",
        ),
    ],
)
def test_what_acts_otherwise_is_refused(policy, kwargs, sentence, tmp_path):
    model = sb3.PPO(policy, Box(*RANGES["of one"]), policy_kwargs=kwargs, **CPU)
    with pytest.raises(InputError, match=sentence):
        load_expert(saved(model, tmp_path / "m.zip"), environment())


def test_other_spaces_are_refused(tmp_path):
    model = sb3.PPO("MlpPolicy", Box(*RANGES["wider"]), **CPU)
    with pytest.raises(InputError, match="was trained with actions from -2 to 2, expected the range of box, -1 to 1"):
        load_expert(saved(model, tmp_path / "m.zip"), environment())
    model = sb3.PPO("MlpPolicy", Box([-1], [1]), **CPU)
    with pytest.raises(InputError, match="has 1-dimensional actions, expected 2, as box has"):
        load_expert(saved(model, tmp_path / "m.zip"), environment())
    model = sb3.PPO("MlpPolicy", gymnasium.make("CartPole-v1"), **CPU)
    with pytest.raises(InputError, match="has 4-dimensional observations, expected 3"):
        load_expert(saved(model, tmp_path / "m.zip"), environment())


def rewritten(source, target, change):
    """A copy of a zip with other settings or weights."""
    with zipfile.ZipFile(source) as archive:
        texts = json.loads(archive.read("data"))
        weights = torch.load(io.BytesIO(archive.read("policy.pth")), weights_only=True)
    texts, weights = change(texts, weights)
    content = io.BytesIO()
    torch.save(weights, content)
    with zipfile.ZipFile(target, "w") as archive:
        archive.writestr("policy.pth", content.getvalue())
        archive.writestr("data", json.dumps(texts))
    return target


CHANGES = {
    r"policy setting 'temperature', which is not known": lambda t, w: (
        t | {"policy_kwargs": {"temperature": 2.0}},
        w,
    ),
    r"squash_output=yes, expected true or false": lambda t, w: (t | {"policy_kwargs": {"squash_output": "yes"}}, w),
    r"activation_fn=<class 'mine\.Tanh'>, expected": lambda t, w: (
        t | {"policy_kwargs": {"activation_fn": "<class 'mine.Tanh'>"}},
        w,
    ),
    r"have no policy_kwargs": lambda t, w: ({k: v for k, v in t.items() if k != "policy_kwargs"}, w),
    r"activation_fn=\['Tanh'\], expected": lambda t, w: (t | {"policy_kwargs": {"activation_fn": ["Tanh"]}}, w),
    r"is a class of the module '\[\]', expected": lambda t, w: (t | {"policy_class": {"__module__": []}}, w),
    r"is a class of the module 'None', expected MlpPolicy": lambda t, w: (
        {k: v for k, v in t.items() if k != "policy_class"},
        w,
    ),
    r"does not tell the range of actions": lambda t, w: (
        t | {"action_space": t["action_space"] | {"low": "[-1. ... -1.]"}},
        w,
    ),
    r"observations of another kind \(<class 'gymnasium\.spaces\.dict\.Dict'>": lambda t, w: (
        t | {"observation_space": {":type:": "<class 'gymnasium.spaces.dict.Dict'>"}},
        w,
    ),
    r"does not tell whether it was trained with VecNormalize": lambda t, w: (
        {k: v for k, v in t.items() if k != "_last_original_obs"},
        w,
    ),
    r"are no JSON object": lambda t, w: ([], w),
    r"lacks action_net\.bias": lambda t, w: (t, {k: v for k, v in w.items() if k != "action_net.bias"}),
    r"holds no actor of linear layers": lambda t, w: (t, {"q_net.0.weight": w["action_net.weight"]}),
    r"arrays that no plain actor has, such as mlp_extractor\.shared_net\.0\.weight": lambda t, w: (
        t,
        w | {"mlp_extractor.shared_net.0.weight": w["action_net.weight"]},
    ),
    r"arrays that no plain actor has, such as mlp_extractor\.policy_net\.1\.scale": lambda t, w: (
        t,
        w | {"mlp_extractor.policy_net.1.scale": w["log_std"]},
    ),
}


def test_whatever_is_not_understood_is_refused(tmp_path):
    whole = saved(sb3.PPO("MlpPolicy", Box(*RANGES["of one"]), **CPU), tmp_path / "m.zip")
    for sentence, change in CHANGES.items():
        with pytest.raises(InputError, match=sentence):
            load_expert(rewritten(whole, tmp_path / "changed.zip", change), environment())
    assert load_expert(rewritten(whole, tmp_path / "changed.zip", lambda t, w: (t, w)), environment()).action_size == 2


@pytest.mark.parametrize(
    ("statistics", "sentence"),
    [
        ({"mean": np.zeros(3)}, r"m-statistics\.npz holds the arrays mean, expected mean, var, epsilon, clip_obs"),
        ({"normalised": True}, r"holds the arrays normalised, expected"),
        ({}, r"holds the arrays none, expected"),
        ({"mean": np.zeros(2), "var": np.ones(3), "epsilon": 0.1, "clip_obs": 1.0}, r"mean in .* has shape \(2,\)"),
        (
            {"mean": np.zeros(3), "var": -np.ones(3), "epsilon": 0.1, "clip_obs": 1.0},
            "must have var . epsilon and",
        ),
        ({"mean": np.zeros(3), "var": np.ones(3), "epsilon": 0.1, "clip_obs": np.nan}, "clip_obs above zero"),
        ({"mean": np.array([None] * 3, dtype=object)}, "is not a readable .npz file of plain arrays"),
    ],
)
def test_statistics_that_do_not_fit_are_refused(statistics, sentence, tmp_path):
    model = sb3.PPO("MlpPolicy", Box(*RANGES["of one"]), **CPU)
    path = saved(model, tmp_path / "m.zip", statistics)
    with pytest.raises(InputError, match=sentence):
        load_expert(path, environment())
