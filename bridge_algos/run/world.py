"""What all seeds of a run share: the environment, its expert, and the policy that regret is measured against."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bridge_algos.demonstrations import excluded
from bridge_algos.embeddings import Embedding, make_embedding, return_embedding
from bridge_algos.envs.registry import make_mdp
from bridge_algos.expert.experts import Expert, make_expert
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.mdp_file import load_mdp
from bridge_algos.offline.cloning import action_counts
from bridge_algos.offline.radius import named_radii
from bridge_algos.online.oracles import BradleyTerryOracle, Oracle, ReturnOracle
from bridge_algos.run.config import RADII, RunConfig
from bridge_algos.trajectories import Trajectories, load_trajectories
from bridge_theory.errors import InputError

MOST_STEPS = 10**8
"""Recorded steps that fit into memory."""

EXPELLED = "noisy demonstrations can expel the expert from the offline set"
FOREIGN = "the environment excludes the demonstrations (noisy actions, or from another environment)"
CHANGING = "the offline radius is proved for an expert whose action in a state does not depend on the step"
CONTRADICTORY = "the demonstrations refute the deterministic stationary expert that the offline radius is proved for"
HAND_SET = "nothing guarantees that an offline set of hand-set radius contains the best policy"


@dataclass(frozen=True, eq=False)
class World:
    """Environment, expert and yardsticks of a run.

    Args:
        w_star: (d,) true weights when the utility is linear in the embedding, else None.
        utility_scale: utility per unit of reward, <phi(pi), w*> = utility_scale J(pi); NaN without w*.
        weight_bound: W.
        radii: the offline radius by name; see :mod:`bridge_algos.offline.radius`.
        demonstrations: those of the configured file, or None where each seed draws its own.
    """

    mdp: TabularMDP
    expert: Expert
    embedding: Embedding
    w_star: FloatArray | None
    utility_scale: float
    weight_bound: float
    radii: dict[str, float]
    demonstrations: Trajectories | None

    @property
    def optimum(self) -> IntArray:
        """(S,) the best stationary deterministic policy found, which pseudo-regret is measured against."""
        return self.expert.best_stationary.policy


def build_world(config: RunConfig) -> World:
    """Environment, expert and yardsticks of a configuration; deterministic."""
    mdp = _environment(config)
    demonstrations = _demonstrations(config, mdp)
    n = config.n_demonstrations if demonstrations is None else len(demonstrations)
    if n * mdp.horizon > MOST_STEPS:
        raise InputError(
            f"{n:,} demonstrations of {mdp.horizon:,} steps are more than the {MOST_STEPS:,} steps kept here."
        )
    expert = make_expert(mdp, config.expert, config.discount, config.solver)
    embedding = _embedding(config.embedding, mdp)
    weight_bound = 1 / embedding.bound if config.weight_bound is None else config.weight_bound
    w_star, scale = None, np.nan
    if config.embedding == "state_action_counts":
        w_star, scale = _utility(mdp, weight_bound)
    elif config.embedding == "return":
        w_star, scale = np.array([weight_bound]), weight_bound
    radii = named_radii(mdp.dynamics, expert.policy, n, config.delta)
    return World(mdp, expert, embedding, w_star, scale, weight_bound, radii, demonstrations)


def with_digests(config: RunConfig) -> RunConfig:
    """The configuration with the digests of the files that it names, so that a run notices when one changes."""
    changes = {}
    if _is_file(config) and config.environment_digest is None and Path(config.environment).is_file():
        changes["environment_digest"] = digest(config.environment)
    if config.demonstrations is not None and config.demonstrations_digest is None:
        changes["demonstrations_digest"] = digest(config.demonstrations)
    return config.but(**changes)


def caveats(config: RunConfig, world: World) -> list[str]:
    """What of a run's settings takes the theory's guarantees away; empty when they hold for its confidence sets."""
    fault = None if world.demonstrations is None else excluded(world.mdp, world.demonstrations)
    foreign = [] if fault is None else [f"{FOREIGN}: {fault}"]
    if config.confidence == "fixed":
        return [*foreign, "gamma and bonuses are hand-set numbers, without a guarantee"]
    oracle = build_oracle(config, world)
    broken = {
        f"the teacher breaks: {getattr(oracle, 'breaks', 'unknown')}": config.oracle != "bradley-terry",
        "the fitted slope is not that of the teacher": config.slope != 1,
        "features are sampled, and their error is in no bound": config.rollouts is not None,
        "the transition bonus holds for counts, not for a network": config.transition_model == "mlp",
        "the stated multiplier and bonuses are not proved": config.confidence == "stated",
        EXPELLED: config.noise > 0,
        HAND_SET: config.radius not in RADII,
        CHANGING: config.radius in RADII and world.demonstrations is None and _changes(world.expert.policy),
        CONTRADICTORY: config.radius in RADII and _contradictory(world),
    }
    return foreign + [reason for reason, holds in broken.items() if holds]


def _changes(policy: IntArray) -> bool:
    """Whether a time-dependent policy is not the same at every step."""
    return policy.ndim == 2 and bool((policy != policy[0]).any())


def _contradictory(world: World) -> bool:
    """Whether the demonstrations of a file show more than one action in some state."""
    if world.demonstrations is None:
        return False
    counts = action_counts(world.demonstrations, world.mdp.n_states, world.mdp.n_actions)
    return bool(((counts > 0).sum(axis=1) > 1).any())


def digest(path: str) -> str:
    """SHA-256 of a file, by which a run recognises its environment and its demonstrations."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}); give the path of a file.") from None


