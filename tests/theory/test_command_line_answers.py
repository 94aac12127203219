"""``bridge-rl bounds`` and ``bridge-rl plan``: what is printed is certified, complete, and says what is missing."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from bridge_theory import Setting, bounds_from_counts, offline_radius, regret_unknown_version_space
from bridge_theory.cli import bounds, plan
from bridge_theory.cli.figure import draw
from bridge_theory.cli.sweep import parse_sweep
from bridge_theory.errors import InputError

_OFFLINE = ["--S", "5", "--A", "4", "--H", "8", "--n", "2", "--delta", "0.05", "--gamma-min", "0.1"]
_ONLINE = ["--d", "3", "--B", "1", "--W", "0.5", "--lam", "1"]


def _without(flags: list[str], name: str) -> list[str]:
    at = flags.index(name)
    return flags[:at] + flags[at + 2 :]


def test_table_groups_rows_and_says_what_would_add_more(capsys: pytest.CaptureFixture[str]) -> None:
    assert bounds.main(_OFFLINE) == 0
    out = capsys.readouterr().out
    row = next(line for line in out.splitlines() if line.split()[:1] == ["offline_radius"])
    assert "[1261.0017300103264, 1261.0017300103266]" in row
    assert row.split()[-3:] == ["vacuous", "stated", "thm:tabular_confidence_set"]
    assert out.index("\noffline\n" if not out.startswith("offline") else "offline\n") < out.index("\nonline\n")
    assert out.index("\nonline\n") < out.index("\nregret\n")
    assert "--B --W would add kappa, kappa_differences, kappa_nonnegative" in out
    assert "filled in: K = 1" in out or "rows = 5" in out
    assert "equal parts of delta in each bound" in out
    assert "~ " in out  # a rate


def test_missing_parameter_of_a_chosen_row_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    bounds.main(
        [*_without(_OFFLINE, "--gamma-min"), "--only", "offline_radius", "--only", "lem:offline_CI_under_known_dyn"]
    )
    out = capsys.readouterr().out
    assert "offline_radius_known" in out
    assert "--gamma-min would add offline_radius" in out


def test_left_out_lists_intermediate_quantities(capsys: pytest.CaptureFixture[str]) -> None:
    bounds.main(["--S", "5", "--left-out"])
    out = capsys.readouterr().out
    assert "--gamma-min --R would add" in out
    assert "(the table counts)" in out


def test_undefined_row_says_why(capsys: pytest.CaptureFixture[str]) -> None:
    flags = ["--S", "5", "--A", "4", "--H", "8", "--eta", "1", "--delta", "0.05", "--N", "1", "--only", "xi"]
    bounds.main(flags)
    assert "the paper's text has no value there" in capsys.readouterr().out


def test_json_is_certified_and_complete(capsys: pytest.CaptureFixture[str]) -> None:
    bounds.main([*_OFFLINE, "--json"])
    records = {record["name"]: record for record in json.loads(capsys.readouterr().out)}
    radius = records["offline_radius"]
    enclosure = offline_radius.enclosure(S=5, A=4, H=8, n=2, delta="0.05", gamma_min="0.1")
    assert (radius["lower"], radius["upper"]) == (enclosure.lower, enclosure.upper)
    assert radius["vacuous"] is True
    assert set(radius["terms"]) == {"policy", "transition", "transfer"}
    assert records["transition_error_rate"]["estimate"] > 0
    assert "lower" not in records["transition_error_rate"]


def test_latex(capsys: pytest.CaptureFixture[str]) -> None:
    bounds.main([*_OFFLINE, "--only", "offline_radius", "--only", "transition_error_rate", "--latex"])
    out = capsys.readouterr().out
    assert out.startswith("\\begin{align*}\n  % offline_radius\n")
    assert r"\leq 1261.01 &\quad\text{stated}" in out
    with pytest.raises(InputError, match="no bound is determined"):
        bounds.main(["--only", "offline_radius", "--latex"])


def test_latex_of_an_undefined_row_has_no_number(capsys: pytest.CaptureFixture[str]) -> None:
    bounds.main(
        ["--S", "5", "--A", "4", "--H", "8", "--eta", "1", "--delta", "0.05", "--N", "1", "--only", "xi", "--latex"]
    )
    assert "approx" not in capsys.readouterr().out


def test_explain_with_and_without_values(capsys: pytest.CaptureFixture[str]) -> None:
    bounds.main([*_OFFLINE, "--explain", "offline_radius"])
    out = capsys.readouterr().out
    for part in ("Statement:", "Assumptions:", "falls in n:", "96.6%  dominates", "with probability at least 0.95"):
        assert part in out
    bounds.main(["--explain", "offline_radius", "--S", "5"])
    assert "Its value also needs --A --H --n --delta --gamma-min." in capsys.readouterr().out
    bounds.main(
        ["--explain", "transition_error_rate", "--S", "2", "--A", "2", "--H", "2", "--n", "9", "--delta", "0.5"]
    )
    assert "stated" in capsys.readouterr().out
    bounds.main(["--explain", "delta_n_known", "--radius", "0.1"])
    assert "Value:" in capsys.readouterr().out
    bounds.main(["--explain", "regret_trivial", "--B", "1", "--W", "1", "--T", "9"])
    assert "Trivial value" not in capsys.readouterr().out
    bounds.main(["--explain", "regret_known_repaired", *_ONLINE, "--T", "9", "--delta", "0.05"])
    assert "dominates" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("flags", "range_", "label"),
    [
        (_without(_OFFLINE, "--n"), "n=1:1e7:log", "offline_radius_repaired_angle (sharp)"),
        (_without(_OFFLINE, "--gamma-min"), "gamma-min=0.01:1", "offline_radius (stated)"),
        ([*_OFFLINE, *_ONLINE], "T=1:1e6:log", "regret_known_version_space (repaired)"),
        ([*_without(_OFFLINE, "--delta")], "delta=0.001:0.5:lin", "offline_radius (stated)"),
    ],
)
def test_sweep_draws_a_figure(
    flags: list[str], range_: str, label: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "sweep.png"
    bounds.main([*flags, "--sweep", range_, "--figure", str(path)])
    out = capsys.readouterr().out
    assert label in out
    assert "trivial" in out
    assert path.read_bytes().startswith(b"\x89PNG")


def test_sweep_of_chosen_bounds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "sweep.svg"
    flags = ["--only", "kappa", "--only", "offline_radius_known", "--A", "4", "--delta", "0.05", "--B", "1", "--W", "1"]
    bounds.main([*flags, "--n", "9", "--sweep", "S=1:4", "--figure", str(path)])
    out = capsys.readouterr().out
    assert [line.split()[0] for line in out.splitlines()[2:-1]] == ["1", "2", "3", "4"]
    assert "<svg" in path.read_text()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("n", "is not a range; write for example"),
        ("n=1:2:lag", "is not a range"),
        ("n=5:1", "needs low < high"),
        ("R1=0:1:log", "needs low < high and low > 0"),
        ("counts=1:2", "cannot vary the array counts"),
        ("m=1:2", "'m' is not a parameter"),
        ("n=0.5:2", "n = 0.5 is outside its domain"),
        ("n=1:1e400:log", "ends beyond 1e\\+300"),
    ],
)
def test_sweep_ranges_that_make_no_sense(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse_sweep(text)


def test_sweep_refusals(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no figure varies with chi2"):
        bounds.main([*_OFFLINE, "--sweep", "chi2=0:1"])
    with pytest.raises(InputError, match="offline_radius cannot be drawn; it also needs --A --H --delta --gamma-min"):
        bounds.main(["--S", "5", "--only", "offline_radius", "--sweep", "n=1:5"])
    with pytest.raises(InputError, match=r"use a name that ends in .png, .pdf or .svg"):
        draw(tmp_path / "figure.txt", [], x_label="", y_label="", title="", log_x=False, log_y=False)


def test_rows_from_demonstrations(capsys: pytest.CaptureFixture[str]) -> None:
    visits = np.array([[[3, 0], [0, 0]], [[2, 0], [0, 1]]])
    transitions = np.zeros((1, 2, 2, 2), dtype=int)
    transitions[0, 0, 0] = [2, 1]
    values = bounds_from_counts(visits, transitions, delta="0.05", mass="0.25")
    bounds.main(["--S", "2"], data=list(values.values()))
    out = capsys.readouterr().out
    block = out[out.index("from the demonstrations") :]
    for name in ("missing_mass_observed", "transition_kl_budget", "offline_radius_mass", "offline_radius_stochastic"):
        assert name in block
    assert "0.5" in block


def test_plan_for_a_radius(capsys: pytest.CaptureFixture[str]) -> None:
    assert plan.main([*_without(_OFFLINE, "--n"), "--target-radius", "0.9"]) == 0
    out = capsys.readouterr().out
    assert "182831  <= 0.8999998510618952  >= 0.9000024755685818" in out
    assert "offline_radius_repaired_angle" in out


def test_plan_for_a_regret(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "plan.png"
    flags = [*_OFFLINE, *_ONLINE, "--T", "1000", "--target-regret", "100", "--figure", str(path)]
    plan.main(flags)
    out = capsys.readouterr().out
    assert "demonstrations n for a regret of at most 100 at T = 1000" in out
    assert "preference queries T for a regret of at most 100 at n = 2" in out
    assert "trade-off" in out
    assert "none" in out  # the stated theorem never gets there with so few demonstrations
    assert path.read_bytes().startswith(b"\x89PNG")
    plan.main([*flags, "--json"])
    records = json.loads(capsys.readouterr().out)
    found = [record for record in records if record["answer"] == "found"]
    assert all(record["meets"][1] <= 100 < record["fails"][1] for record in found)


def test_plan_does_not_call_the_end_of_its_search_an_answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan.main([*_OFFLINE, *_ONLINE, "--target-regret", "1e30", "--figure", str(tmp_path / "p.png")])
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert next(row for row in rows if row[:1] == ["regret_known_version_space"])[2:4] == [">=", "1" + 24 * "0"]
    plan.main([*_without(_OFFLINE, "--n"), "--target-radius", "1e-11"])
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert next(row for row in rows if row[:1] == ["offline_radius_repaired"])[2:4] == [">", "1" + 24 * "0"]


def test_plan_for_a_regret_no_bound_reaches(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    flags = [*_without(_OFFLINE, "--n"), *_ONLINE, "--target-regret", "0", "--figure", str(tmp_path / "p.png")]
    plan.main(flags)
    out = capsys.readouterr().out
    assert "figure: none is drawn, no bound reaches the target" in out
    assert not (tmp_path / "p.png").exists()


@pytest.mark.parametrize(
    ("main", "argv", "message"),
    [
        (plan.main, [], "plan needs a target; write --target-radius 0.9 or --target-regret 100"),
        (
            plan.main,
            ["--target-radius", "1", "--S", "5"],
            "solving for n needs more of the problem; add --A",
        ),
        (plan.main, ["--target-radius", "-1"], "--target-radius -1 is negative"),
        (plan.main, ["--target-regret=-0.5"], "--target-regret -0.5 is negative"),
        (
            bounds.main,
            [
                "--B",
                "1",
                "--W",
                "1",
                "--d",
                "1",
                "--S",
                "1",
                "--A",
                "2",
                "--n",
                "9",
                "--T",
                "9",
                "--delta",
                "0.05",
                "--sweep",
                "lam=0.01:10",
                "--only",
                "regret_known_stated",
            ],
            "lam = 240 values from 0.01 to 10",
        ),
        (bounds.main, ["--delta", "1.5"], "delta = 1.5 is outside its domain"),
        (bounds.main, ["--S", "5x"], "S = '5x' is not a finite number"),
        (bounds.main, ["--B", "1e999999999"], "B = 1e999999999 is out of reach; exact numbers have powers of ten from"),
        (bounds.main, ["--B=-1e-999999999"], "B = -1e-999999999 is out of reach"),
        (bounds.main, ["--states", "5"], "unrecognized arguments: --states 5; try 'bridge-rl bounds --help'"),
        (bounds.main, ["--only", "thm:main_knwn"], "closest: thm:main_known"),
    ],
)
def test_mistakes_are_one_sentence(main: object, argv: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        main(argv)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("main", [bounds.main, plan.main])
def test_help(main: object, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["--help"])
    assert caught.value.code == 0
    assert "--gamma-min" in capsys.readouterr().out


def test_numbers_beyond_float64(capsys: pytest.CaptureFixture[str]) -> None:
    flags = ["--S", "5", "--A", "4", "--H", "8", "--n", "1e400", "--delta", "0.05"]
    assert bounds.main([*flags, "--only", "transition_error_repaired", "--only", "transition_error_rate"]) == 0
    out = capsys.readouterr().out
    assert "4.94066e-324" in out  # positive and below every float64
    assert "n is beyond float64" in out
    assert bounds.main(["--B", "1e200", "--W", "1e200", "--only", "kappa", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["upper"] is None
    assert bounds.main(["--B", "1e200", "--W", "1e200", "--only", "kappa"]) == 0
    assert "nan" not in capsys.readouterr().out
    flags = ["--W", "1", "--lam", "1", "--d", "1", "--S", "1", "--A", "2", "--n", "9", "--T", "9", "--delta", "0.05"]
    assert bounds.main(["--B", "1e400", *flags, "--only", "regret_known_stated"]) == 0
    assert "vacuous" in capsys.readouterr().out  # lam >= B / kappa is decided beyond float64 too
    assert bounds.main(["--B", "1e-400", *flags, "--only", "regret_known_rate"]) == 0
    assert "B is beyond float64" in capsys.readouterr().out


def test_plan_answers_where_one_theorem_does_not_apply(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    problem = ["--S", "5", "--A", "4", "--H", "8", "--delta", "0.4", "--T", "100", *_ONLINE]
    plan.main([*problem, "--target-regret", "50", "--figure", str(tmp_path / "p.png")])
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    stated = next(row for row in rows if row[:1] == ["regret_known_stated"])
    assert stated[2:5] == ["-", "regret_known_stated", "applies"]
    known = next(row for row in rows if row[:1] == ["regret_known_version_space"])
    assert int(known[2]) > 1
    assert ["left", "out:", "regret_unknown_repaired:", "rises", "in", "n:"] in [row[:6] for row in rows]
    assert ["left", "out:", "regret_unknown_version_space:", "not", "known"] in [row[:5] for row in rows]


def test_plan_of_queries_with_unknown_dynamics(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    setting = {"S": 5, "A": 4, "H": 8, "delta": "0.05", "n": 1000, "B": 1, "W": "0.5", "d": 3, "lam": 1}
    flags = [text for name, value in setting.items() for text in (f"--{name}", str(value))]
    plan.main([*flags, "--target-regret", "50", "--json", "--figure", str(tmp_path / "p.png")])
    records = json.loads(capsys.readouterr().out)
    mine = [record for record in records if record["bound"] == "regret_unknown_version_space"]
    queries = next(record for record in mine if record["parameter"] == "T")
    # the demonstrations decide: 2BW T (1 - (delta_off / (2^S - 1))^(1/n)) with delta_off = delta / 5
    assert int(queries["value"]) == math.floor(50 / -math.expm1(math.log(0.01 / 31) / 1000))
    assert regret_unknown_version_space.value(Setting(**setting), T=int(queries["value"])).enclosure.upper <= 50
    left_out = [record["others"]["T"] for record in mine if record["answer"] == "left out"]
    assert len(set(left_out)) == len(left_out) == 49
