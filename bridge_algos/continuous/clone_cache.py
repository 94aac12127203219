"""A fitted clone kept on disk by content: runs that clone the same demonstrations in the same way fit once."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.continuous.cloning import Clone, Statistics, clone
from bridge_algos.continuous.episodes import Episodes, episodes_digest
from bridge_algos.continuous.experts import expert_card
from bridge_algos.continuous.policy_files import load_policy, save_policy
from bridge_algos.run.versions import package_versions
from bridge_theory.errors import InputError

FORMAT = 3
"""Changes whenever the definition of the fit or of the card does."""
CURVES = ("likelihood", "validation")


def cached_clone(
    cache: Path | None,
    demonstrations: Episodes,
    rng: np.random.Generator,
    validation: Episodes | None,
    statistics: Statistics | None,
    settings: dict[str, Any],
) -> Clone:
    """What :func:`bridge_algos.continuous.cloning.clone` returns, read from ``cache`` where it holds that fit.

    Args:
        cache: directory; None keeps nothing.
        rng: its state is part of the content; it advances only where the fit is made anew.
        validation, statistics, settings: the other arguments of the fit.
    """
    if cache is None:
        return clone(demonstrations, rng, validation=validation, statistics=statistics, **settings)
    versions = package_versions()
    identity = {
        "format": FORMAT,
        "demonstrations": episodes_digest(demonstrations),
        "validation": None if validation is None else episodes_digest(validation),
        "generator": str(rng.bit_generator.state),
        "settings": settings | {"statistics": statistics and [part.tolist() for part in statistics]},
        "versions": {name: versions[name] for name in ("torch", "numpy")},
    }
    name = hashlib.sha256(json.dumps(identity, sort_keys=True).encode()).hexdigest()[:32]
    path = cache / "clones" / f"{name}.safetensors"
    if not (path.exists() and path.with_suffix(".json").exists()):  # a killed run leaves one, and so may a clean-up
        fitted = clone(demonstrations, rng, validation=validation, statistics=statistics, **settings)
        kept = {name: getattr(fitted, name).tolist() for name in CURVES}
        save_policy(path, fitted.policy, {"made of": identity, "policy": fitted.policy.digest(), **kept})
        return fitted
    damaged = InputError(
        f"{path} and its card do not hold what was kept there; delete both, so that it is fitted again."
    )
    try:
        card, policy = expert_card(path), load_policy(path)
    except InputError:
        raise damaged from None
    curves = [np.asarray(card.get(name, ()), dtype=object) for name in CURVES]
    known = card.get("made of") == json.loads(json.dumps(identity)) and card.get("policy") == policy.digest()
    if not known or any(curve.shape != (settings["epochs"],) for curve in curves):
        raise damaged
    return Clone(policy, *(curve.astype(np.float64) for curve in curves))
