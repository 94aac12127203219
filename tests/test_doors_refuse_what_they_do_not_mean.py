"""Every public function that takes numbers from outside refuses those it has no meaning for, in one sentence.

The harness is mechanical: each function stands here with one good call; every argument of that call is replaced by each
bad value of its kind. A public function that is not here must be in ``HOUSE``, with the reason why nothing of a user's
reaches it unchecked.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import bridge_algos
from bridge_algos.embeddings import make_embedding
from bridge_algos.mdp import TabularMDP
from bridge_algos.offline.step_counts import step_counts
from bridge_algos.online.confidence import fixed
from bridge_algos.online.loop import Learner, OnlineProblem
from bridge_algos.online.oracles import ReturnOracle
from bridge_algos.trajectories import Trajectories, sample_trajectories
from bridge_theory.errors import InputError

S, A, H, N = 4, 3, 5, 6
RNG = np.random.default_rng(0)
KERNEL = RNG.dirichlet(np.ones(S), size=(S, A))
START = RNG.dirichlet(np.ones(S))
MDP = TabularMDP(KERNEL, START, H, RNG.normal(size=(S, A)))
DYNAMICS = MDP.dynamics
POLICY = np.array([0, 1, 2, 0])
POLICIES = RNG.integers(A, size=(N, S))
DEMOS = sample_trajectories(MDP, POLICY, 3, np.random.default_rng(1))
COUNTS = step_counts(DEMOS, S, A)
EMBEDDING = make_embedding("state_action_counts", S, A, H)
X, OUTCOMES, W = RNG.normal(size=(7, 3)), np.array([0.0, 1, 1, 0, 0.5, 1, 0]), np.array([0.1, -0.2, 0.3])
MATRIX = np.eye(3) + X.T @ X
SIZE = {"n_states": S, "n_actions": A}


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


DOORS: dict[str, Callable[[], dict[str, Any]]] = {
    "embeddings.expected_features": lambda: {"dynamics": DYNAMICS, "policies": POLICIES, "embedding": EMBEDDING},
    "embeddings.linear_embedding": lambda: {"name": "x", "weights": np.ones((H, S, A, 2)), "bound": 9.0},
    "embeddings.make_embedding": lambda: {"name": "state_counts", **SIZE, "horizon": H},
    "embeddings.sampled_features": lambda: {
        "dynamics": DYNAMICS, "policies": POLICIES, "embedding": EMBEDDING, "rollouts": 3, "rng": rng(),
    },
    "envs.counterexamples.two_actions": lambda: {"horizon": 2},
    "envs.families.chain": lambda: {"n_states": 3, "slip": 0.2, "horizon": 4},
    "envs.families.cliff": lambda: {"n_rows": 3, "n_columns": 4, "slip": 0.1, "fall": -20.0, "horizon": 5},
    "envs.families.garnet": lambda: {"n_states": 3, "n_actions": 2, "branching": 2, "rng": rng(), "horizon": 3},
    "envs.gridworld.gridworld": lambda: {"variant": "text"},
    "envs.star.star_mdp": lambda: {"variant": "text"},
    "envs.registry.make_mdp": lambda: {"name": "chain", "n_states": 3, "slip": 0.1, "horizon": 2},
    "evaluation.expected_return": lambda: {"mdp": MDP, "policy": POLICY},
    "evaluation.expected_returns": lambda: {"mdp": MDP, "policies": POLICIES},
    "expert.dynamic_programming.discounted_values": lambda: {"mdp": MDP, "policy": POLICY, "discount": 0.9},
    "expert.dynamic_programming.policy_iteration": lambda: {"mdp": MDP, "discount": 0.9},
    "expert.experts.make_expert": lambda: {"mdp": MDP, "kind": "discounted-lp", "discount": 0.9, "solver": "HIGHS"},
    "hellinger.bhattacharyya": lambda: {
        "first": DYNAMICS, "policy1": POLICY, "second": DYNAMICS, "policy2": POLICY,
    },
    "hellinger.disagreement_probability": lambda: {
        "dynamics": DYNAMICS, "center": POLICY, "disagree": np.eye(S),
    },
    "mdp.Dynamics": lambda: {"transitions": KERNEL, "initial": START, "horizon": H},
    "mdp.TabularMDP": lambda: {
        "transitions": KERNEL, "initial": START, "horizon": H, "reward": np.arange(float(S)), "axes": "state-action",
        "reward_on": "arrival",
    },
    "occupancy.state_action_occupancies": lambda: {"dynamics": DYNAMICS, "policy": POLICY},
    "occupancy.total_occupancies": lambda: {"dynamics": DYNAMICS, "policies": POLICIES, "steps": 2},
    "occupancy.visit_probabilities": lambda: {"dynamics": DYNAMICS, "policies": POLICIES},
    "offline.ball_chain.chain_sample": lambda: {
        "dynamics": DYNAMICS, "center": POLICY, "squared_radius": 0.5, "n": 5, "rng": rng(),
    },
    "offline.ball_cubes.ball_cubes": lambda: {"dynamics": DYNAMICS, "center": POLICY, "squared_radius": 0.5},
    "offline.cloning.action_counts": lambda: {"demonstrations": DEMOS, **SIZE},
    "offline.cloning.add_action_noise": lambda: {
        "demonstrations": DEMOS, "probability": 0.1, "n_actions": A, "rng": rng(),
    },
    "offline.cloning.clone_deterministic": lambda: {"counts": COUNTS.pairs, "rng": rng(), "tie_break": "random"},
    "offline.cloning.clone_stochastic": lambda: {"counts": COUNTS.pairs},
    "offline.data_radius.data_dependent_radius": lambda: {
        "counts": COUNTS, "estimate": DYNAMICS, "clone": POLICY, "delta": 0.1,
    },
    "offline.policy_set.PolicySet": lambda: {"dynamics": DYNAMICS, "center": POLICY, "radius": 0.5},
    "offline.radius.minimum_visitation": lambda: {"truth": DYNAMICS, "expert": POLICY},
    "offline.radius.named_radii": lambda: {"truth": DYNAMICS, "expert": POLICY, "n": 3, "delta": 0.1},
    "offline.step_counts.sample_step_counts": lambda: {
        "dynamics": DYNAMICS, "policy": POLICY, "n": 3, "size": 2, "rng": rng(),
    },
    "offline.step_counts.step_counts": lambda: {"demonstrations": DEMOS, **SIZE},
    "offline.transitions.estimate_transitions": lambda: {"counts": COUNTS.pooled, "empty_row": "uniform"},
    "offline.transitions.transition_counts": lambda: {"trajectories": DEMOS, **SIZE},
    "online.confidence.fixed": lambda: {"gamma": 0.1, "bonus_multiplier": 0.1, **SIZE, "horizon": H, "lam": 1.0},
    "online.confidence.likelihood": lambda: {
        "embedding_bound": 1.0, "weight_bound": 1.0, **SIZE, "horizon": H, "lam": 1.0, "delta_w": 0.1,
        "delta_p": 0.1,
    },
    "online.confidence.repaired": lambda: {
        "embedding_bound": 1.0, "weight_bound": 1.0, "dimension": 3, **SIZE, "horizon": H, "lam": 1.0, "delta_w": 0.1,
        "delta_p": 0.1,
    },
    "online.confidence.stated": lambda: {
        "embedding_bound": 1.0, "weight_bound": 1.0, "dimension": 3, **SIZE, "horizon": H, "rounds": 5, "lam": 1.0,
        "delta": 0.1, "known": True,
    },
    "online.loop.Learner": lambda: {
        "name": "x", "policies": np.unique(POLICIES, axis=0), "counts": COUNTS.pooled,
        "confidence": fixed(1.0, 0.0, S, A, H, 1.0), "pair_rule": "ucb", "weight_bound": 1.0, "slope": 1.0, "lam": 1.0,
        "comparisons": 1, "fit": "exact", "rollouts": 3,
    },
    "online.oracles.BradleyTerryOracle": lambda: {"embedding": EMBEDDING, "w_star": np.ones(S * A)},
    "online.oracles.ReturnOracle": lambda: {
        "rationality": 1.0, "mistakes": 0.1, "skip_below": 0.1, "equal_within": 0.1, "myopia": 0.9,
    },
    "online.preference_model.fit_adam": lambda: {
        "x": X, "outcomes": OUTCOMES, "lam": 1.0, "start": W, "steps": 3, "rate": 0.1,
    },
    "online.preference_model.fit_exact": lambda: {"x": X, "outcomes": OUTCOMES, "lam": 1.0, "start": W},
    "online.preference_model.project": lambda: {"w": W, "x": X, "lam": 1.0, "matrix": MATRIX, "radius": 0.1},
    "online.preference_model.projection_error": lambda: {
        "v": W, "x": X, "outcomes": OUTCOMES, "lam": 1.0, "matrix": MATRIX,
    },
    "online.loop.run_online": lambda: {
        "problem": OnlineProblem(MDP, EMBEDDING, ReturnOracle(), POLICY, 0.0), "learner": Learner(
            "x", np.unique(POLICIES, axis=0), None, fixed(1.0, 0.0, S, A, H, 1.0), "ucb", 1.0
        ), "rounds": 2, "rng": rng(),
    },
    "policies.action_probabilities": lambda: {"policy": POLICY, **SIZE, "horizon": H},
    "policies.all_policies": lambda: {**SIZE},
    "policies.random_policies": lambda: {"n": 3, **SIZE, "rng": rng()},
    "run.interval.interval": lambda: {"values": np.array([0.1, 0.2, 0.3]), "low": 0.0, "high": 1.0, "level": 0.9},
    "run.streams.stream": lambda: {"seed": 3, "purpose": "ties"},
    "trajectories.Trajectories.checked": lambda: {"self": DEMOS, **SIZE, "horizon": H},
    "trajectories.sample_each": lambda: {"mdp": MDP, "policies": POLICIES, "n": 2, "rng": rng()},
    "trajectories.sample_paths": lambda: {"dynamics": DYNAMICS, "policy": POLICY, "n": 2, "rng": rng()},
    "trajectories.sample_trajectories": lambda: {"mdp": MDP, "policy": POLICY, "n": 2, "rng": rng()},
}  # fmt: skip


def bad(value: Any) -> Iterator[tuple[str, Any]]:
    """Values of no meaning in place of a good one, by its kind."""
    if isinstance(value, bool | str):
        yield "another word", "nonsense"
        return
    if isinstance(value, int):
        yield from (("true", True), ("negative", -2), ("a fraction", 1.5), ("nan", np.nan), ("a text", "2"))
    elif isinstance(value, float):
        yield from (("true", True), ("nan", np.nan), ("complex", 1 + 1j), ("a text", "1"))
    elif isinstance(value, np.random.Generator):
        yield from (("a seed", 0), ("the old module", np.random))
    elif isinstance(value, Trajectories):
        yield "negative states", Trajectories(value.states - 5, value.actions)
        yield "states out of range", Trajectories(value.states + 100, value.actions)
        yield "actions out of range", Trajectories(value.states, value.actions + 100)
        yield "fractions", Trajectories(value.states + 0.5, value.actions)
        yield "two lengths", Trajectories(value.states[:, 1:], value.actions)
        yield (
            "nan rewards",
            Trajectories(value.states, value.actions, np.where(value.states == value.states[0, 0], np.nan, 1)),
        )
    elif isinstance(value, np.ndarray):
        yield from _bad_arrays(value)


def _bad_arrays(value: np.ndarray) -> Iterator[tuple[str, Any]]:
    broken = value.astype(np.float64)
    broken.flat[0] = np.nan
    yield "nan", broken
    infinite = value.astype(np.float64)
    infinite.flat[0] = np.inf
    yield "infinity", infinite
    yield "complex", value + 1j
    yield "one axis too many", value[None, None, None]
    yield "texts", value.astype(str)
    if value.dtype.kind == "i":
        yield "fractions", value + 0.5
        yield "negative", value - 100
        yield "truth values", value > 0


MEANINGFUL = {
    (
        "offline.cloning.add_action_noise",
        "demonstrations",
        "states out of range",
    ): "nothing says how many states exist",
    ("run.interval.interval", "values", "one axis too many"): "one number a seed may be a table of them",
}

LABELS = {
    "embeddings.linear_embedding": ("name",),
    "online.loop.Learner": ("name",),
    "run.streams.stream": ("purpose",),
}
"""Texts that may be any."""

HOUSE = {
    "asking": "a session and a study check what reaches them, and have tests of their mistakes of their own",
    "continuous": "has tests of its mistakes of its own",
    "conventions": "what TabularMDP calls; its words are checked there",
    "demonstrations": "is the check behind the doors of demonstrations, which have a test of their own",
    "embeddings.Embedding": "a record of functions",
    "embeddings.SampledEmbedding": "a record of functions",
    "embeddings.SampledFeatures": "a result",
    "embeddings.return_embedding": "takes an MDP, which is checked",
    "envs": "takes an MDP, a Gymnasium environment or a Minari data set, whose mistakes have tests of their own",
    "evaluation.expected_next_value": "a step of the recursions, called with their own values",
    "evaluation.rounding_allowance": "takes an MDP, which is checked",
    "expert": "takes an MDP, which is checked, and programs and solutions of its own",
    "files": "takes paths",
    "given": "is the rules",
    "hellinger.squared_hellinger": "is 1 less bhattacharyya, which is a door",
    "hellinger_exact": "fractions in, fractions out; nothing of a run reaches it",
    "mdp.check_mdp": "is what TabularMDP asks; it tells faults where others raise",
    "mdp.running_sums": "takes a kernel of Dynamics, which is checked",
    "mdp_file": "takes a file, whose arrays reach TabularMDP",
    "netcdf": "takes a file",
    "npz": "takes a file",
    "occupancy.blocks": "checks batches itself; its callers are doors",
    "occupancy.state_occupancies": "takes a block of blocks(), which has checked it",
    "offline.ball_chain.BallChain": "what chain_sample calls",
    "offline.ball_chain.ChainSample": "a result",
    "offline.ball_cubes.Cubes": "a result",
    "offline.data_bounds": "takes demonstrations by the check that has a test of its own",
    "offline.data_radius": "takes step counts, dynamics and a clone by the same rules as the one that is a door",
    "offline.step_counts.StepCounts": "a result of step_counts",
    "offline.transitions.add_transitions": "takes trajectories that were checked, once a round",
    "offline.version_space": "takes demonstrations and counts that were checked",
    "online.cholesky": "takes the loop's own matrices, once a round",
    "online.confidence.Confidence": "a record of functions",
    "online.likelihood": "the loop's own, once a round",
    "online.confidence.RoundState": "the loop's own",
    "online.confidence.pair_visits": "takes the loop's own pair",
    "online.loop.OnlineProblem": "a record; what it holds is checked where it is made",
    "online.loop.Problem": "a protocol",
    "online.memory": "the loop's own",
    "online.pair_rules": "takes the loop's own scores and features, once a round",
    "online.policy_filter": "takes the loop's own scores and features, once a round",
    "policies.check_actions": "is a check",
    "policies.digits": "takes numbers of its callers' own",
    "run": "takes configurations, which check their entries, and results of this package",
    "trajectories.Trajectories": "a record, checked by its method, which is a door",
    "trajectories.load_trajectories": "takes a file, whose arrays reach Trajectories.checked",
    "trajectories.save_trajectories": "takes trajectories and a path",
}
"""Public names, or whole folders, to which nothing of a user's comes unchecked, and why."""

