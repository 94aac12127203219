"""What a run is: one immutable, validated description, saved with every result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, get_args

from bridge_algos.envs.counterexamples import instance
from bridge_algos.offline.cloning import TieBreak
from bridge_algos.offline.transitions import EmptyRow
from bridge_algos.online.pair_rules import PairRule
from bridge_algos.run.configuration import (
    ALGORITHMS,
    Configuration,
    NumberRule,
    check_choices,
    check_kinds,
    check_numbers,
    checked_algorithms,
)
from bridge_theory.errors import InputError

EXPERTS = ("discounted-lp", "finite-horizon-lp", "best-stationary")
RADII = ("stated", "stated-known", "repaired", "zero")

_CHOICES: dict[str, tuple[str, ...]] = {
    "expert": EXPERTS,
    "transition_model": ("counts", "mlp"),
    "candidates": ("exact", "rejection"),
    "confidence": ("fixed", "stated", "repaired", "likelihood"),
    "oracle": ("returns", "bradley-terry"),
    "fit": ("exact", "adam"),
    "tie_break": get_args(TieBreak),
    "empty_row": get_args(EmptyRow),
    "pair_rule": get_args(PairRule),
}
_COUNTS = ("rounds", "n_demonstrations", "comparisons", "proposals", "candidate_limit", "search_size")
_NUMBERS: tuple[NumberRule, ...] = (
    (_COUNTS, int, lambda x: x >= 1, "a whole number of at least 1"),
    (("rollouts",), int, lambda x: x >= 2, "a whole number of at least 2, or null for exact features"),
    (("gamma", "bonus_multiplier"), int | float, lambda x: x >= 0, "a number of at least 0"),
    (("slope", "lam", "weight_bound"), int | float, lambda x: x > 0, "a positive number"),
    (("discount", "delta"), int | float, lambda x: 0 < x < 1, "a number strictly between 0 and 1"),
    (("noise",), int | float, lambda x: 0 <= x <= 1, "a probability"),
)
_RADIUS: NumberRule = (
    ("radius",),
    int | float,
    lambda x: x >= 0,
    f"a number of at least 0 or one of {', '.join(RADII)}",
)
_OPTIONAL = ("rollouts", "weight_bound")


@dataclass(frozen=True)
class RunConfig(Configuration):
    """Everything that decides the numbers of a run in a tabular environment, except the seed.

    Args:
        environment, environment_options: what ``make_mdp`` takes, or an MDP's ``.npz`` file without options.
        environment_digest: SHA-256 of that file, by which a run recognises it.
        algorithms: which of ``ALGORITHMS`` to run, on the same demonstrations.
        expert: who demonstrates: ``"discounted-lp"`` (published runs), ``"finite-horizon-lp"``, ``"best-stationary"``.
        discount: of the discounted LP.
        solver: of the linear program, by its cvxpy name.
        n_demonstrations: n, how many demonstrations the expert gives in each seed.
        demonstrations, demonstrations_digest: path of a file that all seeds use instead, and its SHA-256.
        noise: probability that a recorded action is replaced by a random one.
        tie_break: what the clone does in unvisited states.
        transition_model: ``"counts"``, or ``"mlp"`` (the paper's network for Gridworld; needs torch).
        empty_row: what the count estimate does without data.
        radius: of the offline set, a number or one of ``RADII``.
        candidates: ``"exact"`` enumerates the offline set, or samples ``candidate_limit`` policies from it when it is
            larger, by a Gibbs chain where it cannot be listed, the clone among them; ``"rejection"`` keeps those of
            ``proposals`` random policies that lie in it (the paper's way), and the clone where these are few.
        search_size: how many policies PbRL searches when there are too many to take all; at most half of them are
            lent from the offline set, the others are random.
        embedding: name of the embedding, one of :func:`bridge_algos.embeddings.make_embedding` or ``"return"``.
        rounds, comparisons: T, and K trajectory pairs compared in a round.
        pair_rule: see :func:`bridge_algos.online.pair_rules.choose_pair`; unlike the paper's, no rule compares a policy
            with itself while another one is left.
        confidence: ``"fixed"`` (then ``gamma`` and ``bonus_multiplier``), ``"stated"``, ``"repaired"`` or
            ``"likelihood"``; see :mod:`bridge_algos.online.confidence`.
        oracle: ``"returns"`` with ``oracle_options`` of :class:`ReturnOracle`, or ``"bradley-terry"``.
        weight_bound: W; None chooses W = 1 / B, which makes utilities differ by at most 2.
        slope, lam, fit: of the preference model.
        rollouts: None for exact features, or how many rollouts estimate those of a policy.
        delta: failure probability of each certified event.
    """

    environment_options: dict[str, Any] = field(default_factory=dict)
    environment_digest: str | None = None
    algorithms: tuple[str, ...] = ("bridge", "pbrl", "bc")
    expert: str = "discounted-lp"
    discount: float = 0.99
    solver: str = "HIGHS"
    n_demonstrations: int = 10
    demonstrations: str | None = None
    demonstrations_digest: str | None = None
    noise: float = 0.0
    tie_break: TieBreak = "random"
    transition_model: str = "counts"
    empty_row: EmptyRow = "uniform"
    radius: float | str = 0.96
    candidates: str = "exact"
    proposals: int = 500_000
    candidate_limit: int = 20_000
    search_size: int = 1000
    embedding: str = "state_counts"
    rounds: int = 35
    comparisons: int = 10
    pair_rule: PairRule = "uncertainty_and_bonus"
    confidence: str = "fixed"
    gamma: float = 0.15
    bonus_multiplier: float = 0.008
    oracle: str = "returns"
    oracle_options: dict[str, float] = field(default_factory=dict)
    weight_bound: float | None = 1.0
    slope: float = 10.0
    lam: float = 1.0
    fit: str = "adam"
    rollouts: int | None = None
    delta: float = 0.05

    def __post_init__(self) -> None:
        check_kinds(
            self,
            (
                ("environment", str, "a name or the path of a file"),
                ("embedding", str, "the name of an embedding"),
                ("algorithms", list | tuple, "a list of names"),
                ("environment_options", dict, "a JSON object"),
                ("oracle_options", dict, "a JSON object"),
                ("demonstrations", str | None, "the path of a file"),
            ),
        )
        object.__setattr__(self, "algorithms", checked_algorithms(self.algorithms, ALGORITHMS))
        check_choices(self, _CHOICES)
        check_numbers(self, _NUMBERS, _OPTIONAL)
        if self.radius not in RADII:
            check_numbers(self, (_RADIUS,))


_STAR_PUBLISHED: dict[str, Any] = {
    "n_demonstrations": 2,
    "rounds": 25,
    "embedding": "identity_short",
    "radius": 0.9,
    "gamma": 0.2,
    "bonus_multiplier": 0.01,
}
_GRID_PUBLISHED: dict[str, Any] = {"candidates": "rejection"}
_THEORY: dict[str, Any] = {
    "expert": "best-stationary",
    "oracle": "bradley-terry",
    "embedding": "state_action_counts",
    "confidence": "repaired",
    "radius": "zero",
    "candidates": "exact",
    "empty_row": "self_loop",
    "comparisons": 1,
    "slope": 1.0,
    "weight_bound": None,
    "fit": "exact",
}


PRESETS = ("published", "theory", "counterexample")


def preset(name: str, environment: str) -> RunConfig:
    """A named configuration for an environment.

    ``"published"`` are the settings of the authors' published runs (StarMDP, Gridworld; other environments take
    Gridworld's). ``"theory"`` keeps their problem sizes and takes everything else from the theory: Bradley-Terry
    answers, one a round, certified multipliers and bonuses, the version space as offline set. ``"counterexample"``, for
    the environments of that name, are the exact numbers of the ledger's instance and the paper's stated multiplier and
    radius.

    >>> preset("published", "starmdp").radius
    0.9
    """
    size = _STAR_PUBLISHED if environment.lower() in ("starmdp", "starmdp-text") else _GRID_PUBLISHED
    if name == "published":
        return RunConfig(environment, **size)
    if name == "theory":
        kept = {key: size[key] for key in ("n_demonstrations", "rounds") if key in size}
        return RunConfig(environment, **kept, **_THEORY)
    if name == "counterexample":
        return _counterexample(instance(environment), environment)
    raise InputError(f"unknown preset {name!r}; expected one of {', '.join(PRESETS)}.")


def _counterexample(numbers: Mapping[str, str], environment: str) -> RunConfig:
    return RunConfig(
        environment,
        **_THEORY
        | {
            "algorithms": ("bridge-known",),
            "embedding": "return",
            "confidence": "stated",
            "radius": "stated-known",
            "pair_rule": "max_uncertainty",
            "weight_bound": float(Fraction(numbers["W"])),
            "lam": float(Fraction(numbers["lambda"])),
            "delta": float(Fraction(numbers["delta"])),
            "n_demonstrations": int(numbers["n"]),
            "rounds": int(numbers["T"]),
        },
    )
