"""The evaluator in exact numbers decides comparisons, and agrees with bridge_algos, which it does not use."""

from __future__ import annotations

import ast
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

import proofs_checks.exact
from bridge_algos.hellinger import squared_hellinger as computed_hellinger
from bridge_algos.mdp import Dynamics
from bridge_theory.errors import InputError
from proofs_checks.exact.certify import at_most
from proofs_checks.exact.every import on_every
from proofs_checks.exact.laws import squared_hellinger, total_variation
from proofs_checks.exact.model import Model, probability_row
from proofs_checks.exact.strategies import Pair, kernels, models, pairs, rows, studies
from proofs_checks.exact.surd import at_most_roots, root, surd

fractions = st.fractions(0, 5, max_denominator=60)


@given(fractions, fractions)
def test_roots_multiply_and_square_exactly(x: Fraction, y: Fraction) -> None:
    assert root(x) * root(y) == root(x * y)
    assert (root(x) + root(y)) * (root(x) - root(y)) == x - y
    assert (root(x) < root(y)) == (x < y)


def test_equal_numbers_written_differently_are_equal() -> None:
    assert root(8) + root(2) == root(18)
    assert (root(2) + root(3)) * (root(2) + root(3)) == 5 + 2 * root(6)
    assert root(Fraction(1, 2)) != Fraction(7, 10)


@given(st.integers(1, 10**24), st.integers(1, 10**6))
def test_squares_are_taken_out_of_large_radicands(k: int, square: int) -> None:
    assert root(k * square**2) == square * root(k)


def test_a_prime_that_python_flint_lists_twice_is_one_square() -> None:
    assert root(27805777972861556333667) == 166667 * root(1001004003003)


def test_a_difference_in_the_fortieth_digit_is_seen() -> None:
    digits = Fraction(int(float(2**0.5) * 10**16), 10**16)
    for _ in range(3):
        digits = (digits + 2 / digits) / 2  # Newton: far beyond double precision
    assert root(2) < digits
    assert not at_most_roots(digits**2, (1, 2))


def test_irrational_numbers_and_negative_roots_are_refused() -> None:
    with pytest.raises(InputError, match="irrational"):
        root(2).rational()
    with pytest.raises(InputError, match="not real"):
        root(Fraction(-1, 3))
    with pytest.raises(InputError, match="no probability vector"):
        probability_row(["1/2", "1/3"])


@given(pairs(max_states=3, max_actions=2, max_horizon=3, weights=(0, 1, 2, 5)))
def test_distances_agree_with_the_code_that_users_run(pair: Pair) -> None:
    def dynamics(model: Model) -> Dynamics:
        return Dynamics(np.array(model.kernel, float), np.array(model.initial, float), model.horizon)

    exact = squared_hellinger(pair.model.law(pair.expert), pair.estimate.law(pair.clone))
    computed = computed_hellinger(
        dynamics(pair.model), np.array(pair.expert), dynamics(pair.estimate), np.array(pair.clone)
    )
    assert computed == pytest.approx(float(exact), abs=1e-12)


@given(models(), st.data())
def test_generated_models_are_models(model: Model, data: st.DataObject) -> None:
    assert sum(model.initial) == 1
    assert all(sum(row) == 1 and min(row) >= 0 for per_state in model.kernel for row in per_state)
    policy = data.draw(st.tuples(*[st.integers(0, model.n_actions - 1)] * model.n_states))
    assert sum(model.law(policy).values()) == 1


def test_strategies_reach_the_awkward_cases() -> None:
    """Support gaps, rare states, traps and point masses do occur among a few hundred draws."""
    seen: set[str] = set()

    def look(kernel: tuple[tuple[tuple[Fraction, ...], ...], ...]) -> bool:
        for s, per_state in enumerate(kernel):
            for row in per_state:
                seen.update(["gap"] * (0 in row) + ["rare"] * any(0 < p < Fraction(1, 100) for p in row))
                seen.update(["trap"] * (row[s] == 1) + ["generic"] * (len({*row}) == len(row)))
        return True

    assert on_every("kernels", kernels(3, 2), look, 300).holds
    assert seen == {"gap", "rare", "trap", "generic"}


@given(studies())
def test_demonstrations_are_possible_and_follow_the_expert(study) -> None:
    law = study.model.law(study.expert)
    assert all(h in law for h in study.demonstrations)


@given(rows(3), rows(3))
def test_total_variation_is_the_largest_gap_of_an_event(p: tuple[Fraction, ...], q: tuple[Fraction, ...]) -> None:
    events = [sum(p[i] - q[i] for i in range(3) if mask >> i & 1) for mask in range(8)]
    assert total_variation(dict(enumerate(p)), dict(enumerate(q))) == max(events)


def test_undecided_comparisons_are_never_passes() -> None:
    assert not at_most(surd(1), lambda: arb("nan"))
    assert not at_most(0, lambda: arb(0, 1))


def test_a_failure_is_shrunk_and_an_empty_check_does_not_hold() -> None:
    assert on_every("small", st.integers(0, 99), lambda k: k < 17, 300).failures == ("small: fails for 17",)
    assert not on_every("none", st.integers().filter(lambda k: False), lambda k: True, 50).holds


def test_the_evaluator_shares_no_code_with_bridge_algos_and_no_formula_of_bridge_theory() -> None:
    allowed = {"bridge_theory.errors", "bridge_theory.arithmetic.flint_balls"}
    room = Path(proofs_checks.exact.__file__).parent
    for file in room.glob("*.py"):
        modules = {node.module for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.ImportFrom)}
        used = {m for m in modules if m and m.startswith("bridge_")}
        assert file.name == "certify.py" or used <= allowed, file.name
