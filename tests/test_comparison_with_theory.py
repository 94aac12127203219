"""``bridge-rl compare``: the numbers are those of bridge_theory, and a bound is called violated only where it is."""

import dataclasses
import itertools
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import bridge_theory as theory
from bridge_algos.continuous.config import continuous_preset
from bridge_algos.envs.counterexamples import instance
from bridge_algos.envs.registry import make_mdp
from bridge_algos.netcdf import load_dataset, save_dataset
from bridge_algos.run.candidates import WAYS
from bridge_algos.run.config import preset
from bridge_algos.run.log_file import load_log, log_files, save_log
from bridge_algos.run.runner import run
from bridge_algos.run.store import load_run
from bridge_algos.run.world import build_world, caveats
from bridge_theory.errors import InputError
from experiments.cli import main
from experiments.compare import compare, figure, table, words
from experiments.compare import comparison as comparing
from experiments.compare.applicability import missing_of_repaired
from experiments.report.certificate import certificates_html
from proofs_checks.counterexample import load, on_environment
from proofs_checks.verify import verify

COUNTEREXAMPLE = "counterexample-known-model"
ROUNDS = 1500
STAR = {"algorithms": ("bridge-known", "bridge"), "rounds": 12, "lam": 2.0}


@pytest.fixture(scope="module")
def violated(tmp_path_factory):
    directory = tmp_path_factory.mktemp("violated")
    run(preset("counterexample", COUNTEREXAMPLE).but(rounds=ROUNDS), directory, 1)
    return directory


@pytest.fixture(scope="module")
def star(tmp_path_factory):
    directory = tmp_path_factory.mktemp("star")
    run(preset("theory", "starmdp").but(**STAR), directory, 4)
    return directory


@pytest.fixture(scope="module")
def compared(star):
    return compare(star)


@pytest.fixture(scope="module")
def logged(tmp_path_factory):
    directory = tmp_path_factory.mktemp("logged")
    run(preset("theory", "starmdp").but(**STAR), directory, 2, log=True)
    return directory


def number(text):
    numerator, _, denominator = text.partition("/")
    return int(numerator) / int(denominator or 1)


def rows_of(comparison):
    return {row.curve.kind: row for row in comparison.rows}


def test_the_counterexample_is_shown_as_violated(violated):
    (found,) = compare(violated)
    row = rows_of(found)["stated"]
    assert row.verdict == "violated"
    assert (row.curve.source, row.ledger) == ("thm:main_known", "thm:main_known")
    assert found.empirical.replay is not None
    assert found.empirical.mean[-1] == pytest.approx(ROUNDS / 2, rel=1e-12)
    assert found.empirical.lower is None  # deterministic: no band
    assert row.violated_from is not None
    before = found.rounds < row.violated_from
    assert (found.empirical.mean[~before] > row.curve.mean[~before]).all()
    assert not (found.empirical.mean[before] > row.curve.mean[before])[-1]
    text = words(found)
    assert "'stated theorem' (thm:main_known) is violated" in text
    assert "bridge-rl check --only thm:main_known" in text
    assert "VIOLATED" in table(found)


def test_after_ten_thousand_rounds_the_regret_is_above_the_bound_by_a_factor_above_ten():
    """The loop's regret is B W a round (first test); the bound at T = 10^4 needs no run."""
    numbers = {name: value for name, value in instance(COUNTEREXAMPLE).items() if name != "lambda"}
    bound = theory.regret_known_stated.enclosure(**numbers, lam=instance(COUNTEREXAMPLE)["lambda"], d=1, S=1, A=2)
    assert 5000 / bound.upper > 11.7


