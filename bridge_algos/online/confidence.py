r"""How wide the online confidence set is: multiplier gamma_t, bonuses, data matrix.

Four versions, each a :class:`Confidence`:

- :func:`fixed`: hand-set numbers, as in the published runs;
- :func:`stated`: the paper's formulas to the letter (appendix "Online Estimation"), with the bonus 2 eta where they are
  undefined (a pair seen at most once: log log N);
- :func:`repaired`: audit R1, R2, R6: multiplier from the observed data matrix and the solver's own error, L1 bonus;
- :func:`likelihood`: companion G2, G5, G6: the likelihood set of the answers, without kappa; L1 bonus.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

import bridge_theory as theory
from bridge_algos.asking.ellipsoid import Ellipsoid
from bridge_algos.given import checked
from bridge_algos.mdp import Dynamics, FloatArray, IntArray
from bridge_algos.occupancy import total_occupancies
from bridge_algos.online.cholesky import inverse_root, log_det
from bridge_algos.online.likelihood import LikelihoodFilter
from bridge_theory.bound import Bound
from bridge_theory.errors import InputError

ROUNDING = 1 + 1e-9
"""Factor on the certified multipliers that covers the rounding of double arithmetic."""


@dataclass(frozen=True, eq=False)
class RoundState:
    """What a multiplier may depend on at the start of round t; ``solver_error`` is NaN unless it says it needs it.

    ``ellipsoid``, whose matrix ``matrix`` then is, where the version of the confidence set has one.
    """

    t: int
    matrix: FloatArray
    solver_error: float
    played_visits: list[FloatArray]
    counts_then: list[IntArray]
    ellipsoid: Ellipsoid | None = None

    @cached_property
    def inverse_root(self) -> FloatArray:
        """The inverse Cholesky factor of the data matrix."""
        return inverse_root(self.matrix)

    @property
    def log_det(self) -> float:
        """The logarithm of the data matrix's determinant."""
        return log_det(self.inverse_root)


@dataclass(frozen=True, eq=False)
class Confidence:
    """One version of the online confidence set.

    Args:
        name: fixed, stated, repaired or likelihood.
        multiplier: gamma_t from the state of the round.
        step_bonus: maps pair counts N(s, a) (S, A) to bonuses per step (S, A); a policy's bonus is their
            expectation over its first ``bonus_steps`` steps, at most ``bonus_cap``.
        matrix: which differences enter the data matrix, the ``"observed"`` ones of trajectories or the ``"expected"``
            ones of policies.
        initial_scale: the matrix starts as this multiple of the identity.
        pair_bonus: factor on the bonuses where the pair is chosen; Pi_t takes them as they are.
        needs_history: whether the multiplier needs the occupancies and counts of the pairs played so far.
        needs_error: whether it needs the solver's error.
        answers: makes what Pi_t comes from in a run, where that is not the multiplier; the centre and the matrix of its
            ellipsoid then replace the fitted weights and the data matrix in the choice of the pair.
    """

    name: str
    multiplier: Callable[[RoundState], float]
    step_bonus: Callable[[IntArray], FloatArray]
    bonus_steps: int
    bonus_cap: float
    matrix: Literal["observed", "expected"]
    initial_scale: float
    pair_bonus: float = 1.0
    needs_history: bool = False
    needs_error: bool = False
    answers: Callable[[], LikelihoodFilter] | None = None


@checked
def fixed(gamma: float, bonus_multiplier: float, n_states: int, n_actions: int, horizon: int, lam: float) -> Confidence:
    r"""Hand-set numbers: gamma_t constant, bonus :math:`c \min(\log SA, \sqrt{\log(SA) / N})` a step, c the multiplier.

    The data matrix starts as lambda I (algo:main line 3) and takes in the expected differences (line 9).
    """
    for name, value in (("gamma", gamma), ("bonus multiplier", bonus_multiplier)):
        if not value >= 0:
            raise InputError(f"the {name} is {value}, expected a number of at least 0.")
    log_pairs = float(np.log(n_states * n_actions))

    def step_bonus(counts: IntArray) -> FloatArray:
        rooted = np.sqrt(log_pairs / np.maximum(counts, 1))
        return np.asarray(bonus_multiplier * np.where(counts > 0, np.minimum(log_pairs, rooted), log_pairs))

    return Confidence("fixed", lambda _: float(gamma), step_bonus, horizon, np.inf, "expected", lam)


