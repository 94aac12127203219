"""A wrong line in the source of the checker, or of the comparison, makes a test fail: the tests named beside it.

That they pass on the source as it is, the suite itself shows.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent

HONEST = "test_honest_logs_are_certified.py"
HEADERS = "test_headers_are_held_against_the_data.py"
EXACT = "test_certificates_are_exact.py"
COMPARED = "test_comparison_with_theory.py"
SEQUENCES = "test_confidence_sequences_cover.py"
LIKELIHOOD = "test_likelihood_set_bounds_the_regret.py"

ALONE = (HONEST, "hypothesis_alone")
DECIDES = (HONEST, "decides_the_comparator")
CONTRADICTED = (HEADERS, "what_the_data_contradict")

DEFINED = (LIKELIHOOD, "that_of_its_definition and repaired")
REPLAYED = (LIKELIHOOD, "that_of_its_definition and likelihood")
EVIDENCE = (LIKELIHOOD, "both_evidences")
RULED_OUT = "test_dominated_policies_are_ruled_out.py"
EXACTLY = (RULED_OUT, "goes_exactly")
LEFT = (RULED_OUT, "the_checker_finds")

MUTANTS: dict[str, tuple[str, str, str, tuple[str, str]]] = {
    "a teacher of returns is accepted": (
        "proofs_checks.verify.conditions", '_teacher(given): config["oracle"] != "bradley-terry"', '"": False', ALONE,
    ),
    "any slope is accepted": ("proofs_checks.verify.conditions", "given.slope != 1", "given.slope < 0", ALONE),
    "noise leaves the counts as they are": (
        "proofs_checks.verify.conditions", 'config["noise"] != 0', 'config["noise"] < 0', ALONE,
    ),
    "failure probabilities add up to anything": (
        "proofs_checks.verify.conditions", "total >= 1", "total > 2", ALONE,
    ),
    "noise keeps the claim of the version space": (
        "proofs_checks.verify.comparator", '        and config["noise"] == 0\n', "", DECIDES,
    ),
    "a file keeps it": ("proofs_checks.verify.comparator", 'and config["demonstrations"] is None', "", DECIDES),
    "any expert keeps it": (
        "proofs_checks.verify.comparator", 'config["expert"] == "best-stationary"', "True", DECIDES,
    ),
    "any embedding keeps it": ("proofs_checks.verify.comparator", 'and config["embedding"] in LINEAR', "", DECIDES),
    "best bounds accumulate forwards": (
        "proofs_checks.verify.regret", "np.minimum.accumulate(best[::-1])[::-1]", "np.minimum.accumulate(best)",
        (EXACT, "best_bound_is_all"),
    ),
    "best bounds do not look ahead": (
        "proofs_checks.verify.regret", "np.minimum.accumulate(best[::-1])[::-1]", "best", (EXACT, "best_bound_is_all"),
    ),
    "sentences are merged by algorithm": (
        "proofs_checks.verify.certificate", "if own == seeds[algorithm]:", "if own:", (HONEST, "sentences_belong"),
    ),
    "any number of demonstrations": ("proofs_checks.verify.consistency", "if found != wanted:", "if found < 0:",
                                     CONTRADICTED),
    "experts differ with themselves": (
        "proofs_checks.verify.consistency", 'if config["noise"] == 0 and differ(facts):', "if False:", CONTRADICTED,
    ),
    "teachers answer anything": (
        "proofs_checks.verify.consistency", "if given.all() else", "if True else", (HEADERS, "teacher_can_give"),
    ),
    "violated although the allowed failure explains it": (
        "experiments.compare.comparison", "chance > allowed", "chance > 0", (COMPARED, "violated_needs"),
    ),
    "violated whenever exceeded": (
        "experiments.compare.comparison", "allowed == 0 or chance > allowed", "True", (COMPARED, "violated_needs"),
    ),
    "never violated by chance": (
        "experiments.compare.comparison", "chance > allowed", "False", (COMPARED, "violated_needs"),
    ),
    "bets peek at the observation they bet on": (
        "experiments.compare.sequence", "[np.full((1, *x.shape[1:]), 0.25), variances[:-1]]", "[variances]",
        (SEQUENCES, "bets_do_not_depend"),
    ),
    "false statements are the best bound": (
        "experiments.compare.comparison", 'not in ("stated", "stated-sums", "rate") or holds', "!= '' or holds",
        (COMPARED, "only_what_is_proved"),
    ),
    "uncounted sets are whole": (
        "experiments.compare.applicability", "not bool(subject.results.search_way.isin(EXHAUSTIVE).all())",
        'bool((subject.results.search_way == "sample").any())', (COMPARED, "may_be_a_sample"),
    ),
    "the likelihood set of the checker forgets delta": (
        "proofs_checks.verify.likelihood", " + ball(delta).log()", "", DEFINED,
    ),
    "half of W around the likelihood set": (
        "proofs_checks.verify.likelihood", "highest = ends(ball(weight_bound))[1]",
        "highest = ends(ball(weight_bound))[1] / 2", DEFINED,
    ),
    "negative multipliers of the likelihood": (
        "proofs_checks.verify.likelihood",
        "np.maximum(ratio * across / np.sqrt(1 - ratio**2) - along, 0)",
        "(ratio * across / np.sqrt(1 - ratio**2) - along)", (LIKELIHOOD, "any_point_bounds"),
    ),
    "one point bounds the regret loosely": ("proofs_checks.verify.likelihood", "if inside else 0", "* 0", REPLAYED),
    "a round too many in the regret": ("proofs_checks.verify.walk", "plays, t - 1)", "plays, t)", DEFINED),
    "the divergence is added": (
        "proofs_checks.verify.evidence", "total - lam * square / 2", "total + lam * square / 2", EVIDENCE,
    ),
    "the determinant is added": (
        "proofs_checks.verify.evidence", "- _log_det_ratio(answers", "+ _log_det_ratio(answers", EVIDENCE,
    ),
    "the learner's evidence adds the determinant": (
        "bridge_algos.asking.ellipsoid", "fit - volume + prior", "fit + volume - prior", EVIDENCE,
    ),
    "the ellipsoid forgets delta": ("bridge_algos.asking.ellipsoid", " - log(1 / delta)", "", REPLAYED),
    "the ellipsoid starts at half of W": (
        "bridge_algos.asking.ellipsoid", "reach = weight_bound *", "reach = weight_bound / 2 *", REPLAYED,
    ),
    "the ellipsoid keeps the larger interval": (
        "bridge_algos.asking.ellipsoid", "np.maximum(low, middle - width), np.minimum(high, middle + width)",
        "middle - width, middle + width", REPLAYED,
    ),
    "the ellipsoid's curvature is that at the fit": (
        "bridge_algos.asking.ellipsoid", "slope * _lower_curvature(far)", "slope * 1.0",
        (LIKELIHOOD, "holds_every_likely_weight"),
    ),
    "a policy goes before its bound is negative": (
        "bridge_algos.online.likelihood", "gone[chosen] = found.bound < 0", "gone[chosen] = found.bound < 0.3", EXACTLY,
    ),
    "a policy stays by weights that are no longer likely": (
        "bridge_algos.online.likelihood", "known = known[region.answers.log_likelihood(known) >= region.level]",
        "known = known.copy()", EXACTLY,
    ),
    "a shared certificate rules everybody out": (
        "bridge_algos.online.likelihood", "region, v[rest], point) < 0", "region, v[rest], point) < np.inf", EXACTLY,
    ),
    "bonuses do not matter": (
        "bridge_algos.online.likelihood", "is not None and not bonus.any()", "is not None", (RULED_OUT, "bonuses"),
    ),
    "everybody challenges": (
        "bridge_algos.online.likelihood", "kept & challenging)\n            upper", "kept)\n            upper",
        (RULED_OUT, "may_not_challenge"),
    ),
    "half an answer counts": (
        "bridge_algos.online.likelihood", "np.isin(outcomes, (0.0, 1.0))", "(outcomes >= 0)", (RULED_OUT, "nothing"),
    ),
    "the checker looks more rarely than the run": (
        "proofs_checks.verify.remaining", "GROWTH = 1.02", "GROWTH = 1.5", LEFT,
    ),
    "the checker rules nobody out by certificates": (
        "proofs_checks.verify.remaining", "self._compare(self.answers, features)", "pass", LEFT,
    ),
    "the checker takes any larger number of policies": (
        "proofs_checks.verify.claims", "int(perhaps.sum())", "len(perhaps)", (RULED_OUT, "another_number"),
    ),
    "unknown dynamics have a likelihood bound": (
        "proofs_checks.verify.conditions", '"the learner did not know the dynamics": not given.known', '"": False',
        (LIKELIHOOD, "for_known_dynamics"),
    ),
}  # fmt: skip
"""Module, a line of it, what becomes of that line, and a test file with the words that pick its tests."""

PROGRAM = """
import importlib.abc, importlib.util, pathlib, sys
import pytest