def test_the_instance_is_that_of_the_ledger():
    names = {example.name for example in on_environment(COUNTEREXAMPLE)}
    assert {"online-linear-regret", "online-feature-sum"} <= names
    data, config, mdp = (
        load("online-linear-regret").data,
        preset("counterexample", COUNTEREXAMPLE),
        make_mdp(COUNTEREXAMPLE),
    )
    world = build_world(config)
    assert world.embedding.bound == number(data["B"]) == mdp.expected_reward.max()
    assert np.linalg.norm(world.w_star) == number(data["W"])
    assert (config.n_demonstrations, config.rounds) == (int(data["n"]), int(data["T"]))
    assert (config.lam, config.delta) == (number(data["lambda"]), number(data["delta"]))


def test_with_one_more_demonstration_nothing_is_violated(tmp_path):
    """The control of the ledger's entry: 23 demonstrations leave one policy, and there is no regret."""
    run(preset("counterexample", COUNTEREXAMPLE).but(rounds=20, n_demonstrations=23), tmp_path, 1)
    (found,) = compare(tmp_path)
    assert found.empirical.replay is None
    assert found.empirical.mean[-1] == 0
    assert all(row.verdict != "violated" for row in found.rows)


def test_the_theory_preset_violates_nothing(compared):
    known, unknown = compared
    assert (known.algorithm, unknown.algorithm) == ("bridge-known", "bridge")
    for found in (known, unknown):
        assert {row.verdict for row in found.rows} <= {"informative", "vacuous", "rate"}
        assert "is violated:" not in words(found)
        for row in found.rows:
            assert (row.curve.values >= found.empirical.regret - 1e-9).all() or row.curve.kind == "rate"
    assert rows_of(known)["stated"].curve.missing  # it is about other confidence sets
    assert not rows_of(known)["a-priori"].curve.missing


def test_every_number_is_a_direct_evaluation(star, compared):
    results, world = load_run(star), build_world(preset("theory", "starmdp").but(**STAR))
    T = STAR["rounds"]
    model = {"B": 8, "W": "1/8", "lam": 2, "d": 20, "T": T}
    events = {f"delta_{event}": "1/20" for event in ("off", "w", "F")}
    known, unknown = (rows_of(found) for found in compared)
    assert known["trivial"].value == theory.regret_trivial.enclosure(B=8, W="1/8", T=T).upper
    assert (
        known["a-priori"].value == theory.regret_known_version_space.enclosure(**model, **events, S=5, n=2, K=1).upper
    )
    assert known["a-priori"].curve.failure == pytest.approx(0.15)
    stated = theory.regret_known_stated.enclosure(**model, S=5, A=4, n=2, delta="1/20")
    assert known["stated"].value == stated.upper
    more = {f"delta_{event}": "1/20" for event in ("P", "M")}
    wide = theory.regret_unknown_version_space.enclosure(**model, **events, **more, S=5, A=4, H=8, n=2, K=1)
    assert unknown["a-priori"].value == wide.upper
    own = results.sel(algorithm="bridge-known")
    widths = np.asarray((own.gamma * own.uncertainty).transpose("seed", "round").cumsum("round"))[:, -1]
    played = [theory.regret_width.enclosure(width_sum=float(width), bonus_sum=0).upper for width in widths]
    assert known["played"].value == pytest.approx(float(np.mean(played)), rel=1e-12)
    regret = np.asarray(own.pseudo_regret.sum("round")) * world.utility_scale
    found = compared[0].empirical
    assert found.regret[:, -1] == pytest.approx(regret, rel=1e-12, abs=1e-12)
    assert found.lower[-1] <= regret.mean() <= found.upper[-1]


def test_the_certified_curve_is_that_of_the_checker(logged):
    for found in compare(logged):
        row = rows_of(found)["certified"]
        for path in log_files(logged):
            (certificate,) = (item for item in verify(load_log(path)) if item.algorithm == found.algorithm)
            assert (row.curve.values[certificate.seed] == certificate.bounds["best"][found.rounds - 1]).all()
            assert row.curve.failure == certificate.failure
        assert (row.curve.values >= found.empirical.regret).all()
        assert "played" not in rows_of(found)  # contained in the certified minimum


