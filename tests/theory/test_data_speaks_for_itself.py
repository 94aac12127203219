"""Data-dependent bounds from count tables, against small cases worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from bridge_theory import bounds_from_counts
from bridge_theory.errors import InputError
from bridge_theory.from_data import contradicted_states


def _tables() -> tuple[np.ndarray, np.ndarray]:
    """Four demonstrations of two steps on three states: 0 then 1 (three times), 0 then 0 (once); state 2 unseen."""
    visits = np.zeros((2, 3, 2), dtype=int)
    visits[0, 0, 1] = 4
    visits[1, 1, 0], visits[1, 0, 1] = 3, 1
    transitions = np.zeros((1, 3, 2, 3), dtype=int)
    transitions[0, 0, 1] = [1, 3, 0]
    return visits, transitions


def test_values_by_hand() -> None:
    values = bounds_from_counts(*_tables(), delta="0.1", mass="0.04")
    expected = {
        "missing_mass_observed": 1 - (0.1 / (3 * 3)) ** (1 / 4),
        "transition_kl_budget": math.log(math.comb(6, 2)) + math.log(10),
        "transition_error_counts": 1 - math.exp(-(2 * math.log(math.comb(6, 2)) + math.log(10)) / 8),
        "policy_kl_budget": math.log(5) + math.log(4) + math.log(2) + math.log(10),
        "offline_radius_stochastic": math.sqrt(1 - math.exp(-math.log(400) / 8)),
        "offline_radius_mass": 0.2,
    }
    assert set(values) == set(expected)
    for name, number in expected.items():
        assert values[name].enclosure.middle == pytest.approx(number, rel=1e-12), name


def test_mass_is_optional_and_one_step_has_no_transitions() -> None:
    visits = np.array([[[3, 0], [0, 2]]])
    values = bounds_from_counts(visits, np.zeros((0, 2, 2, 2), dtype=int), delta="0.1")
    assert "offline_radius_mass" not in values
    assert values["missing_mass_observed"].enclosure.upper == 0
    assert values["transition_kl_budget"].enclosure.middle == pytest.approx(math.log(10))


def test_a_refuted_deterministic_expert_leaves_no_bound_that_assumes_one() -> None:
    """State 0 shows action 1 at the first step and action 0 at the second."""
    visits, transitions = _tables()
    assert contradicted_states(visits).size == 0
    visits[1, 0] = [1, 0]
    assert contradicted_states(visits).tolist() == [0]
    values = bounds_from_counts(visits, transitions, delta="0.1", mass="0.04")
    assert set(values) == {"transition_kl_budget", "policy_kl_budget", "offline_radius_stochastic"}


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda v, t: (v, t[:0]), r"expected \(H, S, A\) and \(H-1, S, A, S\)"),
        (lambda v, t: (v[0], t), "expected"),
        (lambda v, t: (v[:, :0], t), "expected"),
        (lambda v, t: (v / 2, t), "must be tables of whole numbers"),
        (lambda v, t: (v, -t), "must be tables of whole numbers"),
        (lambda v, t: (v * np.array([1, 2])[:, None, None], t), r"the steps hold \[4, 8\] recorded actions"),
        (lambda v, t: (v * 0, t), r"the steps hold \[0, 0\]"),
    ],
)
def test_tables_that_do_not_fit(spoil: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        bounds_from_counts(*spoil(*_tables()), delta="0.1")
