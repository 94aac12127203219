"""What a run in continuous control is: one immutable, validated description, saved with every result."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any, get_args

from bridge_algos.online.loop import FITS
from bridge_algos.online.pair_rules import PairRule
from bridge_algos.run.configuration import (
    Configuration,
    NumberRule,
    check_choices,
    check_kinds,
    check_numbers,
    checked_algorithms,
)
from bridge_theory.errors import InputError

ALGORITHMS = ("bridge", "pbrl", "bc")
SHORT_NAMES = ("reacher", "ant")
NORMALISATIONS = ("demonstrations", "expert", "none")

_KINDS = (
    ("algorithms", list | tuple, "a list of names"),
    ("expert", str | None, "the path of an expert's file"),
    ("demonstrations", str | None, "the path of a file, or a Minari data set's id"),
    ("include_expert", bool, "true or false"),
    ("common_starts", bool, "true or false"),
    ("normalise_embedding", bool, "true or false"),
    ("until_decided", bool, "true or false"),
    ("embedding", str, "an embedding's name"),
    ("oracle_options", dict, "a JSON object"),
)
_COUNTS = ("n_demonstrations", "held_out", "horizon", "hidden", "epochs", "batch", "rounds", "comparisons")
_NUMBERS: tuple[NumberRule, ...] = (
    (_COUNTS, int, lambda x: x >= 1, "a whole number of at least 1"),
    (("small", "large"), int, lambda x: x >= 0, "a whole number of at least 0"),
    (("rollouts",), int, lambda x: x >= 2, "a whole number of at least 2"),
    (("gamma", "lam"), int | float, lambda x: x >= 0, "a number of at least 0"),
    (
        ("sigma", "large_factor", "radius", "weight_bound", "initial_scale", "slope", "rate"),
        int | float,
        lambda x: x > 0,
        "a positive number",
    ),
)


def is_continuous(environment: str) -> bool:
    """Whether a name is one of continuous control: a short name, or a Gymnasium id such as ``Hopper-v5``.

    >>> is_continuous("reacher"), is_continuous("Hopper-v5"), is_continuous("gridworld"), is_continuous("mine.npz")
    (True, True, False, False)
    """
    return environment.lower() in SHORT_NAMES or re.fullmatch(r"[\w./:-]+-v\d+", environment) is not None


@dataclass(frozen=True)
class ContinuousConfig(Configuration):
    """Everything that decides the numbers of a run in continuous control, except the seed.

    Args:
        environment: ``"reacher"``, ``"ant"``, or the Gymnasium id of a MuJoCo environment.
        algorithms: which of ``ALGORITHMS`` to run, on the same demonstrations and candidates.
        expert, expert_digest: file of the expert that demonstrates, None for the shipped one; and the digest of the
            policy in it, which a run fills in, so that results of two experts are never mixed.
        include_expert: whether the expert is a candidate. The published runs include it; the default does not, since a
            learner has the expert's demonstrations and not the expert.
        n_demonstrations: n, how many demonstrations the expert gives in each seed.
        held_out: how many more it gives to report the clone's likelihood on; they decide nothing.
        demonstrations, demonstrations_digest: source of demonstrations that all seeds use instead, and the digest of
            their content, filled in likewise; every fifth of them is held out.
        horizon: H, after which episodes are cut.
        hidden, epochs, batch, rate: of the cloning, see :func:`bridge_algos.continuous.cloning.clone`.
        normalise_observations: by whose statistics the clone standardises its observations, ``"demonstrations"``,
            ``"expert"`` (as the expert does, if it does; in the published runs the simulator does it for everyone),
            or ``"none"``.
        small, large, sigma, large_factor: of the candidates, see
            :func:`bridge_algos.continuous.candidates.make_candidates`.
        radius: of the offline set, in units of the embedding.
        embedding: name of the embedding; see :mod:`bridge_algos.continuous.embeddings`.
        normalise_embedding: divide each coordinate by its largest absolute value in the demonstrations.
        rollouts: how many estimate the features of a policy.
        common_starts: whether these start from states that all policies share, or each policy from its own, as in the
            published runs, where policies also differ by luck.
        rounds, comparisons: T, and K trajectory pairs compared in a round.
        pair_rule: see :func:`bridge_algos.online.pair_rules.choose_pair`.
        confidence: ``"fixed"``: hand-set gamma. Nothing else exists here.
        gamma: multiplier of the norm in the set Pi_t and in the rule ``"ucb"``.
        initial_scale: the data matrix starts as this multiple of the identity.
        until_decided: ask nothing once Pi_t holds one policy.
        oracle_options: of :class:`bridge_algos.online.oracles.ReturnOracle`.
        weight_bound, slope, lam, fit: of the preference model; see :class:`bridge_algos.online.loop.Learner`.
    """

    algorithms: tuple[str, ...] = ALGORITHMS
    expert: str | None = None
    expert_digest: str | None = None
    include_expert: bool = False
    n_demonstrations: int = 20
    held_out: int = 10
    demonstrations: str | None = None
    demonstrations_digest: str | None = None
    horizon: int = 50
    hidden: int = 64
    epochs: int = 100
    batch: int = 32
    rate: float = 1e-3
    normalise_observations: str = "demonstrations"
    small: int = 100
    large: int = 400
    sigma: float = 0.01
    large_factor: float = 5.0
    radius: float = 0.65
    embedding: str = "average_state_action"
    normalise_embedding: bool = False
    rollouts: int = 200
    common_starts: bool = True
    rounds: int = 200
    comparisons: int = 10
    pair_rule: PairRule = "max_uncertainty"
    confidence: str = "fixed"
    gamma: float = 10.0
    initial_scale: float = 0.01
    until_decided: bool = True
    oracle_options: dict[str, float] = field(default_factory=dict)
    weight_bound: float = 10.0
    slope: float = 1.0
    lam: float = 0.0
    fit: str = "continual"

    def __post_init__(self) -> None:
        check_kinds(self, _KINDS)
        object.__setattr__(self, "algorithms", checked_algorithms(self.algorithms, ALGORITHMS))
        if self.confidence != "fixed":
            raise InputError(
                f"confidence is {self.confidence!r}, but in continuous control features are estimates from rollouts "
                "and their bound is only observed, so that nothing can be certified; leave it at 'fixed'."
            )
        choices = {"fit": FITS, "pair_rule": get_args(PairRule), "normalise_observations": NORMALISATIONS}
        check_choices(self, choices)
        check_numbers(self, _NUMBERS)
        if self.fit == "exact" and not self.lam > 0:
            raise InputError("fit='exact' needs a positive lam, without which the optimum may not exist; set lam too.")


_PUBLISHED: dict[str, dict[str, Any]] = {
    "reacher": {
        "expert": "reacher-zoo",  # trained with the published expert's settings
        "normalise_observations": "expert",
        "common_starts": False,
    },
    "ant": {
        "common_starts": False,
        "n_demonstrations": 30,
        "horizon": 100,
        "hidden": 256,
        "normalise_observations": "none",
        "radius": 0.3,
        "rounds": 100,
        "gamma": 20.0,
        "pair_rule": "greedy_vs_random",
    },
}


def continuous_preset(name: str, environment: str) -> ContinuousConfig:
    """The settings of the authors' published runs, but for ``include_expert``; others take the defaults.

    On Reacher the pair rule is that of the parameters stored beside the runs, the widest pair. Their stored data
    contradict it: they are those of the greedy policy against a random one, as the paper's appendix "Continuous
    implementation" says throughout. The experts are this package's own; the texts of ``bridge-rl reproduce
    fig2-reacher`` and ``fig2-ant`` list what else is not as in the runs.

    >>> continuous_preset("published", "ant").radius
    0.3
    """
    if name != "published":
        raise InputError(
            f"preset {name!r} does not exist for {environment}: in continuous control there are estimates only and "
            "nothing to certify; expected 'published'."
        )
    key = environment.lower().removesuffix("-v5")
    return ContinuousConfig(key if key in SHORT_NAMES else environment, **_PUBLISHED.get(key, {}))