GARNET = {"environment_options": {"n_states": 3, "n_actions": 2, "branching": 2, "seed": 184, "horizon": 3}}


@pytest.mark.parametrize(
    ("environment", "settings", "seeds"),
    [
        ("starmdp", {"noise": 0.95}, 4),
        ("garnet", GARNET | {"n_demonstrations": 2, "expert": "finite-horizon-lp"}, 4),
        ("starmdp", {"expert": "finite-horizon-lp"}, 0),
        ("starmdp", {"radius": "stated"}, 0),
        ("starmdp", {"radius": 1.0, "noise": 0.95}, 0),
    ],
)
def test_a_certificate_is_about_the_policies_searched(tmp_path, environment, settings, seeds):
    """Where the best policy is not searched, as the results show, a regret above the bound refutes nothing."""
    run(preset("theory", environment).but(algorithms=("bridge-known",), rounds=6, **settings), tmp_path, 4, log=True)
    (found,) = compare(tmp_path)
    row = rows_of(found)["certified"]
    lacking = [reason for reason in row.curve.missing if "the best policy is not among those searched" in reason]
    assert row.curve.missing == tuple(lacking)
    assert bool(lacking) == (seeds > 0)
    assert row.curve.failure == pytest.approx(0.05)  # that of its own events, and of no other
    assert seeds == 0 or row.exceeded > 0
    assert row.verdict in ("informative", "vacuous", "below, not about this run")
    assert "is violated" not in words(found)


@pytest.mark.parametrize("way", WAYS)
def test_a_search_that_may_be_a_sample_is_called_one(star, way):
    known, unknown = comparing.subjects(star)
    for subject in (known, unknown):
        results = subject.results.assign(search_way=("seed", [way] * subject.results.sizes["seed"]))
        changed = dataclasses.replace(subject, results=results)
        said = any("only a sample" in reason for reason in missing_of_repaired(changed))
        assert said == (way not in ("all", "set"))


def test_a_tampered_log_gives_no_certified_curve(logged, tmp_path):
    shutil.copytree(logged, tmp_path / "copy")
    victim = log_files(tmp_path / "copy")[1]
    log = load_log(victim)
    arrays = {**log.arrays, "bridge/outcomes": 1 - log.arrays["bridge/outcomes"]}
    save_log(victim, dataclasses.replace(log, arrays=arrays))
    known, unknown = compare(tmp_path / "copy")
    assert "certified" in rows_of(known)
    assert "certified" not in rows_of(unknown)
    assert any("seed 1 is not certified" in item.reason for item in unknown.left_out)
    own = load_log(log_files(logged)[0])
    header = {**own.header, "seed": 1}  # the log of seed 0 in the place of the other
    save_log(victim, dataclasses.replace(own, header=header))
    assert verify(load_log(victim))[0].certified
    for found in compare(tmp_path / "copy"):
        assert any("not the log of the stored run of seed 1" in item.reason for item in found.left_out)
    save_log(victim, own)
    assert all(any("is the log of seed 0" in x.reason for x in c.left_out) for c in compare(tmp_path / "copy"))
    victim.unlink()
    assert all(any("1 of 2 seeds have no log" in x.reason for x in c.left_out) for c in compare(tmp_path / "copy"))


def test_the_lemma_has_the_sums_that_were_played(violated):
    (found,) = compare(violated)
    norms = np.asarray(load_run(violated).uncertainty).sum()
    lemma = theory.regret_known_from_sum.enclosure(B="1/2", W=1, lam=1, d=1, T=ROUNDS, delta="1/20", norm_sum=norms)
    assert rows_of(found)["stated-sums"].value == pytest.approx(lemma.upper, rel=1e-12)


def test_the_rate_touches_the_regret_and_is_no_bound(compared):
    for found in compared:
        rate, mean = rows_of(found)["rate"], found.empirical.mean
        ratio = rate.curve.mean / mean
        assert np.nanmin(ratio) == pytest.approx(1, rel=1e-9)
        assert rate.curve.failure is None
        assert rate.verdict == "rate"
        assert "not a bound" in rate.curve.label


