"""The studies of demonstrations and of sensitivity: deterministic, recomputable by hand, and outspoken in words."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.stats import binom

from bridge_algos.hellinger import disagreement_probability, squared_hellinger
from bridge_algos.run.config import preset
from bridge_algos.run.offline import offline_stage
from bridge_algos.run.seed import run_seed
from bridge_algos.run.world import build_world
from bridge_theory.errors import InputError
from experiments import reproduce
from experiments.intervals import clopper_pearson
from experiments.seeds import all_seeds, changed, entries, preset_text
from experiments.studies import demonstrations, needed_radius, sensitivity

STAR = {"environment": "starmdp", "preset": "published"}
DEMONSTRATIONS: dict[str, Any] = {
    **STAR,
    "seeds": 3,
    "rounds": 4,
    "n": [1, 4],
    "shown_rounds": [1, 4],
    "target_regret": 20,
    "measure": "greedy_regret",
}
SENSITIVITY: dict[str, Any] = {
    **STAR,
    "changes": {"rounds": 4},
    "seeds": 3,
    "factors": {"radius": [0, 0.9, 1], "noise": [0.4], "oracle_options.mistakes": [0.4]},
}
NEEDED: dict[str, Any] = {"environments": [STAR], "n": [2], "noise": [0, 0.4], "told_noise": [0], "seeds": 20}


@pytest.mark.parametrize(
    ("study", "settings"), [(demonstrations, DEMONSTRATIONS), (sensitivity, SENSITIVITY), (needed_radius, NEEDED)]
)
def test_numbers_do_not_depend_on_jobs(study, settings, tmp_path: Path) -> None:
    one, two = (study.compute(settings, tmp_path / str(jobs), jobs) for jobs in (1, 2))
    assert one.identical(two)
    assert one.identical(study.compute(settings, tmp_path / "1", 1))


@pytest.mark.parametrize("name", ["demonstrations-starmdp", "sensitivity-starmdp", "needed-radius"])
def test_quick_versions_write_figures_and_name_every_algorithm(name: str, tmp_path: Path) -> None:
    described = reproduce.configuration(name, quick=True)
    text = reproduce.reproduce(name, described, tmp_path, 1)
    named = ("expert", "starmdp", "garnet") if name == "needed-radius" else ("BRIDGE", "PbRL", "BC")
    assert all(word in text for word in named)
    assert "nan" not in text
    assert list(tmp_path.glob("*.png"))


def test_every_configuration_of_the_studies_is_a_valid_run() -> None:
    for name in reproduce.names():
        for quick in (False, True):
            described = reproduce.configuration(name, quick)
            if described["study"] == "sensitivity":
                config = sensitivity.configured(described["settings"])
                for factor, values in described["settings"]["factors"].items():
                    assert factor in sensitivity.FACTORS
                    for value in values:
                        assert changed(config, factor, value) != config


def test_what_a_study_changes_in_its_preset_is_said(tmp_path: Path) -> None:
    """The published preset has ten Adam steps, under which the optimal policy is ruled out far less often."""
    for name in reproduce.names():
        described = reproduce.configuration(name)
        if described["study"] in ("sensitivity", "demonstrations"):
            settings = described["settings"]
            at_optimum = settings["changes"].get("fit") == "exact"
            assert ("fit = exact" in preset_text(settings)) == at_optimum
            assert ("weights at their optimum" in described["title"]) == at_optimum
    alone = SENSITIVITY | {"factors": {"radius": [1]}}
    as_published, exact = (
        sensitivity.words(sensitivity.compute(settings, tmp_path, 1))
        for settings in (alone, alone | {"changes": {"rounds": 4, "fit": "exact"}})
    )
    assert "starmdp, published preset, 4 rounds" in as_published
    assert "fitted as in the preset" not in as_published
    assert "starmdp, published preset but for fit = exact, 4 rounds" in exact
    fate = as_published.splitlines()[1].partition("ruled out")[2]
    assert f"with the weights fitted as in the preset (adam): ruled out{fate}\n" in exact


def test_a_cells_frequencies_and_regrets_are_those_of_its_runs(tmp_path: Path) -> None:
    data = sensitivity.compute(SENSITIVITY, tmp_path, 1)
    config = preset("published", "starmdp").but(rounds=4, noise=0.4)
    runs = [run_seed(config, build_world(config), seed) for seed in range(3)]
    noisy = data.isel(cell=int(np.flatnonzero(data.factor == "noise")[0]))
    for i, run in enumerate(runs):
        assert bool(noisy.out_of_offline_set[i]) == (float(run.optimum_in_offline_set) == 0)
        bridge = run.sel(algorithm="bridge")
        assert bool(noisy.ruled_out.sel(algorithm="bridge")[i]) == bool((bridge.optimum_ruled_out == 1).any())
        assert float(noisy.regret.sel(algorithm="bridge")[i]) == pytest.approx(float(bridge.suboptimality.sum()))
    radii = sensitivity.series(data, "radius")
    assert radii.value.values.tolist() == [0, 0.9, 1]
    assert radii.factor.values.tolist() == ["radius", "preset", "radius"]


def test_regret_after_fewer_rounds_is_that_of_a_shorter_run(tmp_path: Path) -> None:
    data = demonstrations.compute(DEMONSTRATIONS, tmp_path, 1)
    short = preset("published", "starmdp").but(rounds=2, n_demonstrations=4)
    for seed, run in enumerate(all_seeds(entries(short), 3)):
        own = data.sel(n=4, round=2).isel(seed=seed)
        np.testing.assert_allclose(own.greedy_regret, run.suboptimality.sum("round"))
        np.testing.assert_allclose(own.pair_regret, run.pseudo_regret.sum("round"))


def test_the_iso_regret_line_is_the_smallest_n_from_which_on_the_target_holds() -> None:
    means = np.array([[5.0, 9.0], [1.0, 3.0], [2.0, 9.0], [0.0, 1.0]])
    regret = np.stack([means - 1, means + 1])[:, :, None]
    data = xr.Dataset(
        {"pair_regret": (("seed", "n", "algorithm", "round"), regret), "lowest_pair_regret": -1.0},
        {"n": [1, 2, 4, 8], "algorithm": ["bridge"], "round": [1, 2]},
    )
    low, needed, high = demonstrations.iso_regret(data, "bridge", 3.0)
    assert needed.tolist() == [2, 8]
    assert (low <= needed).all()
    assert np.isnan(high).all()


def test_what_demonstrations_are_to_pbrl_is_read_off_its_regret() -> None:
    """On StarMDP it searches all policies; on Gridworld half of its candidates may come from the offline set."""
    regret = np.arange(4.0).reshape(1, 2, 1, 2)
    data = xr.Dataset(
        {"pair_regret": (("seed", "n", "algorithm", "round"), regret)},
        {"n": [1, 2], "algorithm": ["pbrl"], "round": [1, 2]},
    )
    assert "borrows policies from the offline set" in demonstrations._pbrl(data)
    assert demonstrations._pbrl(data.isel(n=[0, 0])) == ". PbRL uses no demonstrations"
    assert demonstrations._pbrl(data.assign_coords(algorithm=["bc"])) == ""


def test_needed_radii_enclose_the_distance_and_are_certified_without_noise(tmp_path: Path) -> None:
    data = needed_radius.compute(NEEDED, tmp_path, 1)
    assert bool((data.needed_lucky <= data.needed + 1e-12).all())
    assert bool((data.needed <= data.needed_unlucky + 1e-12).all())
    for cell in range(data.sizes["cell"]):
        config = preset("published", "starmdp").but(noise=float(data.noise[cell]))
        world = build_world(config)
        for seed in range(5):
            stage = offline_stage(config, world, seed)
            squared = squared_hellinger(stage.estimate, world.expert.policy, stage.estimate, stage.clone)
            assert float(data.needed[cell, seed]) == pytest.approx(np.sqrt(max(squared, 0)), abs=1e-7)
            if data.noise[cell] == 0:
                unvisited = (stage.pairs.sum(axis=1) == 0).astype(np.float64)[None]
                certificate = np.sqrt(disagreement_probability(stage.estimate, stage.clone, unvisited)[0])
                assert float(data.needed_unlucky[cell, seed]) == pytest.approx(certificate, abs=1e-7)
                assert data.needed_lucky[cell, seed] == 0


def test_clopper_pearson_has_its_coverage() -> None:
    trials = 20
    low, high = clopper_pearson(np.arange(trials + 1), trials)
    for chance in np.linspace(0.01, 0.99, 99):
        covered = binom.pmf(np.arange(trials + 1), trials, chance)[(low <= chance) & (chance <= high)].sum()
        assert covered >= 0.95 - 1e-12


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"factors": {"radios": [1]}}, "'radios', which is no entry of a run"),
        ({"factors": {"noise": [2]}}, "noise is 2, expected a probability"),
        ({"changes": {"oracle": "nobody"}}, "oracle is 'nobody'"),
        ({"factors": {"oracle_options.kindness": [1]}}, "kindness"),
    ],
)
def test_a_mistake_in_a_configuration_is_one_sentence(change, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message) as caught:
        sensitivity.compute(SENSITIVITY | change, tmp_path, 1)
    assert "\n" not in str(caught.value)
    assert json.dumps(str(caught.value)).count(". ") <= 1
