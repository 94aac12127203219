"""What the repository stores of the long continuous runs was made with its configurations, and says what it said."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from bridge_algos.netcdf import load_dataset
from bridge_algos.run.summary import difference, final
from experiments.asked import asked, count_text, interval_text
from experiments.reproduce import configuration, told
from experiments.studies import mujoco, mujoco_differences

ROOT = Path(__file__).parent.parent
STORED = sorted((ROOT / "experiments" / "data").glob("*.nc"))


def stored(name: str) -> xr.Dataset:
    return load_dataset(ROOT / "experiments" / "data" / f"{name}.nc", "")


def test_there_are_results_of_each_kind() -> None:
    varied = {f"ablation-reacher-{name}" for name in ("radius", "demonstrations", "embeddings")}
    assert {path.stem for path in STORED} >= {"fig2-reacher", "fig2-ant", "fig2-ant-fewer-rollouts", *varied}


@pytest.mark.parametrize("path", STORED, ids=lambda path: path.stem)
def test_stored_results(path: Path) -> None:
    data, described = load_dataset(path, ""), configuration(path.stem)
    settings = json.loads(data.attrs["settings"])
    assert settings["seeds"] == data.sizes["seed"]
    assert settings | {"seeds": 0} == described["settings"] | {"seeds": 0}
    assert data.attrs["title"] == described["title"]
    assert path.stat().st_size < 1_000_000
    assert path.with_suffix(".txt").read_text() == told(data), "store the text that reproduce writes beside the data"
    assert f"{data.sizes['seed']} seeds" in told(data)
    if path.stem.startswith("fig2"):
        regret = data.suboptimality.sel(algorithm="bridge")
        seen = data.suboptimality_seen.sel(algorithm="bridge")
        assert float((regret - seen).mean()) > 0, "the rollouts that chose a policy flatter it"
    if "suboptimality" in data:
        assert bool(np.isfinite(data.suboptimality.sel(algorithm="bridge")).all())


def test_studies_that_share_settings_share_numbers() -> None:
    """Whatever a study varies, its runs with the settings of figure 2 are those of figure 2, bit by bit."""
    whole = stored("fig2-reacher")
    part = whole.sel(algorithm=["bridge", "pbrl"])
    radius, demonstrations = stored("ablation-reacher-radius"), stored("ablation-reacher-demonstrations")
    embeddings, differences = stored("ablation-reacher-embeddings"), stored("published-differences-reacher")
    pairs = {
        "radius": (radius.sel(variation="0.65", algorithm="bridge"), whole.sel(algorithm="bridge")),
        "radius, PbRL": (radius.sel(variation="0.3", algorithm=["pbrl", "bc"]), whole.sel(algorithm=["pbrl", "bc"])),
        "demonstrations": (demonstrations.sel(variation="20"), whole),
        "embedding": (embeddings.sel(variation="average_state_action", algorithm=["bridge", "pbrl"]), part),
        "differences": (differences.isel(step=-1), part.sel(search="with-expert")),
    }
    for name, (own, same) in pairs.items():
        for variable in ("suboptimality", "suboptimality_seen", "set_size"):
            found = own[variable]
            expected = same[variable].sel({dim: found[dim] for dim in found.dims})
            np.testing.assert_array_equal(found.transpose(*expected.dims), expected, err_msg=f"{name}: {variable}")


def test_the_readme_tells_the_stored_numbers() -> None:
    text = " ".join((ROOT / "README.md").read_text().split())
    reacher, ant, fewer = (stored(name) for name in ("fig2-reacher", "fig2-ant", "fig2-ant-fewer-rollouts"))
    honest, included = (reacher.sel(search=name) for name in ("without-expert", "with-expert"))
    steps = stored("published-differences-reacher")
    last, first = (str(steps.step.values[index]) for index in (-1, 0))
    for number in (
        final(mujoco.as_published(reacher), "suboptimality", "bridge"),
        *(final(included, "suboptimality", name) for name in ("bridge", "pbrl", "bc")),
        final(honest, "suboptimality", "bridge"),
        mujoco_differences.effect(steps, first, last, "bridge", "published"),
        *(final(ant.sel(search="without-expert"), "suboptimality", name) for name in ("bridge", "pbrl", "bc")),
        *(final(ant.sel(search="with-expert"), "suboptimality", name) for name in ("bridge", "pbrl")),
        difference(ant.sel(search="with-expert"), "suboptimality", "bridge", "pbrl"),
        difference(fewer.sel(search="with-expert"), "suboptimality", "bridge", "pbrl"),
    ):
        assert f"{number.mean:.0f} ± {number.half_width:.0f}" in text
    below_clone = difference(ant.sel(search="with-expert"), "suboptimality", "bc", "bridge")
    assert f"below the clone by {below_clone.mean:.0f} ± {below_clone.half_width:.0f}" in text
    assert f"({float(fewer.feature_error.mean()):.2f})" in text
    included, inside = ant.sel(search="with-expert"), ant.expert_in_ball.sel(search="with-expert") == 1
    assert f"outside in {int((~inside).sum())} of {ant.sizes['seed']} seeds" in text
    lost, later = included.suboptimality != 0, included["round"] > 2
    assert int(lost.sel(algorithm="pbrl").sum()) == 1, "a single round of a single seed is lost"
    assert not bool(lost.sel(algorithm="pbrl")[:, later].any()), "from the first answers on PbRL plays the expert"
    plays_it = ~lost.sel(algorithm="bridge")[:, later].any("round")
    assert bool((plays_it == inside).all()), "BRIDGE does where it can"
    words = mujoco.words(reacher)
    assert re.findall(r"agreement in (\d+) of 200 rounds", words) == ["37", "179", "200", "186"]


def test_the_readme_tells_how_many_questions_certify() -> None:
    text = " ".join((ROOT / "README.md").read_text().split())
    data = stored("certified-answers")
    most = json.loads(data.attrs["settings"])["max_questions"]
    questions = dict(zip(zip(data.n.values, data.asking.values, strict=True), data.questions.values, strict=True))

    def told(n: int, asking: str = "pool") -> str:
        return count_text(asked(questions[n, asking]).median, most)

    one, two = (asked(questions[n, "pool"]) for n in (1, 2))
    after_one = data.isel(given=np.flatnonzero(data.limit_n.values == 1)[0])
    least, old = after_one.yardstick.values, after_one.old.values
    assert min(least) >= 5, "worth dividing by"
    ratio = np.quantile(questions[1, "pool"][: len(least)] / least, 0.5, method="higher")
    for words in (
        f"StarMDP, range 5 nats, delta 0.05, {data.sizes['seed']} seeds",
        f"Without demonstrations {told(0)} questions are needed in the median, after one {told(1)} "
        f"({interval_text(one, most)}) and after two {told(2)} ({interval_text(two, most)})",
        f"by mutual information {told(1, 'information')}, at random {told(1, 'random')}, by the paper's rule "
        f"{told(1, 'paper')}",
        f"about 10^{np.log10(np.median(old)):.0f} answers",
        f"about {np.median(least):.0f}, and ours are {ratio:.1f} times as many",
    ):
        assert words in text
