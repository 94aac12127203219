"""The authors' published curves, as data, and how ours lie beside them."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.run.plots import STYLES, draw_band
from bridge_algos.run.summary import cumulative, mean_over_seeds

ALGORITHMS = ("bridge", "pbrl")


def published_curves(environment: str) -> dict[str, Any] | None:
    """Published means and 95 % half-widths of an environment (``"starmdp"``), or None where none were published."""
    text = files("experiments").joinpath("data/published_curves.json").read_text()
    curves: dict[str, Any] = {name.lower(): value for name, value in json.loads(text).items() if name != "source"}
    return curves.get(environment)


def draw_beside(axes_regret: Any, axes_size: Any, curves: dict[str, Any]) -> None:
    """Add the published curves, dashed, in the colours of ours."""
    rounds = np.arange(1, curves["rounds"] + 1)
    for axes, key, floor in ((axes_regret, "cumulative_regret", None), (axes_size, "policy_set_size", 1)):
        for name in ALGORITHMS:
            style = {
                "color": STYLES[name]["color"],
                "linestyle": "--",
                "linewidth": 1.2,
                "label": f"{STYLES[name]['label']}, published",
            }
            curve = curves[name][key]
            draw_band(axes, rounds, np.array(curve["mean"]), np.array(curve["ci95_half_width"]), style, floor)


def comparison_text(results: xr.Dataset, curves: dict[str, Any]) -> str:
    """Ours against theirs after the last round, in words: do the 95 % intervals overlap?"""
    lines = []
    for name in ALGORITHMS:
        for label, key, values in (
            ("cumulative regret", "cumulative_regret", cumulative(results, "suboptimality", name)),
            ("|Pi_t|", "policy_set_size", np.asarray(results.set_size.sel(algorithm=name).transpose("seed", "round"))),
        ):
            theirs, their_half = curves[name][key]["mean"][-1], curves[name][key]["ci95_half_width"][-1]
            mean, half = mean_over_seeds(values[:, -1])
            overlap = abs(mean - theirs) <= half + their_half
            lines.append(
                f"{STYLES[name]['label']}, last {label}: published {theirs:.2f} ± {their_half:.2f}, "
                f"ours {mean:.2f} ± {half:.2f}; the 95 % intervals {'overlap' if overlap else 'do not overlap'}."
            )
    lines.append(
        f"Expert's return: published {curves['expert_return']:.2f} (simulated), "
        f"ours {results.attrs['expert_return']:.2f} (exact)."
    )
    return "\n".join(lines)