def with_values(curve, value):
    return dataclasses.replace(curve, values=np.full_like(curve.values, value), missing=())


@pytest.mark.parametrize(("seeds", "verdict"), [(1, "below, not certified"), (4, "violated")])
def test_few_random_runs_above_a_bound_do_not_refute_it(star, compared, seeds, verdict):
    """A bound at level 0.85 that every run exceeds: one run may be the unlucky one, four are not."""
    subject = comparing.subjects(star)[0]
    subject = dataclasses.replace(subject, results=subject.results.isel(seed=slice(seeds)))
    assert (comparing._empirical(subject).lower is None) == (seeds == 1)
    curve = next(row.curve for row in compared[0].rows if row.curve.kind == "a-priori")
    row = comparing._row(subject_curve := with_values(curve, -1.0), comparing._empirical(subject), 24.0)
    assert subject_curve.failure == pytest.approx(0.15)
    assert row.verdict == verdict
    assert row.exceeded == seeds


def test_a_statement_about_another_algorithm_is_not_refuted(compared):
    found = compared[0]
    curve = dataclasses.replace(with_values(found.rows[0].curve, -1.0), missing=("it is about another algorithm",))
    assert comparing._row(curve, found.empirical, 24.0).verdict == "below, not about this run"


def curve_and_regret(exceeding, failure, value=1.0):
    """A bound that some of the seeds exceed."""
    curve = comparing.Curve("a-priori", "a bound", "audit R5", "", np.array([[value]]), failure)
    return curve, comparing.Empirical(2.0 * value * np.asarray(exceeding, dtype=float)[:, None], None, None, None)


@pytest.mark.parametrize("failure", [0.1, 0.3, 0.6])
def test_violated_is_said_no_more_often_than_the_failure_and_its_error_allow(failure):
    """Exact, over all outcomes of 9 seeds: of a true statement it is said with probability at most 5 %."""
    chance, said = 0.0, 0
    for outcomes in itertools.product((0, 1), repeat=9):
        verdict = comparing._row(*curve_and_regret(outcomes, failure), 24.0).verdict
        assert verdict in ("violated", "below, not certified") if any(outcomes) else verdict == "informative"
        if verdict == "violated":
            said += 1
            chance += failure ** sum(outcomes) * (1 - failure) ** (9 - sum(outcomes))
    assert chance <= comparing.ALPHA
    assert said > 0 or failure > 0.5


def test_violated_needs_more_seeds_above_than_the_failure_explains():
    for exceeding, verdict in ((4, "below, not certified"), (8, "below, not certified"), (30, "violated")):
        outcomes = np.random.default_rng(0).permutation([1] * exceeding + [0] * (40 - exceeding))
        assert comparing._row(*curve_and_regret(outcomes, 0.15), 24.0).verdict == verdict
    assert comparing._row(*curve_and_regret([0, 1, 0], 0.0), 24.0).verdict == "violated"  # what cannot fail, failed


def test_rounding_is_no_violation():
    """A regret above a bound of zero by rounding alone is not below it, and no empty reason is printed."""
    curve, _ = curve_and_regret([0], 0.05)
    empirical = comparing.Empirical(np.array([[1e-15]]), None, None, None)
    row = comparing._row(dataclasses.replace(curve, values=np.array([[2e-280]])), empirical, 24.0)
    assert row.verdict == "informative"
    long = comparing.Empirical(np.array([[1e6 + 1e-4]]), None, None, None)
    assert comparing._row(dataclasses.replace(curve, values=np.array([[1e6]])), long, 1e9).verdict == "informative"
    long = comparing.Empirical(np.array([[1e6 + 1e-2]]), None, None, None)
    assert comparing._row(dataclasses.replace(curve, values=np.array([[1e6]])), long, 1e9).exceeded == 1