CASES = [
    (name, argument, label)
    for name, call in DOORS.items()
    for argument, value in call().items()
    for label, _ in bad(value)
    if (name, argument, label) not in MEANINGFUL and argument not in LABELS.get(name, ())
]


def door(name: str) -> Callable[..., Any]:
    module, _, attribute = name.rpartition(".")
    if module.rpartition(".")[2][:1].isupper():
        module, _, owner = module.rpartition(".")
        return getattr(getattr(importlib.import_module(f"bridge_algos.{module}"), owner), attribute)
    return getattr(importlib.import_module(f"bridge_algos.{module}"), attribute)


def public() -> Iterator[str]:
    for module in pkgutil.walk_packages(bridge_algos.__path__, "bridge_algos."):
        loaded = importlib.import_module(module.name)
        for name, thing in vars(loaded).items():
            own = getattr(thing, "__module__", "") == module.name and not name.startswith("_")
            if own and (inspect.isfunction(thing) or inspect.isclass(thing)):
                yield f"{module.name}.{name}".removeprefix("bridge_algos.")


def test_every_public_function_is_a_door_or_belongs_to_the_house() -> None:
    names, used = list(public()), set()
    for name in names:
        parts = name.split(".")
        owners = {".".join(parts[:i]) for i in range(1, len(parts) + 1)} & set(HOUSE)
        assert name in DOORS or owners, f"{name} takes what nobody checks; add a good call of it to DOORS"
        used |= owners
    assert len(names) > 200
    assert set(HOUSE) == used, "reasons for names that are gone"


@pytest.mark.parametrize("name", DOORS)
def test_the_good_call_is_good(name: str) -> None:
    door(name)(**DOORS[name]())


@pytest.mark.parametrize(("name", "argument", "label"), CASES)
def test_a_bad_value_is_refused_in_a_sentence(name: str, argument: str, label: str) -> None:
    call = DOORS[name]()
    call[argument] = dict(bad(call[argument]))[label]
    with pytest.raises(InputError) as refused:
        door(name)(**call)
    assert str(refused.value).endswith((".", "?"))