def _is_file(config: RunConfig) -> bool:
    return config.environment.endswith(".npz")


def _environment(config: RunConfig) -> TabularMDP:
    if not _is_file(config):
        return make_mdp(config.environment, **config.environment_options)
    if config.environment_options:
        raise InputError(
            f"environment_options is {config.environment_options!r}, but {config.environment} is the file of an MDP, "
            "which takes none; change the file."
        )
    mdp = load_mdp(config.environment)
    _check_unchanged(config.environment, config.environment_digest)
    return mdp


def _check_unchanged(path: str, known: str | None) -> None:
    if known not in (None, digest(path)):
        raise InputError(f"{path} has changed since this run was configured; use another --out for the new file.")


def _demonstrations(config: RunConfig, mdp: TabularMDP) -> Trajectories | None:
    path = config.demonstrations
    if path is None:
        return None
    _check_unchanged(path, config.demonstrations_digest)
    return load_trajectories(path, mdp.n_states, mdp.n_actions, mdp.horizon)


def build_oracle(config: RunConfig, world: World) -> Oracle:
    """The configured teacher."""
    if config.oracle == "returns":
        return return_oracle(config.oracle_options)
    if world.w_star is None:
        raise InputError(
            f"the Bradley-Terry oracle needs rewards that are linear in the embedding, but {config.embedding!r} counts "
            "no pairs; use the embedding 'state_action_counts'."
        )
    return BradleyTerryOracle(world.embedding, world.w_star)


def return_oracle(options: dict[str, float]) -> ReturnOracle:
    """The teacher that compares returns, with the options of :class:`ReturnOracle`."""
    known = list(ReturnOracle.__dataclass_fields__)
    for name, value in options.items():
        if name not in known:
            raise InputError(f"the oracle has no option {name!r}; its options are {', '.join(known)}.")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"the oracle's {name} is {value!r}, expected a number.")
    return ReturnOracle(**options)


def _embedding(name: str, mdp: TabularMDP) -> Embedding:
    if name == "return":
        return return_embedding(mdp)
    return make_embedding(name, mdp.n_states, mdp.n_actions, mdp.horizon)


def _utility(mdp: TabularMDP, weight_bound: float) -> tuple[FloatArray, float]:
    """w* proportional to the expected reward, of norm W; a constant shift of the reward changes no preference."""
    reward = mdp.expected_reward.ravel()
    norm = float(np.linalg.norm(reward))
    if norm == 0:
        raise InputError(f"every expected reward of {mdp.name!r} is zero, so that no preference can be expressed.")
    scale = weight_bound / norm
    return scale * reward, scale