def test_a_bound_that_may_fail_surely_says_nothing(compared):
    assert comparing._row(*curve_and_regret([0, 0], 1.0), 24.0).verdict == "vacuous"
    assert comparing._row(*curve_and_regret([0, 0], 0.99), 24.0).verdict == "informative"


def with_rows(comparison, *rows):
    return dataclasses.replace(comparison, rows=rows)


def test_only_what_is_proved_is_called_the_best_bound(compared):
    found = compared[0]
    curve, empirical = curve_and_regret([0, 0], 0.05, value=0.5)
    for kind, source, suffix in (
        ("stated", "thm:main_known", "informative, false in general"),
        ("stated-sums", "audit C.16", "informative, not proved"),
        ("stated-sums", "local:regret_known_dynamics", "informative"),
        ("a-priori", "audit R5", "informative"),
    ):
        row = comparing._row(dataclasses.replace(curve, kind=kind, source=source), empirical, 24.0)
        shown = with_rows(found, row)
        (line,) = [line for line in table(shown).splitlines() if line.startswith("a bound")]
        assert re.split(r" {2,}", line)[-2:] == [suffix, source]
        assert ("The best proved bound that is about this run is 'a bound'" in words(shown)) == (
            suffix == "informative"
        )


def test_what_is_printed_is_rounded_in_the_direction_of_the_statement(compared):
    found = compared[0]
    outcomes = [1] * 40
    for value, failure, shown in (
        (1.00001, 0.00004, ("1.001", ">= 0.9999")),
        (1234.2, 0.05, ("1,235", ">= 0.95")),
        (12345678.0, 0.1, ("1.235e+07", ">= 0.9 ")),
        (0.25, 1e-9, ("0.25 ", ">= 0.9999")),
        (2.0, 0.05 + 0.05 + 0.05, ("2 ", ">= 0.85 ")),
    ):
        row = comparing._row(*curve_and_regret(outcomes, failure, value), 1e9)
        (line,) = [line for line in table(with_rows(found, row)).splitlines() if line.startswith("a bound")]
        assert all(text in line for text in shown), line
    chance = row.chance
    text = re.search(r"at least a share ([\d.]+) of all runs with 95 % confidence, where ([\d.e-]+) is", words(
        with_rows(found, row)
    ))  # fmt: skip
    assert text is not None
    assert float(text[1]) <= chance < float(text[1]) + 1e-3
    assert float(text[2]) == 0.15


def test_the_published_preset_gets_only_what_is_about_it(tmp_path):
    config = preset("published", "starmdp").but(embedding="state_action_counts", algorithms=("bridge",), rounds=3)
    run(config, tmp_path, 2)
    (found,) = compare(tmp_path)
    assert not rows_of(found)["trivial"].curve.missing
    missing = " ".join(rows_of(found)["a-priori"].curve.missing)
    for reason in ("the fixed ones", "the teacher breaks", "slope", "hand-set radius", "not at their optimum"):
        assert reason in missing


def test_the_log_of_another_run_certifies_nothing(logged, tmp_path):
    other = preset("theory", "starmdp").but(**STAR).but(lam=3.0)
    run(other, tmp_path, 2)
    for path in log_files(logged):
        shutil.copy(path, tmp_path)
    found = compare(tmp_path)[0]
    assert "certified" not in rows_of(found)
    assert any("is the log of another configuration" in item.reason for item in found.left_out)
    assert "is the log of another configuration" in certificates_html(tmp_path, other, load_run(tmp_path), 1)


def test_a_radius_without_a_theorem_is_named(tmp_path):
    hand_set = preset("theory", "starmdp").but(radius=0.5)
    assert any("hand-set radius" in reason for reason in caveats(hand_set, build_world(hand_set)))
    run(hand_set.but(radius="stated-known", algorithms=("bridge", "bridge-known"), rounds=1), tmp_path, 1)
    known, unknown = (" ".join(rows_of(found)["a-priori"].curve.missing) for found in compare(tmp_path))
    assert "about known dynamics" in unknown
    assert not known


