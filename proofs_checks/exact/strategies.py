"""Instances entirely under Hypothesis' control: models, policies, demonstrations, counts, both generic and awkward.

Rows are drawn as integer weights among small numbers, zeros (support gaps) and 10^3 or 10^6 (rare states, rows that are
nearly certain); states may also be traps. Everything is drawn, nothing is seeded: failures shrink and replay.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from proofs_checks.exact.laws import Choice, History, stationary_policy
from proofs_checks.exact.model import Kernel, Model, point

Row = tuple[Fraction, ...]

_WEIGHTS = (0, 1, 2, 3, 1000, 10**6)


@st.composite
def rows(draw: DrawFn, size: int, weights: Sequence[int] = _WEIGHTS) -> Row:
    """A probability vector with integer weights; all zeros become certainty of the first entry."""
    drawn = draw(st.lists(st.sampled_from(weights), min_size=size, max_size=size))
    return tuple(Fraction(w, sum(drawn)) for w in drawn) if any(drawn) else tuple(point(0, size))


def square_rows() -> SearchStrategy[Row]:
    """Rows of two states whose entries are squares, so that their roots are rational."""
    tops = ((9, 25), (16, 25), (25, 169), (144, 169), (49, 625), (0, 1), (1, 1))
    return st.sampled_from([(Fraction(a, b), Fraction(b - a, b)) for a, b in tops])


@st.composite
def kernels(draw: DrawFn, n_states: int, n_actions: int, weights: Sequence[int] = _WEIGHTS) -> Kernel:
    """A kernel whose rows are drawn freely or trap the state."""
    row = rows(n_states, weights)
    return tuple(
        tuple(tuple(point(s, n_states)) if draw(st.integers(0, 5)) == 5 else draw(row) for _ in range(n_actions))
        for s in range(n_states)
    )


@st.composite
def models(
    draw: DrawFn, max_states: int = 3, max_actions: int = 2, max_horizon: int = 3, weights: Sequence[int] = _WEIGHTS
) -> Model:
    """A model with one to ``max_states`` states and so on."""
    n_states, n_actions = draw(st.integers(1, max_states)), draw(st.integers(1, max_actions))
    return Model(
        draw(rows(n_states, weights)), draw(kernels(n_states, n_actions, weights)), draw(st.integers(1, max_horizon))
    )


def actions_of(model: Model) -> SearchStrategy[tuple[int, ...]]:
    """A deterministic stationary policy."""
    return st.tuples(*[st.integers(0, model.n_actions - 1)] * model.n_states)


@st.composite
def choices(draw: DrawFn, model: Model, weights: Sequence[int] = _WEIGHTS) -> Choice:
    """A policy: stationary and stochastic, or one that depends on the whole history."""
    tables = [[draw(rows(model.n_actions, weights)) for _ in range(model.n_states)] for _ in range(2)]
    if draw(st.booleans()):
        return stationary_policy(tables[0])
    return _first_state_remembered(tables)


def _first_state_remembered(tables: list[list[Row]]) -> Choice:
    def choice(history: History) -> Row:
        return tables[(history[0] + sum(history[1::2])) % 2][history[-1]]

    return choice


@dataclass(frozen=True)
class Pair:
    """A model, its estimate with another kernel, and two deterministic policies."""

    model: Model
    estimate: Model
    expert: tuple[int, ...]
    clone: tuple[int, ...]


@st.composite
def pairs(
    draw: DrawFn, max_states: int = 3, max_actions: int = 2, max_horizon: int = 3, weights: Sequence[int] = _WEIGHTS
) -> Pair:
    """Two kernels and two deterministic policies on one state space."""
    model = draw(models(max_states, max_actions, max_horizon, weights))
    estimate = model.under(draw(kernels(model.n_states, model.n_actions, weights)))
    return Pair(model, estimate, draw(actions_of(model)), draw(actions_of(model)))


@dataclass(frozen=True)
class Study:
    """A model, a deterministic expert, and demonstrations ``(s_1, a_1, ..., s_H, a_H)`` that it can produce."""

    model: Model
    expert: tuple[int, ...]
    demonstrations: tuple[History, ...]


@st.composite
def studies(
    draw: DrawFn,
    max_states: int = 4,
    max_actions: int = 2,
    max_horizon: int = 4,
    max_demonstrations: int = 3,
    noisy: bool = False,
) -> Study:
    """A deterministic expert and demonstrations chosen by Hypothesis among those of positive probability.

    ``noisy`` demonstrations take any action at any time, as those of a stochastic expert do.
    """
    model = draw(models(max_states, max_actions, max_horizon))
    expert = draw(actions_of(model))
    n = draw(st.integers(1, max_demonstrations))
    return Study(model, expert, tuple(draw(_demonstrations(model, expert, noisy)) for _ in range(n)))


@st.composite
def _demonstrations(draw: DrawFn, model: Model, expert: tuple[int, ...], noisy: bool) -> History:
    def action(state: int) -> int:
        return draw(st.integers(0, model.n_actions - 1)) if noisy else expert[state]

    state = draw(st.sampled_from([s for s, p in enumerate(model.initial) if p]))
    history: History = (state, action(state))
    for _ in range(model.horizon - 1):
        row = model.kernel[history[-2]][history[-1]]
        state = draw(st.sampled_from([s for s, p in enumerate(row) if p]))
        history = (*history, state, action(state))
    return history


def count_rows(size: int, most: int = 6) -> SearchStrategy[tuple[int, ...]]:
    """Counts of one cell, zeros included."""
    return st.tuples(*[st.integers(0, most)] * size)
