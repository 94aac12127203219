"""A changed constant or operator in a formula is noticed; ``python -m proofs_checks.mutate`` tries all of them."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest

from proofs_checks.mutate import GOAL, report, share
from proofs_checks.mutation.campaign import Fate, campaign, observe_all
from proofs_checks.mutation.killers import Baseline, Killer, example_killers, file_killers, observe
from proofs_checks.mutation.sites import Site, formula_modules, mutated, sites

ROOT = Path(__file__).parent
SECOND_TRANSCRIPTIONS = (
    ROOT / "test_offline_formulas_are_transcribed_twice.py",
    ROOT / "theory" / "test_online_formulas_match_the_paper.py",
)
EVERY_SITE = [site for module in formula_modules() for site in sites(module)]
SAMPLE = 40


def site_at(module: str, change: str, text: str) -> Site:
    """The first site of a module with this change on a line that contains the text."""
    found = [s for s in sites(module) if s.change == change and text in s.path.read_text().splitlines()[s.line - 1]]
    return found[0]


@pytest.fixture(scope="module")
def baselines() -> list[Baseline]:
    return observe_all([*example_killers(), *file_killers(SECOND_TRANSCRIPTIONS)], processes=2)


def test_every_formula_module_is_mutated_in_many_places() -> None:
    assert len(EVERY_SITE) > 1000
    assert {site.module for site in EVERY_SITE} == set(formula_modules())
    assert len(set(map(str, EVERY_SITE))) > 0.8 * len(EVERY_SITE)


def test_a_mutant_differs_in_its_one_place_and_compiles() -> None:
    for site in np.random.default_rng(0).choice(np.array(EVERY_SITE, dtype=object), 60, replace=False):
        original, changed = (ast.dump(tree) for tree in (ast.parse(site.path.read_text()), mutated(site)))
        assert original != changed
        compile(mutated(site), str(site.path), "exec")


def test_texts_directions_and_examples_are_not_mutated() -> None:
    places = {(site.path, site.line) for site in EVERY_SITE}
    for path, line in places:
        text = path.read_text().splitlines()[line - 1]
        assert ">>>" not in text
        assert "words=" not in text


def test_a_sample_of_mutants_is_noticed(baselines: list[Baseline]) -> None:
    assert all(baseline.passes for baseline in baselines)
    picked = np.random.default_rng(7).choice(len(EVERY_SITE), SAMPLE, replace=False)
    fates = campaign([EVERY_SITE[index] for index in picked], baselines, processes=2)
    assert share(fates) >= GOAL - 0.1, report(fates)


def test_a_mutant_dies_with_its_process(baselines: list[Baseline]) -> None:
    site = site_at("bridge_theory.online.l1_bonus", "sqrt(x) -> x", "m.sqrt")
    (fate,) = campaign([site], baselines, processes=1)
    assert fate.killer is not None
    assert observe(Killer("examples", site.module)).passes


def test_a_mutant_that_means_the_same_survives_and_is_reported(baselines: list[Baseline]) -> None:
    nothing = [baseline for baseline in baselines if not baseline.touches(EVERY_SITE[0])]
    (fate,) = campaign([EVERY_SITE[0]], nothing, processes=1)
    assert fate == Fate(EVERY_SITE[0], None, "", 0)
    assert "nothing reaches it" in report([fate])
