"""A confidence sequence contains the mean for every sample size at once, at least as often as it says."""

import itertools

import numpy as np
import pytest
from scipy.stats import binom

from bridge_theory.errors import InputError
from experiments.compare import sequence
from experiments.compare.sequence import confidence_sequence

LENGTH = 12
EVERY_SEQUENCE = np.array(list(itertools.product([0.0, 1.0], repeat=LENGTH))).T


def share_missed(lower, upper, mean):
    """Exact probability, over all sequences of coin flips, that the interval misses its mean."""
    ones = EVERY_SEQUENCE.sum(axis=0)
    chances = mean**ones * (1 - mean) ** (LENGTH - ones)
    return float(chances[(lower > mean) | (upper < mean)].sum())


@pytest.mark.parametrize("alpha", [0.05, 0.2, 0.4])
def test_coin_flips_are_covered_exactly(alpha):
    """The interval only ever shrinks with m, so that missing at the end is missing at some m; no simulation."""
    lower, upper = confidence_sequence(EVERY_SEQUENCE, 0.0, 1.0, alpha)
    missed = [share_missed(lower, upper, mean) for mean in np.linspace(0.01, 0.99, 99)]
    assert max(missed) <= alpha
    assert max(missed) > alpha / 4  # a sequence that never misses would be useless


def test_a_bet_that_sees_its_own_outcome_is_rejected(monkeypatch):
    """The mutant: it bets only where the observation turns out to be large."""
    monkeypatch.setattr(sequence, "_bets", lambda x, alpha: 2 * x)
    lower, upper = confidence_sequence(EVERY_SEQUENCE, 0.0, 1.0, 0.4)
    assert max(share_missed(lower, upper, mean) for mean in np.linspace(0.01, 0.99, 99)) > 0.4


def test_bets_do_not_depend_on_the_observation_that_they_are_on():
    """Nor on later ones: each is made from what came before alone, and it does depend on that."""
    x = np.random.default_rng(2).random((30, 4))
    bets = sequence._bets(x, 0.05)
    for i in range(30):
        for other in (0.0, 1.0):
            changed = sequence._bets(np.concatenate([x[:i], np.full((30 - i, 4), other)]), 0.05)
            assert (changed[: i + 1] == bets[: i + 1]).all()
            assert (changed[i + 1 :] != bets[i + 1 :]).any() or i == 29


def test_adding_observations_only_shrinks_the_interval():
    sizes = range(1, LENGTH + 1)
    ends = [confidence_sequence(EVERY_SEQUENCE[:m], 0.0, 1.0, 0.1) for m in sizes]
    for (low, high), (next_low, next_high) in itertools.pairwise(ends):
        assert (next_low >= low - 1e-12).all()
        assert (next_high <= high + 1e-12).all()


def test_continuous_observations_are_covered():
    """2000 repetitions of 60 looks; the assertion fails by chance with probability below 5e-7, 1e-6 for both laws."""
    rng, alpha, repetitions = np.random.default_rng(0), 0.1, 2000
    missed = 0
    for a, b in ((0.3, 3.0), (2.0, 2.0)):
        values = 10 * rng.beta(a, b, size=(60, repetitions)) - 5
        mean = 10 * a / (a + b) - 5
        lower, upper = confidence_sequence(values, -5.0, 5.0, alpha)
        missed = int(((lower > mean) | (upper < mean)).sum())
        assert missed <= binom.isf(5e-7, repetitions, alpha)


def test_the_interval_is_outside_of_the_mean_and_narrows():
    widths = []
    for m in (5, 50, 500):
        lower, upper = confidence_sequence(np.tile([[0.2], [0.3]], (m, 1)), 0.0, 1.0)
        assert lower < 0.25 < upper
        widths.append(float((upper - lower)[0]))
    assert widths[0] > 3 * widths[1] > 9 * widths[2]


def test_columns_do_not_mix_and_a_known_value_is_a_point():
    rng = np.random.default_rng(1)
    values = np.column_stack([rng.random(30), np.full(30, 7.0), 100 * rng.random(30)])
    lower, upper = confidence_sequence(values, np.array([0.0, 7.0, 0.0]), np.array([1.0, 7.0, 100.0]))
    assert lower[1] == upper[1] == 7
    for column, scale in ((0, 1.0), (2, 100.0)):
        alone = confidence_sequence(values[:, column], 0.0, scale)
        assert (float(lower[column]), float(upper[column])) == pytest.approx(tuple(map(float, alone)), rel=1e-12)


@pytest.mark.parametrize(
    ("values", "alpha", "sentence"),
    [
        (np.array([0.5, 1.5]), 0.05, "inside the range that is known"),
        (np.array([0.5, np.nan]), 0.05, "inside the range that is known"),
        (np.empty(0), 0.05, "needs observations"),
        (np.array([0.5]), 1.0, "strictly between 0 and 1"),
    ],
)
def test_what_would_void_the_statement_is_refused(values, alpha, sentence):
    with pytest.raises(InputError, match=sentence):
        confidence_sequence(values, 0.0, 1.0, alpha)
