"""What may notice a mutated formula: the checks of the ledger, the examples in docstrings, the tests."""

from __future__ import annotations

import contextlib
import doctest
import io
import os
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any, Literal

from proofs_checks.mutation.sites import Site, formula_modules
from proofs_checks.run import Job, jobs_for, run_job

Stage = Literal["ledger", "examples", "tests"]
STAGES: tuple[Stage, ...] = ("ledger", "examples", "tests")
Function = tuple[str, int, str]
"""File, first line and name of a function."""


@dataclass(frozen=True)
class Killer:
    """A check of the ledger by its key, the examples of a module by its name, or a test file by its path."""

    stage: Stage
    name: str

    def passes(self) -> bool:
        """Whether it is satisfied with the formulas as they are now."""
        if self.stage == "ledger":
            return run_job(Job(self.name), quick=True, seed=0).status == "holds"
        if self.stage == "examples":
            return _examples_pass(self.name)
        return _tests_pass(self.name)


@dataclass(frozen=True)
class Baseline:
    """What a killer does with the formulas as written: its time, and the functions it runs."""

    killer: Killer
    passes: bool
    seconds: float
    functions: frozenset[Function]

    def touches(self, site: Site) -> bool:
        """Whether it runs the innermost function around the site; tests may read what is outside of functions."""
        if not site.functions:
            return self.killer.stage == "tests" or any(path == str(site.path) for path, _, _ in self.functions)
        return (str(site.path), *site.functions[-1]) in self.functions


def ledger_killers() -> list[Killer]:
    """Every check of the ledger that a quick run makes."""
    from proofs_checks.ledger import evidence_by_key

    quick = [item for item in evidence_by_key().values() if not item.full_only]
    return [Killer("ledger", job.key) for job in jobs_for(quick, mutants=False)]


def example_killers() -> list[Killer]:
    """The docstring examples of every formula module."""
    return [Killer("examples", module) for module in formula_modules()]


def file_killers(paths: Iterable[Path]) -> list[Killer]:
    """Test files."""
    return [Killer("tests", str(path)) for path in paths]


def observe(killer: Killer) -> Baseline:
    """Run a killer on the formulas as written and record which functions of the formula modules it reaches."""
    files = {str(sys.modules[module].__file__) for module in formula_modules()}
    reached: set[Function] = set()

    def note(frame: FrameType, event: str, _: Any) -> None:
        code = frame.f_code
        if event == "call" and code.co_filename in files:
            reached.add((code.co_filename, code.co_firstlineno, code.co_name))

    start = time.perf_counter()
    sys.setprofile(note)
    try:
        passes = killer.passes()
    finally:
        sys.setprofile(None)
    return Baseline(killer, passes, time.perf_counter() - start, frozenset(reached))


def _examples_pass(module: str) -> bool:
    options = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    with contextlib.redirect_stdout(io.StringIO()):
        runner = doctest.DocTestRunner(optionflags=options, verbose=False)
        for test in doctest.DocTestFinder(exclude_empty=True).find(sys.modules[module]):
            runner.run(test)
    return runner.failures == 0


def _tests_pass(path: str) -> bool:
    import pytest

    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
        # plugins that checks of the ledger have imported already are not rewritten, which is of no account here
        options = ["-x", "-q", "-p", "no:cacheprovider", "-W", "ignore::pytest.PytestAssertRewriteWarning"]
        return pytest.main([*options, path]) == 0
