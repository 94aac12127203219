"""Runs of a study: a preset with changes, and all its seeds, one after another."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import xarray as xr

from bridge_algos.run.config import RunConfig, preset
from bridge_algos.run.seed import run_seed
from bridge_algos.run.world import World, build_world
from bridge_theory.errors import InputError

_ENTRIES = tuple(entry.name for entry in fields(RunConfig))


def configured(settings: dict[str, Any]) -> RunConfig:
    """The configuration that a study's ``environment``, ``preset`` and ``changes`` (optional) describe.

    >>> configured({"environment": "starmdp", "preset": "published", "changes": {"fit": "exact"}}).fit
    'exact'
    """
    config = preset(settings["preset"], settings["environment"])
    for entry, value in settings.get("changes", {}).items():
        config = changed(config, entry, value)
    return config


def changed(config: RunConfig, entry: str, value: Any) -> RunConfig:
    """The configuration with one entry changed; ``oracle_options.mistakes`` reaches into an entry.

    Raises:
        InputError: for an unknown entry, or a value that does not suit it.

    >>> changed(preset("published", "starmdp"), "oracle_options.mistakes", 0.1).oracle_options
    {'mistakes': 0.1}
    """
    name, _, inner = entry.partition(".")
    if name not in _ENTRIES or (inner and not isinstance(getattr(config, name), dict)):
        raise InputError(
            f"a study changes {entry!r}, which is no entry of a run; expected one of {', '.join(_ENTRIES)}."
        )
    return config.but(**{name: {**getattr(config, name), inner: value} if inner else value})


def preset_text(settings: dict[str, Any]) -> str:
    """A study's preset, and what the study has otherwise throughout, but for algorithms and rounds, which texts show.

    >>> preset_text({"environment": "starmdp", "preset": "published", "changes": {"fit": "exact", "rounds": 9}})
    'published preset but for fit = exact'
    """
    base, config = preset(settings["preset"], settings["environment"]), configured(settings)
    changes = [
        f"{name} = {getattr(config, name)}"
        for name in _ENTRIES
        if name not in ("algorithms", "rounds") and getattr(config, name) != getattr(base, name)
    ]
    return f"{settings['preset']} preset" + (f" but for {', '.join(changes)}" if changes else "")


def entries(config: RunConfig) -> dict[str, Any]:
    """The configuration as plain JSON values, for a cell."""
    described: dict[str, Any] = json.loads(config.to_json())
    return described


def worlds(configuration: dict[str, Any], seeds: int, fresh: bool = False) -> Iterator[tuple[RunConfig, World, int]]:
    """Configuration, world and number of each seed of a cell.

    Args:
        configuration: from :func:`entries`.
        seeds: how many, 0 to seeds - 1.
        fresh: whether each seed draws its own environment, by the environment's option ``seed``; then a seed is one
            independent draw from the family of environments and from the data.
    """
    config = RunConfig.from_json(json.dumps(configuration))
    world = None if fresh else build_world(config)
    for seed in range(seeds):
        drawn = changed(config, "environment_options.seed", seed) if fresh else config
        yield drawn, world or build_world(drawn), seed


def all_seeds(configuration: dict[str, Any], seeds: int, fresh: bool = False) -> list[xr.Dataset]:
    """What :func:`bridge_algos.run.seed.run_seed` makes of each seed."""
    return [run_seed(config, world, seed) for config, world, seed in worlds(configuration, seeds, fresh)]
