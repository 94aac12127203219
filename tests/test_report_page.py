"""The report needs nothing from elsewhere, trusts no text, draws what the figures show, and works in a browser."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from bridge_algos.netcdf import load_dataset, save_dataset
from bridge_algos.run.config import preset
from bridge_algos.run.runner import run
from bridge_theory.errors import InputError
from experiments.cli import main
from experiments.report.found import find_items
from experiments.report.interactive import panels
from experiments.report.mathtext import markup
from experiments.report.pictures import picture_html
from experiments.reproduce import configuration, reproduce

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--hide-scrollbars",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--enable-logging=stderr",
)  # fmt: skip
EVIL = "<script>alert(1)</script><b>\"'&"


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run and a reproduction, whose names, title and settings try to be markup."""
    root = tmp_path_factory.mktemp("reported")
    run(preset("theory", "starmdp").but(rounds=3), root / "run <b>", seeds=2, log=True)
    described = configuration("fig2-starmdp", quick=True)
    reproduce("fig2-starmdp", described, root / "fig2", jobs=1)
    data = load_dataset(root / "fig2" / "data.nc", "")
    settings = json.loads(data.attrs["settings"]) | {EVIL: EVIL}
    save_dataset(root / "fig2" / "data.nc", data.assign_attrs(title=EVIL, settings=json.dumps(settings)))
    return root


@pytest.fixture(scope="module")
def document(directory: Path) -> str:
    assert main(["report", str(directory)]) == 0
    return (directory / "report.html").read_text(encoding="utf-8")


