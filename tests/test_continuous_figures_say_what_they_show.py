"""The continuous figures show both search spaces, their quick versions run, published curves stay in their place."""

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="continuous control needs MuJoCo, of the extra 'continuous'")
pytest.importorskip("torch", reason="cloning needs torch, of the extra 'continuous'")

from bridge_algos.continuous.config import ContinuousConfig, continuous_preset
from bridge_algos.netcdf import load_dataset
from experiments.published import agreeing_rounds, published_curves
from experiments.reproduce import configuration, in_all, names, reproduce
from experiments.studies import mujoco, mujoco_ablation, mujoco_differences

ALONE = ("ablation-reacher-demonstrations", "ablation-reacher-embeddings", "ablation-reacher-radius")
TINY = {"small": 3, "large": 3, "rollouts": 4, "rounds": 3, "epochs": 1, "horizon": 8, "n_demonstrations": 2}


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BRIDGE_RL_CACHE", str(tmp_path / "cache"))


def tiny(name: str, variations: int = 2) -> dict:
    described = configuration(name, quick=True)
    described["settings"]["configuration"] |= TINY
    if "variations" in described["settings"]:
        described["settings"]["variations"] = described["settings"]["variations"][:variations]
    return described


def test_full_settings_are_the_published_preset() -> None:
    for name, environment in (("fig2-reacher", "reacher"), ("fig2-ant", "ant")):
        settings = configuration(name)["settings"]
        assert settings["seeds"] == 20
        assert mujoco.configured(settings) == continuous_preset("published", environment)
    fewer = mujoco.configured(configuration("fig2-ant-fewer-rollouts")["settings"])
    assert fewer == continuous_preset("published", "ant").but(rollouts=20)
    for name in ALONE:
        settings = configuration(name)["settings"]
        base = mujoco.configured(settings)
        assert base.but(rounds=200) == continuous_preset("published", "reacher")
        for variation in settings["variations"]:
            assert isinstance(base.but(**variation["changes"]), ContinuousConfig)
    assert {"fig2-reacher", "fig2-ant", *ALONE} <= set(names()) - set(in_all())


def test_figure_two_shows_both_search_spaces(tmp_path: Path) -> None:
    described = tiny("fig2-reacher")
    text = reproduce("fig2-reacher", described, tmp_path, jobs=1)
    data = load_dataset(tmp_path / "data.nc", "")
    assert list(data.search.values) == ["without-expert", "with-expert"]
    assert mujoco.words(data) in text
    for sentence in ("the expert is not a candidate", "the expert is a candidate, as published", "3 rounds"):
        assert sentence in text
    pictures = mujoco.figures(data)
    assert list(pictures) == ["without-expert", "with-expert", "against-best"]  # other rounds than published
    for name in pictures:
        assert (tmp_path / f"fig2-reacher-{name}.png").stat().st_size > 10_000
    searched = data.set_size.sel(algorithm="pbrl").isel(round=0)
    assert bool((searched.sel(search="with-expert") == searched.sel(search="without-expert") + 1).all())
    before = (tmp_path / "data.nc").read_bytes()
    assert reproduce("fig2-reacher", described, tmp_path, jobs=1) == text
    assert (tmp_path / "data.nc").read_bytes() == before


def test_published_curves_are_drawn_only_beside_their_own_setting() -> None:
    curves = published_curves("reacher")
    assert curves is not None
    assert (curves["rounds"], curves["seeds"]) == (200, 20)
    settings = configuration("fig2-reacher")["settings"]
    data = synthetic(settings, curves["rounds"])
    pictures = mujoco.figures(data)
    drawn = {name: picture.axes[0].get_legend_handles_labels()[1] for name, picture in pictures.items()}
    assert [name for name, labels in drawn.items() if "BRIDGE, published" in labels] == ["published"]
    assert "looked best" in drawn["against-best"]
    text = mujoco.words(data)
    assert "published 84.44 ± 23.21, ours" in text
    assert "agreement does not show that ours repeat them" in text
    assert "after 1, 5, 10, 20, 50 rounds: published -19.4, 1.4, 9.7, 17.4, 27.2, ours 7.0, 7.0, 7.0" in text
    assert "their stored data are those of the greedy policy against a random one" in text
    assert "theirs sampled ones" in text
    # on two seeds every round's regret is -1, or -2 on the rollouts that chose, which is 0 when clipped
    assert (
        "bridge: judged on fresh initial states -200.00 (-200.00, -200.00), read as published 0.00 (0.00, 0.00)" in text
    )
    seen = data.assign(suboptimality_seen=data.suboptimality_seen + 5)
    assert (
        "bridge: judged on fresh initial states -200.00 (-200.00, -200.00), read as published 600.00 (600.00, 600.00)"
        in mujoco.words(seen)
    )
    assert "published 84.44 ± 23.21, ours 600.00 (600.00, 600.00)" in mujoco.words(seen)


def test_words_name_the_expert_and_what_differs_from_the_published_runs() -> None:
    reacher, ant = (configuration(name)["settings"] for name in ("fig2-reacher", "fig2-ant"))
    text = mujoco.words(synthetic(ant, 3))
    assert "expert: shipped, ant" in text
    assert "trained by our PPO on episodes of 100 steps, theirs by TD3" in text
    assert "theirs by its steps" in text
    assert "theirs lies inside the radius in every seed" in text
    assert "same settings" not in text
    text = mujoco.words(synthetic(reacher, 3))
    assert "expert: reacher-zoo" in text
    assert "held out 1.00" in text
    none = synthetic(reacher, 3)
    assert "held out nothing" in mujoco.words(none.assign(held_out_likelihood=np.nan * none.held_out_likelihood))
    assert "trained with the same settings" in text
    assert "from 200 rollouts, as all candidates do, theirs from 1000" in text