name, old, new, *arguments = sys.argv[1:]
path = pathlib.Path(name.replace(".", "/") + ".py").resolve()
source = path.read_text()
if source.count(old) != 1:
    print(f"{path} holds {old!r} {source.count(old)} times")
    sys.exit(5)  # no verdict, unlike the status 1 of a failed test

class Mutated(importlib.abc.SourceLoader):
    def get_filename(self, fullname): return str(path)
    def get_data(self, given): return source.replace(old, new).encode()

class Finder(importlib.abc.MetaPathFinder):
    def find_spec(self, fullname, *_):
        return importlib.util.spec_from_loader(name, Mutated()) if fullname == name else None

sys.meta_path.insert(0, Finder())
sys.exit(pytest.main(["-x", "-q", "-p", "no:cacheprovider", *arguments]))
"""


def outcome(module: str, old: str, new: str, tests: tuple[str, str]) -> int:
    """Exit status of pytest: 0 when all pass, 1 when one fails; anything else, such as no test, is no verdict."""
    file, words = tests
    command = [sys.executable, "-c", PROGRAM, module, old, new, str(ROOT / "tests" / file), "-k", words]
    return subprocess.run(command, cwd=ROOT, capture_output=True, check=False).returncode


@pytest.mark.parametrize("name", MUTANTS)
def test_a_mutant_of_the_source_is_noticed(name: str) -> None:
    assert outcome(*MUTANTS[name]) == 1