def test_command_writes_table_figure_and_data_and_the_same_again(star, capsys, tmp_path):
    texts = []
    for name in ("a", "b"):
        assert main(["compare", str(star), "--out", str(tmp_path / name)]) == 0
        texts.append({path.name: path.read_bytes() for path in sorted((tmp_path / name).iterdir())})
    assert list(texts[0]) == ["compare.json", "compare.pdf", "compare.png", "compare.txt"]
    assert texts[0] == texts[1]
    data = json.loads(texts[0]["compare.json"])
    assert [item["algorithm"] for item in data] == ["bridge-known", "bridge"]
    assert data[0]["versions"][0]["value"] == 24.0
    assert "a priori, repaired (R5)" in capsys.readouterr().out


def test_several_runs_stand_side_by_side(star, logged, compared, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["compare", str(star), str(logged)]) == 0
    data = json.loads((tmp_path / "out" / "compare" / "compare.json").read_text())
    assert [item["run"] for item in data] == [star.name, star.name, logged.name, logged.name]
    titles = [axes.get_title() for axes in figure(compared + tuple(renamed(compared))).axes]
    assert titles[0].startswith(star.name)
    assert titles[2].startswith("another")
    assert figure(compared).axes[0].get_title().startswith("starmdp")
    capsys.readouterr()


def renamed(comparisons):
    return [dataclasses.replace(comparison, run="another") for comparison in comparisons]


def test_an_environment_is_run_first_and_its_seeds_are_kept(tmp_path, capsys):
    arguments = ["compare", COUNTEREXAMPLE, "--rounds", "5", "--out", str(tmp_path), "--jobs", "1"]
    assert main(arguments) == 0
    before = (tmp_path / "seed-00000.nc").stat().st_mtime_ns
    assert main(arguments) == 0
    assert (tmp_path / "seed-00000.nc").stat().st_mtime_ns == before
    assert "T = 5" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["compare"], "required: RUN_OR_ENVIRONMENT"),
        (["compare", "starmpd"], "did you mean 'starmdp'"),
        (["compare", "."], ". is not the directory of a run"),
        (["compare", "starmdp", "gridworld"], "starmdp is not the directory of a run"),
        (["compare", "{star}", "--seeds", "3"], "--seeds belongs to a run that is made here"),
        (
            ["compare", "starmdp", "--preset", "published"],
            "not linear in the embedding",
        ),
        (
            ["compare", "starmdp", "--algorithms", "pbrl,bc"],
            "about which there is no theory",
        ),
        (["compare", "starmdp", "--preset", "counterexample"], "not one of the counterexamples"),
    ],
)
def test_mistakes_get_one_sentence(arguments, sentence, star, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main([text.format(star=star) for text in arguments]) == 2
    captured = capsys.readouterr()
    assert sentence in captured.err
    assert len(captured.err.strip().splitlines()) == 1


def test_the_current_directory_has_a_name(star, monkeypatch):
    monkeypatch.chdir(star)
    assert {found.run for found in compare(Path("."))} == {star.name}


def test_a_run_in_continuous_control_is_refused(star, tmp_path):
    shutil.copytree(star, tmp_path / "copy")
    config = continuous_preset("published", "reacher")
    for path in (tmp_path / "copy").glob("seed-*.nc"):
        stored = load_dataset(path, "run again")
        save_dataset(path, stored.assign_attrs(configuration=config.to_json()))
    (tmp_path / "copy" / "configuration.json").write_text(config.to_json())
    with pytest.raises(InputError, match="the theory can be compared on tabular environments"):
        compare(tmp_path / "copy")


def test_a_directory_without_results_is_one_sentence(tmp_path):
    with pytest.raises(InputError, match="holds no results"):
        compare(Path(tmp_path))
