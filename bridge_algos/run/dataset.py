"""One seed's records as a labelled data set, with units: the same for every kind of environment."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.mdp import FloatArray
from bridge_algos.online.loop import RECORDED
from bridge_algos.run.configuration import Configuration

UNITS = {
    "first": "index of a policy searched",
    "second": "index of a policy searched",
    "greedy": "index of a policy searched",
    "pseudo_regret": "reward per trajectory",
    "suboptimality": "reward per trajectory",
    "set_size": "policies",
    "optimum_kept": "1 = yes",
    "optimum_ruled_out": "1 = yes",
    "weight_error": "norm of w",
    "uncertainty": "norm of phi in the inverse data matrix",
    "bonus_sum": "utility",
    "gamma": "none",
    "log_det": "nats",
    "seconds": "s",
}

FORMAT = 3
"""Changes whenever a stored number gets another meaning: since 3 no policy is compared with itself while another one is
left."""

Records = dict[str, dict[str, FloatArray]]
Scalars = dict[str, tuple[float, str]]


def constant_record(rounds: int, suboptimality: float, pseudo_regret: float) -> dict[str, FloatArray]:
    """The record of playing one policy, the clone, for ever."""
    record = {name: np.full(rounds, np.nan) for name in RECORDED}
    record["suboptimality"][:] = suboptimality
    record["pseudo_regret"][:] = pseudo_regret
    record["set_size"][:] = 1
    return record


def seed_dataset(
    config: Configuration, seed: int, records: Records, scalars: Scalars, attributes: dict[str, Any]
) -> xr.Dataset:
    """A data set of one variable per name in ``RECORDED`` over (algorithm, round).

    Args:
        records: of each algorithm, one array (rounds,) per name.
        scalars: value and unit of each further number.
        attributes: besides title and configuration.
    """
    names = list(records)
    rounds = len(records[names[0]]["suboptimality"])
    variables: dict[str, Any] = {
        name: (("algorithm", "round"), np.stack([records[algorithm][name] for algorithm in names]), {"units": unit})
        for name, unit in UNITS.items()
    }
    variables |= {name: ((), value, {"units": unit}) for name, (value, unit) in scalars.items()}
    return xr.Dataset(
        variables,
        coords={"algorithm": names, "round": np.arange(1, rounds + 1), "seed": seed},
        attrs={
            "title": f"BRIDGE companion: {config.environment}, seed {seed}",
            "configuration": config.to_json(),
            "format": FORMAT,
            **attributes,
        },
    )