def digest(script: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"


def body_of(document: str) -> str:
    return re.sub(r"<(style|script)[ >].*?</\1>", "", document, flags=re.DOTALL)


def test_the_page_is_small_and_needs_nothing_from_elsewhere(document: str) -> None:
    assert len(document.encode()) < 6e6
    assert re.findall(r'(?:src|href)="(?!#|data:)[^"]*"|url\((?!#)[^)]*\)|@import', body_of(document)) == []
    policy = re.findall(r'Content-Security-Policy" content="([^"]*)"', document)[0]
    assert policy.startswith("default-src 'none'")
    assert "unsafe-eval" not in policy
    scripts = re.findall(r"<script>(.*?)</script>", document, flags=re.DOTALL)
    assert f"script-src {' '.join(digest(text) for text in scripts)};" in policy


def test_internal_links_lead_somewhere(document: str) -> None:
    targets, body = set(re.findall(r' id="([^"]*)"', document)), body_of(document)
    links = re.findall(r'href="#([^"]*)"', body)
    assert len(links) > 10
    assert set(links) <= targets


def test_what_comes_from_files_is_escaped(document: str) -> None:
    body = body_of(document)
    assert "alert(1)" in body
    assert "<script>alert" not in document
    assert "run <b>" not in document
    assert "run &lt;b&gt;" in body
    assert body.count("&lt;script&gt;alert(1)&lt;/script&gt;") >= 4  # title, contents, name and value of the setting


def test_the_page_says_settings_words_bounds_and_verdicts(document: str) -> None:
    body = body_of(document)
    assert "configuration.n_demonstrations" in body
    assert "BRIDGE, last cumulative regret: published 21.12 ± 4.51" in body
    assert "hand-set numbers, without a guarantee" in body
    assert re.search(r"Regret, in utility: \d+ bounds that say nothing here", body)
    assert re.search(r"All \d+ statements", body)
    assert "4 of 4 certified, from 2 of 2 logs" in body
    best = "regret against the best stationary deterministic policy: it is searched because"
    assert f"<li>bridge: {best} every policy that agrees with all demonstrations is</li>" in body
    assert f"<li>pbrl: {best} all policies are</li>" in body
    assert "What is taken at its word</p><ul><li>bridge, pbrl: of search the data show no more than the names" in body
    assert "<li>bridge, pbrl: of algorithms = " in body
    assert "the teacher breaks" in body  # although the published preset's confidence sets are hand-set
    assert re.search(r"mean pseudo-regret [\d.]+ over 2 seeds", body)
    assert '<a href="#ledger-thm:main_simplified">thm:main_simplified</a>' in body  # the rate in the comparison
    assert "No comparison: " in body  # the published preset's embedding cannot express the reward


def test_the_same_directory_gives_the_same_page(directory: Path, document: str) -> None:
    assert main(["report", str(directory), "--out", str(directory / "again.html")]) == 0
    assert (directory / "again.html").read_text(encoding="utf-8") == document


def test_mistakes_are_named(tmp_path: Path, directory: Path) -> None:
    with pytest.raises(InputError, match="is not a directory"):
        find_items(tmp_path / "nowhere")
    with pytest.raises(InputError, match="holds neither a run"):
        find_items(tmp_path)
    data = load_dataset(directory / "fig2" / "data.nc", "")
    for attributes, message in (
        ({"study": "os"}, "study 'os' that is not known"),
        ({"study": "__init__"}, "not known"),
        ({"settings": "[]"}, "does not say its settings"),
        ({"configuration": "{}"}, "cannot be drawn"),
    ):
        save_dataset(tmp_path / "data.nc", data.assign_attrs(attributes))
        with pytest.raises(InputError, match=message):
            find_items(tmp_path)


def test_the_current_directory_has_a_name(directory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(directory / "fig2")
    assert [item.name for item in find_items(Path("."))] == ["fig2"]


def test_every_artist_has_its_counterpart() -> None:
    picture = Figure()
    lines, grid = picture.subplots(1, 2)
    x, y = np.array([1.0, 10.0, 100.0]), np.array([1.0, 2.0, 4.0])
    lines.plot(x, y, "--", color="#0072B2", label=r"BRIDGE, $\gamma_t$")
    lines.fill_between(x, y - 0.5, y + 1, color="#0072B2", alpha=0.2, linewidth=0)
    lines.errorbar(x, 2 * y, yerr=[[0.1, 0.2, 0.3], [1, 2, 3]], color="#D55E00", label="PbRL")
    lines.errorbar(x, 2.5 * y, yerr=0.1, errorevery=2, color="#CC79A7", label="published")
    lines.scatter(x, 3 * y, color="#009E73", label="BC")
    lines.bar(x, 0.5 * y, width=0.3, color="#56B4E9", label="share")
    lines.axhline(0, color="k", label="expert")
    lines.axvspan(10, 20, color="#eeeeee")
    lines.text(10, 2, "here < there")
    lines.set(xscale="log", xlabel="demonstrations n", ylabel=r"$\|\hat{w}_t\|$ (utility)", xlim=(1, 100))
    mesh = grid.pcolormesh([0, 1, 2], [0, 1, 2], [[1, 10], [100, np.nan]], norm=LogNorm(1, 100))
    picture.colorbar(mesh, ax=grid, label="regret")
    first, second = panels(picture)
    for panel in (first, second):
        go.Figure({"data": panel["data"], "layout": panel["layout"]})  # refuses what plotly does not know
    by_name: dict[str, Any] = {trace["name"]: trace for trace in first["data"] if trace["name"]}
    assert list(by_name) == ["PbRL", "published", "share", "BRIDGE, γ<sub><i>t</i></sub>", "BC", "expert"]
    curve = by_name["BRIDGE, γ<sub><i>t</i></sub>"]
    assert (curve["x"], curve["y"], curve["line"]["dash"]) == (x.tolist(), y.tolist(), "dash")
    assert curve["customdata"] == [[0.5, 2.0], [1.5, 3.0], [3.5, 5.0]]
    bars = by_name["PbRL"]["error_y"]
    np.testing.assert_allclose(bars["array"], [1, 2, 3])
    np.testing.assert_allclose(bars["arrayminus"], [0.1, 0.2, 0.3])
    some = [trace for trace in first["data"] if trace["meta"]["group"] == "published"]
    assert [trace.get("error_y") for trace in some] == [None, None]
    assert some[1]["y"] == [2.4, 2.6, None, 9.9, 10.1, None]
    assert by_name["BC"]["mode"] == "markers"
    assert by_name["share"]["y"] == (0.5 * y).tolist()
    assert by_name["expert"]["x"] == [1, 100]
    assert first["layout"]["xaxis"]["range"] == [0, 2]
    assert first["layout"]["annotations"][0]["text"] == "here &lt; there"
    assert first["layout"]["annotations"][0]["x"] == 1
    cells = second["data"][0]
    assert cells["z"] == [[0, 0.5], [1, None]]  # as the colours are scaled
    assert cells["colorbar"]["tickvals"] == [0, 0.5, 1]
    assert cells["customdata"] == [[1, 10], [100, None]]
    assert cells["meta"]["colour"] == "regret"


def test_panels_that_stand_alone_say_what_their_grid_says_once() -> None:
    picture = Figure()
    grid = picture.subplots(2, 2)
    for column, quantity in enumerate(("regret", "size")):
        grid[0, column].set_title(quantity)
        grid[1, column].set_xlabel("round t")
    for row, environment in enumerate(("starmdp", "gridworld")):
        grid[row, 0].set_ylabel(environment)
    said = [
        (panel["title"], *(panel["layout"][axis]["title"]["text"] for axis in ("xaxis", "yaxis")))
        for panel in panels(picture)
    ]
    assert said == [
        ("regret", "round t", "starmdp"),
        ("size", "round t", "starmdp"),
        ("regret", "round t", "gridworld"),
        ("size", "round t", "gridworld"),
    ]


def test_a_figure_without_counterpart_is_shown_as_a_picture() -> None:
    picture = Figure()
    picture.subplots().pie([1, 2])
    with pytest.raises(InputError, match="has no interactive form"):
        panels(picture)
    assert '<img alt="a pie" src="data:image/png;base64,' in picture_html(picture, "a pie")


@pytest.mark.parametrize("label", [r"$\frac{1}{2}$", "$x", "${x$", "$x}$", "$x_$"])
def test_labels_that_cannot_be_shown_are_refused(label: str) -> None:
    with pytest.raises(InputError, match="the figure's label"):
        markup(label)


PROBE = """
const frame = () => new Promise((done) => setTimeout(done, 60));
const look = async () => {
  while (!document.documentElement.dataset.drawn) await frame();
  const figures = [...document.querySelectorAll('figure.interactive')];
  const drawn = '.trace, .heatmaplayer image';
  const blank = [...document.querySelectorAll('.panel')].filter((p) => !p.querySelector(drawn)).length;
  const figure = figures.find((f) => f.querySelector('.legend'));
  const box = figure.querySelector('.panel'), drag = box.querySelector('.nsewdrag').getBoundingClientRect();
  box.querySelector('.nsewdrag').dispatchEvent(new MouseEvent('mousemove', {
    bubbles: true, clientX: drag.x + drag.width / 2, clientY: drag.y + drag.height / 2 }));
  await frame(); await frame();
  const hover = box.querySelector('.hoverlayer').textContent.includes('BRIDGE');
  const shown = () => figure.querySelectorAll('.scatterlayer .trace').length;
  const button = figure.querySelector('.legend button'), before = shown();
  button.click(); await frame(); await frame();
  const without = shown();
  button.click(); await frame(); await frame();
  const toggles = without < before && shown() === before;
  await Plotly.relayout(box, { 'xaxis.range': [2, 3] });
  const folded = document.querySelector('details.long');
  location.hash = folded.querySelector('[id]').id; await frame();
  const wide = document.documentElement.scrollWidth - innerWidth;
  console.log(`report: ${figures.length} figures, ${blank} blank, hover ${hover}, toggles ${toggles}, `
    + `unfolds ${folded.open}, ${innerWidth} px, ${wide} too wide, scripts ${typeof alerted}`);
};
look();
"""


@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
@pytest.mark.parametrize("width", [375, 1100])
def test_a_browser_draws_the_page_without_an_error(document: str, tmp_path: Path, width: int) -> None:
    probed = document.replace("script-src ", f"script-src {digest(PROBE)} ", 1)
    (tmp_path / "report.html").write_text(probed.replace("</body>", f"<script>{PROBE}</script></body>"), "utf-8")
    frame = tmp_path / "frame.html"  # a window has a least width, a frame has not
    frame.write_text(f'<body style="margin:0"><iframe src="report.html" width="{width}" height="900"></iframe>')
    seen = subprocess.run(
        [str(CHROMIUM), *FLAGS, f"--user-data-dir={tmp_path / 'profile'}", "--window-size=1200,1000",
         "--virtual-time-budget=30000", "--dump-dom", frame.as_uri()],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    console = [entry for entry in seen.stderr.splitlines() if "CONSOLE" in entry]
    assert len(console) == 1, console
    expected = f"report: 3 figures, 0 blank, hover true, toggles true, unfolds true, {width} px, 0 too wide, "
    assert f"{expected}scripts undefined" in console[0]
