"""``constraints-lowest.txt`` pins every declared requirement of the core at its lower bound, and nothing else of it."""

import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.version import Version

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
NEEDED_BY_TESTS = ("pytest", "beartype", "hypothesis")


def lower_bounds(texts: list[str]) -> dict[str, Version]:
    declared = [Requirement(text) for text in texts]
    return {
        needed.name: Version(limit.version)
        for needed in declared
        for limit in needed.specifier
        if limit.operator == ">=" and needed.name != "bridge-rl"
    }


def test_every_bound_is_tested() -> None:
    lines = [line for line in (ROOT / "constraints-lowest.txt").read_text().splitlines() if not line.startswith("#")]
    pinned = {needed.name: Version(next(iter(needed.specifier)).version) for needed in map(Requirement, lines)}
    extras = PROJECT["optional-dependencies"]
    bounds = lower_bounds(PROJECT["dependencies"])
    tools = lower_bounds([*extras["dev"], *extras["checks"]])
    bounds |= {name: tools[name] for name in NEEDED_BY_TESTS}
    assert len(bounds) == len(PROJECT["dependencies"]) + len(NEEDED_BY_TESTS)
    assert {name: pinned.get(name) for name in bounds} == bounds