def test_agreement_is_counted_in_every_round() -> None:
    theirs = {"mean": [0.0, 0.0, 5.0], "ci95_half_width": [1.0, 1.0, 1.0]}
    ours = np.array([[0.9, 1.0, 4.1], [0.9, 1.2, 4.1]])  # half-widths 0, 1.27, 0
    assert agreeing_rounds(ours, theirs) == 3
    assert agreeing_rounds(ours + np.array([0.2, 0.4, 2.0]), theirs) == 1


def synthetic(settings: dict, rounds: int):  # type: ignore[no-untyped-def]
    """A data set of the study's form whose regret is -1 in every round."""
    import xarray as xr

    algorithms = ["bridge", "pbrl", "bc"]
    shape = (2, 2, 3, rounds)
    dims = ("search", "seed", "algorithm", "round")
    noise = np.random.default_rng(0).normal(size=(2, 2)) * 0.01
    variables = {
        name: (dims, np.full(shape, value))
        for name, value in (
            ("suboptimality", -1.0),
            ("suboptimality_seen", -2.0),
            ("set_size", 3.0),
            ("log_det", 7.0),
            ("cumulative_error", 0.1),
        )
    }
    scalars = "expert_return clone_return clone_gap_error likelihood held_out_likelihood radius offline_set_count"
    scalars += " expert_distance expert_in_ball feature_error observed_bound largest_coordinate"
    variables |= dict.fromkeys(scalars.split(), (("search", "seed"), 1.0 + noise))
    variables["best_candidate"] = (("search", "seed", "algorithm"), np.zeros((2, 2, 3)))
    variables["best_of_all"] = (("search", "seed"), np.zeros((2, 2)))
    coordinates = {"search": list(mujoco.SEARCHES), "seed": [0, 1], "algorithm": algorithms}
    attributes = {"settings": json.dumps(settings), "caveats": "[]"}
    return xr.Dataset(variables, coordinates | {"round": np.arange(1, rounds + 1)}, attributes)


@pytest.mark.parametrize("name", ["ablation-reacher-radius", "ablation-reacher-demonstrations"])
def test_ablations_run_and_leave_out_what_was_not_run(name: str, tmp_path: Path) -> None:
    described = tiny(name)
    text = reproduce(name, described, tmp_path, jobs=1)
    data = load_dataset(tmp_path / "data.nc", "")
    labels = [variation["label"] for variation in described["settings"]["variations"]]
    assert list(data.variation.values) == labels
    assert "nan" not in text
    last = [line for line in text.splitlines() if f"{described['settings']['varied']} {labels[-1]}:" in line]
    assert len(last) == 2
    assert all(("pbrl" in line) == (name != "ablation-reacher-radius") for line in last)
    assert list(mujoco_ablation.figures(data)) == ["without-expert", "with-expert"]
    assert "of 13 candidates" in last[0] or "of 7 candidates" in last[0]
    assert "they compare the greedy policy with a random one" in text


def test_what_the_authors_vary_besides_is_said_of_every_ablation() -> None:
    varied = {name: configuration(name)["settings"]["varied"] for name in ALONE}
    assert set(varied.values()) == set(mujoco_ablation.DEPARTURES)


def test_the_differences_lead_to_the_published_preset(tmp_path: Path) -> None:
    settings = configuration("published-differences-reacher")["settings"]
    config = mujoco.configured(settings)
    for step in settings["steps"]:
        assert config.but(**step["changes"]) != config or not step["changes"]
        config = config.but(**step["changes"])
    published = continuous_preset("published", "reacher")
    assert config == published.but(algorithms=config.algorithms)
    described = tiny("published-differences-reacher")
    described["settings"]["steps"] = [settings["steps"][0], settings["steps"][-1]]
    text = reproduce("published-differences-reacher", described, tmp_path, jobs=1)
    data = load_dataset(tmp_path / "data.nc", "")
    assert "published curves, which have other rounds" in text
    data["suboptimality"][:], data["suboptimality_seen"][:] = 1.0, -2.0
    for reading, regret in (("fresh", 1.0), ("seen", -2.0), ("published", 0.0)):
        total = mujoco_differences.total(data, "our best expert", "pbrl", reading)
        assert total.mean == pytest.approx(regret * data.sizes["round"])
    first, last = data.step.values
    data["suboptimality"].loc[{"step": last}] = 2.0
    data["suboptimality"].loc[{"step": last, "seed": 1}] = 4.0
    effect = mujoco_differences.effect(data, last, first, "pbrl", "fresh")
    assert effect.mean == pytest.approx(2 * data.sizes["round"])
    told = mujoco_differences.words(data)
    assert f"not decided by these seeds, paired difference {effect}, on fresh initial states" in told
    data["suboptimality"].loc[{"step": last}] = 2.0
    assert "no, paired difference 3.00 (3.00, 3.00), on fresh initial states" in mujoco_differences.words(data)


def test_a_damaged_result_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from experiments.cli import main as command

    directory = tmp_path / "fig2-reacher-quick" / "without-expert"
    directory.mkdir(parents=True)
    (directory / "configuration.json").write_text("{}")
    (directory / "seed-00000.nc").write_text("nothing")
    assert command(["reproduce", "fig2-reacher", "--quick", "--out", str(tmp_path)]) == 2
    assert "names no environment" in capsys.readouterr().err
