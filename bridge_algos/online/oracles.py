r"""Who answers the preference queries.

An oracle is any callable ``oracle(first, second, rng) -> outcomes`` over two batches of K trajectories that returns
(K,) floats: 1 where the first is preferred, 0 where the second is, 1/2 for "equal", NaN for "no answer". Those here
carry ``breaks``: which assumption of the theory they violate, or "nothing". The imperfect teachers are those of B-Pref
(Lee et al. 2021).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import expit

from bridge_algos.embeddings import Embedding, SampledEmbedding
from bridge_algos.given import check_fields
from bridge_algos.mdp import FloatArray
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError

Oracle = Callable[[Trajectories, Trajectories, np.random.Generator], FloatArray]


sigmoid: Callable[[FloatArray], FloatArray] = expit
"""1 / (1 + exp(-x)) without overflow, accurate in both tails."""


@dataclass(frozen=True, eq=False)
class BradleyTerryOracle:
    r"""The paper's model: :math:`P(o = 1) = \sigma(\langle \phi(\tau^1) - \phi(\tau^2), w^* \rangle)`."""

    embedding: Embedding | SampledEmbedding
    w_star: FloatArray
    breaks: str = "nothing"

    def __post_init__(self) -> None:
        check_fields(self)
        if len(self.w_star) != self.embedding.dimension:
            raise InputError(
                f"w_star has {len(self.w_star)} entries, expected the embedding's {self.embedding.dimension}."
            )

    def __call__(self, first: Trajectories, second: Trajectories, rng: np.random.Generator) -> FloatArray:
        difference = self.embedding.of_trajectories(first) - self.embedding.of_trajectories(second)
        return (rng.random(len(first)) < sigmoid(difference @ self.w_star)).astype(np.float64)


@dataclass(frozen=True)
class ReturnOracle:
    """Compares realised returns, perfectly (as in the published runs; the default) or with B-Pref's imperfections.

    Args:
        rationality: beta of the logistic choice P(o = 1) = sigma(beta (R_1 - R_2)); infinite: the larger return wins,
            equal returns are decided by a fair coin.
        mistakes: probability that an answer is flipped.
        skip_below: no answer (NaN) when both returns are below this.
        equal_within: answer 1/2 when the returns differ by less than this.
        myopia: discount gamma in (0, 1] by which step h counts gamma^(H - h), so that early steps are forgotten.
    """

    rationality: float = np.inf
    mistakes: float = 0.0
    skip_below: float = -np.inf
    equal_within: float = 0.0
    myopia: float = 1.0

    def __post_init__(self) -> None:
        expectations: tuple[tuple[str, float, Callable[[float], bool], str], ...] = (
            ("rationality", self.rationality, lambda x: x > 0, "a positive number or infinity"),
            ("mistakes", self.mistakes, lambda x: 0 <= x <= 1, "a probability"),
            ("skip_below", self.skip_below, lambda x: x == x, "a number"),
            ("equal_within", self.equal_within, lambda x: x >= 0, "a number of at least 0"),
            ("myopia", self.myopia, lambda x: 0 < x <= 1, "a discount in (0, 1]"),
        )
        for name, value, holds, expected in expectations:
            real = isinstance(value, int | float | np.number) and not isinstance(value, bool | np.complexfloating)
            if not real or not holds(value):
                raise InputError(f"the oracle's {name} is {value!r}, expected {expected}.")

    @property
    def breaks(self) -> str:
        """Which assumption of the theory this teacher violates."""
        reasons = {
            "Bradley-Terry with a known slope: answers are a step function of the returns": np.isinf(self.rationality),
            "Bradley-Terry: flipped answers are not logistic in the utility difference": self.mistakes > 0,
            "one answer a query: skipped queries select the data": self.skip_below > -np.inf,
            "binary answers: ties are reported": self.equal_within > 0,
            "utility linear in the embedding: late steps count more": self.myopia < 1,
        }
        return (
            "; ".join(reason for reason, holds in reasons.items() if holds) or "nothing, if returns are linear in phi"
        )

    def __call__(self, first: Trajectories, second: Trajectories, rng: np.random.Generator) -> FloatArray:
        one, two = self._returns(first), self._returns(second)
        gap = one - two
        coin, flip = rng.random(len(gap)), rng.random(len(gap))
        chance = np.where(gap == 0, 0.5, gap > 0) if np.isinf(self.rationality) else sigmoid(self.rationality * gap)
        outcome: FloatArray = ((coin < chance) != (flip < self.mistakes)).astype(np.float64)
        if self.equal_within > 0:
            outcome[np.abs(gap) < self.equal_within] = 0.5
        if self.skip_below > -np.inf:
            outcome[np.maximum(one, two) < self.skip_below] = np.nan
        return outcome

    def _returns(self, trajectories: Trajectories) -> FloatArray:
        if trajectories.rewards is None:
            raise InputError("a return oracle needs trajectories with rewards; sample them with sample_trajectories.")
        weights = self.myopia ** np.arange(trajectories.horizon - 1, -1, -1)
        return np.asarray(trajectories.rewards @ weights)