@checked
def stated(
    embedding_bound: float,
    weight_bound: float,
    dimension: int,
    n_states: int,
    n_actions: int,
    horizon: int,
    rounds: int,
    lam: float,
    delta: float,
    known: bool,
) -> Confidence:
    """The paper's gamma_t and bonus (known dynamics: section "Online Learning with Known Dynamics")."""
    size = {"S": n_states, "A": n_actions, "H": horizon}
    model = {"B": embedding_bound, "W": weight_bound, "d": dimension, "lam": lam, "delta": delta}
    eta = 2 * weight_bound * embedding_bound
    kappa = _curvature(theory.kappa, embedding_bound, weight_bound)

    def bonus(counts: IntArray, failure: float) -> FloatArray:
        defined = np.asarray(theory.xi.estimate(N=np.maximum(counts, 2), eta=eta, delta=failure, **size))
        return np.where(counts >= 2, defined, 2 * eta)

    def known_multiplier(state: RoundState) -> float:
        return float(theory.gamma_known.estimate(t=state.t, T=rounds, **model))

    def unknown_multiplier(state: RoundState) -> float:
        epsilon = theory.net_scale.estimate(t=state.t, lam=lam, B=embedding_bound, W=weight_bound)
        shared = _positive(theory.net_delta, W=weight_bound, d=dimension, epsilon=epsilon, delta=delta)
        squares = 0.0
        for age, (visits, counts) in enumerate(zip(state.played_visits, state.counts_then, strict=True), start=1):
            failure = _positive(theory.step_bonus_delta, S=n_states, A=n_actions, t=age, delta=shared)
            squares += float(((visits * bonus(counts, failure)).sum(axis=(1, 2)) ** 2).sum())
        return float(theory.gamma_unknown.estimate(t=state.t, T=rounds, bonus_square_sum=squares, **model))

    def step_bonus(counts: IntArray) -> FloatArray:
        failure = _positive(theory.online_bonus_delta, S=n_states, A=n_actions, delta=delta)
        return bonus(counts, failure)

    return Confidence(
        "stated",
        known_multiplier if known else unknown_multiplier,
        step_bonus,
        horizon,
        np.inf,
        "expected",
        kappa * lam,
        needs_history=not known,
    )


def _curvature(kappa: Bound, embedding_bound: float, weight_bound: float) -> float:
    """The paper's kappa or the repaired one, unless it is larger than any double."""
    value = float(kappa.estimate(B=embedding_bound, W=weight_bound))
    if not np.isfinite(value):
        raise InputError(
            f"kappa, which grows like exp(B W), is larger than any double at B = {embedding_bound:g} and "
            f"W = {weight_bound:g}; use a smaller weight_bound."
        )
    return value


def _positive(probability: Bound, **parameters: float) -> float:
    """A failure probability of the paper, unless A^S makes it smaller than any double."""
    with np.errstate(all="ignore"):
        try:
            value = float(probability.estimate(**parameters))
        except (OverflowError, FloatingPointError, InputError):
            value = 0.0
    if not value > 0:
        raise InputError(
            "the stated bonus shares its failure probability among A^S policies, which underflows double precision "
            "here; use confidence=repaired, which needs no such union."
        )
    return value


@checked
def repaired(
    embedding_bound: float,
    weight_bound: float,
    dimension: int,
    n_states: int,
    n_actions: int,
    horizon: int,
    lam: float,
    delta_w: float,
    delta_p: float,
) -> Confidence:
    r"""Audit R1 and R6: :math:`\rho_t = \kappa (\beta_t + e_t)` with the observed matrix, and the L1 bonus.

    Spends delta_w on the weights and, for unknown dynamics, delta_p on the transitions; both hold for all rounds at
    once, whatever K.
    """
    kappa = _curvature(theory.kappa_differences, embedding_bound, weight_bound)
    scale = kappa * lam

    def multiplier(state: RoundState) -> float:
        log_det_ratio = state.log_det - dimension * np.log(scale)
        beta = theory.beta_repaired_logdet.estimate(
            B=embedding_bound, W=weight_bound, lam=lam, delta_w=delta_w, log_det_ratio=max(log_det_ratio, 0.0)
        )
        return float(kappa * (beta + state.solver_error)) * ROUNDING

    eta = embedding_bound * weight_bound
    step_bonus = _l1_bonus(eta, n_states, n_actions, delta_p)
    return Confidence("repaired", multiplier, step_bonus, horizon - 1, 2 * eta, "observed", scale, needs_error=True)


@checked
def likelihood(
    embedding_bound: float,
    weight_bound: float,
    n_states: int,
    n_actions: int,
    horizon: int,
    lam: float,
    delta_w: float,
    delta_p: float,
) -> Confidence:
    r"""Companion G6: :math:`\Pi_t` from the likelihood set, the pair from the ellipsoid around it (G5); L1 bonus.

    Spends delta_w on the weights and, for unknown dynamics, delta_p on the transitions, as :func:`repaired` does. See
    :mod:`bridge_algos.online.likelihood`.
    """
    scale = _curvature(theory.kappa_differences, embedding_bound, weight_bound) * lam  # of the norm of projections
    eta = embedding_bound * weight_bound

    def radius(state: RoundState) -> float:
        if state.ellipsoid is None:
            raise InputError("the multiplier of the likelihood set must be asked with its ellipsoid, got none.")
        return state.ellipsoid.radius

    return Confidence(
        "likelihood",
        radius,
        _l1_bonus(eta, n_states, n_actions, delta_p),
        horizon - 1,
        2 * eta,
        "observed",
        scale,
        answers=lambda: LikelihoodFilter(weight_bound, delta_w),
    )


def _l1_bonus(eta: float, n_states: int, n_actions: int, delta_p: float) -> Callable[[IntArray], FloatArray]:
    """The bonus of audit R6 from pair counts."""

    def step_bonus(counts: IntArray) -> FloatArray:
        size = {"S": n_states, "A": n_actions, "delta_P": delta_p}
        return np.asarray(eta * theory.bonus_radius.estimate(N=counts, **size)) * ROUNDING

    return step_bonus


def pair_visits(dynamics: Dynamics, pair: IntArray) -> FloatArray:
    """Expected visits of two deterministic policies (2, S) to every pair over H steps, (2, S, A)."""
    return np.asarray(total_occupancies(dynamics, pair)[:, :, None] * np.eye(dynamics.n_actions)[pair])
