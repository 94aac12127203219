"""Intervals of bounded quantities stay in their range, printed and drawn, and few seeds are shown themselves."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from bridge_algos.run.config import preset
from bridge_algos.run.interval import SHOWN_SEEDS, interval
from bridge_algos.run.plots import draw_errors, draw_means, draw_seeds, figure
from bridge_algos.run.seed import run_seed
from bridge_algos.run.summary import mean_of, mean_over_seeds, table
from bridge_algos.run.world import build_world
from bridge_theory.errors import InputError

STYLE = {"color": "#0072B2", "label": "x"}


@given(
    st.lists(st.floats(0, 1), min_size=2, max_size=40),
    st.sampled_from([(0.0, np.inf), (-np.inf, 1.0), (0.0, 1.0), (-5.0, 1e9), (-np.inf, np.inf)]),
)
def test_ends_enclose_the_mean_and_stay_in_the_range(values: list[float], ends: tuple[float, float]) -> None:
    mean, lower, upper = interval(values, *ends)
    assert ends[0] <= lower <= mean + 1e-12
    assert mean - 1e-12 <= upper <= ends[1]


def test_a_range_that_is_far_changes_nothing() -> None:
    values = np.random.default_rng(0).normal(size=(30, 4))
    mean, half = mean_over_seeds(values)
    for ends in ((-np.inf, np.inf), (-1e6, np.inf), (-np.inf, 1e6), (-1e6, 1e6)):
        found = interval(values, *ends)
        np.testing.assert_allclose(found, (mean, mean - half, mean + half), atol=1e-5)


def test_mirror_images_have_mirrored_intervals() -> None:
    values = np.array([0.1, 0.2, 0.9, 0.4, 0.4, 0.0])
    for low, high in ((0, 1), (0, np.inf), (-np.inf, 1)):
        mean, lower, upper = interval(values, low, high)
        np.testing.assert_allclose(interval(-values, -high, -low), (-mean, -upper, -lower))


@pytest.mark.parametrize("extreme", [0.0, 1.0])
def test_at_an_end_of_the_range_the_interval_is_that_end(extreme: float) -> None:
    assert interval(np.full(6, extreme), 0, 1) == (extreme, extreme, extreme)
    assert interval([0.5], 0, 1) == (0.5, 0, 1)
    with pytest.raises(InputError, match="outside the range"):
        interval([2.0, 3.0], 0, 1)


@pytest.mark.parametrize(
    ("draw", "truth", "ends"),
    [
        (lambda rng, shape: rng.exponential(size=shape), 1.0, (0.0, np.inf)),
        (lambda rng, shape: rng.beta(0.5, 1.5, size=shape), 0.25, (0.0, 1.0)),
        (lambda rng, shape: 1 + rng.geometric(0.3, size=shape), 1 + 1 / 0.3, (1.0, np.inf)),
    ],
)
def test_thirty_seeds_cover_the_mean_nearly_as_often_as_they_say(draw, truth: float, ends: tuple[float, float]) -> None:
    """True coverages are .93 to .96; below .91 of 20,000 happens with probability below 2e-7 (Hoeffding at .93)."""
    _, lower, upper = interval(draw(np.random.default_rng(1), (30, 20_000)), *ends)
    assert np.mean((lower <= truth) & (truth <= upper)) > 0.91


def result(seeds: int) -> xr.Dataset:
    config = preset("theory", "starmdp").but(rounds=3)
    world = build_world(config)
    parts = [run_seed(config, world, seed) for seed in range(seeds)]
    return xr.concat(parts, "seed", combine_attrs="drop_conflicts").assign_attrs(title="starmdp")


def test_a_run_of_many_seeds_prints_and_draws_no_impossible_number() -> None:
    results = result(SHOWN_SEEDS)
    told = table(results)
    assert "mean over 5 seeds with its 95 % interval" in told
    rows = [line for line in told.splitlines() if line.startswith(("bridge ", "pbrl ", "bc ")) and "[" in line]
    assert len(rows) == 3
    assert not any("±" in row or "-" in row.split("]")[0] for row in rows)
    regret, sizes = figure(results).axes
    assert min(band.get_paths()[0].vertices[:, 1].min() for band in regret.collections) >= -1e-9
    heights = np.concatenate([band.get_paths()[0].vertices[:, 1] for band in sizes.collections])
    assert heights.min() >= 1
    assert heights.max() <= 1024


def test_a_run_of_few_seeds_shows_the_seeds() -> None:
    results = result(3)
    told = table(results)
    assert "mean over 3 seeds, and each seed" in told
    assert "±" not in told
    regret, _ = figure(results).axes
    assert not regret.collections
    assert len(regret.lines) == 3 * (1 + 3) + 1  # each algorithm's mean and seeds, and the expert
    assert str(mean_of([1.0, 2.0, 3.0, 6.0])) == "3.00 (1.00, 2.00, 3.00, 6.00)"
    assert str(mean_of([1.0])) == "1.00"


@pytest.mark.parametrize("seeds", [1, 3, 8])
def test_every_way_of_drawing_shows_few_seeds_and_bars_for_many(seeds: int) -> None:
    from matplotlib.figure import Figure

    values, x = np.random.default_rng(0).exponential(size=(seeds, 4)), np.arange(4.0)
    for draw in (
        lambda axes: draw_seeds(axes, x, values, STYLE, low=0.0),
        lambda axes: draw_errors(axes, x, values, STYLE, low=0.0),
        lambda axes: draw_means(axes, [mean_of(values[:, i]) for i in range(4)], x, fmt="o", **STYLE),
    ):
        axes = Figure().subplots()
        draw(axes)
        shown = {round(float(v), 12) for line in axes.lines for v in (*line.get_xdata(), *line.get_ydata())}
        assert bool(axes.collections) == (seeds >= SHOWN_SEEDS)
        assert ({round(float(v), 12) for v in values.ravel()} <= shown) == (seeds < SHOWN_SEEDS)
