"""A campaign: how many questions certify a recommendation, setting by setting, and how often a certificate is wrong.

``python -m experiments.asking_campaign [SETTING ...]`` runs what is missing, seed by seed, and writes
``experiments/data/asking_campaign.json`` after each; with ``--show`` it prints the stored table.
"""

from __future__ import annotations

import json
import sys
from math import inf, isfinite
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.study import prepare, run_session
from bridge_algos.files import atomic_write_text
from bridge_theory.errors import InputError

STORED = Path(__file__).parent / "data" / "asking_campaign.json"
DELTA = 0.05

SETTINGS: dict[str, tuple[dict[str, Any], int]] = {
    "StarMDP, range 5, n = 2": ({"environment": "starmdp"}, 100),
    "StarMDP, range 5, n = 1": ({"environment": "starmdp", "n_demonstrations": 1}, 100),
    "Gridworld, d = 16, range 5, n = 4": (
        {"environment": "gridworld", "embedding": "state_counts", "n_demonstrations": 4, "max_questions": 400},
        100,
    ),
    "StarMDP, BW = 5, n = 2": (
        {"environment": "starmdp", "utility_range": None, "weight_norm": 5.0, "max_questions": 3000},
        100,
    ),
    "StarMDP, BW = 1, n = 2": (
        {"environment": "starmdp", "utility_range": None, "weight_norm": 1.0, "max_questions": 4000},
        100,
    ),
}
"""Configurations of ``bridge-rl ask`` until 10 % of the range, delta = .05, and how many seeds of each."""

KEPT = ("questions", "certified_gap", "true_gap", "covered", "candidates")


def campaign(stored: dict[str, dict[str, Any]], names: list[str]) -> None:
    """Add the seeds that are missing, and store them one by one."""
    for name in names:
        if name not in SETTINGS:
            raise InputError(f"a setting must be one of {', '.join(map(repr, SETTINGS))}, got {name!r}.")
        entries, seeds = SETTINGS[name]
        config = AskConfig(**entries)
        world = prepare(config)
        part = stored.setdefault(name, {"configuration": config.record(), "sessions": []})
        for seed in range(len(part["sessions"]), seeds):
            outcome = run_session(config, *world, seed)["outcome"]
            part["sessions"].append({key: outcome[key] for key in KEPT})
            atomic_write_text(STORED, json.dumps(stored, indent=1) + "\n")


def row(part: dict[str, Any]) -> dict[str, Any]:
    """What a setting's sessions say; a session without a certificate counts as infinitely long."""
    sessions = part["sessions"]
    asked = np.array([inf if one["questions"] is None else one["questions"] for one in sessions])
    several = asked[np.array([one["candidates"] > 1 for one in sessions])]
    wrong = [one["questions"] is not None and one["true_gap"] > one["certified_gap"] + 1e-9 for one in sessions]
    outside = [not one["covered"] for one in sessions]
    chances = [binomtest(sum(each), len(each), DELTA, alternative="greater").pvalue for each in (outside, wrong)]
    return {
        "seeds": len(sessions),
        "median": float(np.quantile(asked, 0.5, method="higher")),
        "quantile_90": float(np.quantile(asked, 0.9, method="higher")),
        "median_where_something_is_open": float(np.quantile(several, 0.5, method="higher")),
        "one_candidate": len(asked) - len(several),
        "outside": sum(outside),
        "wrong": sum(wrong),
        "chance": min(chances),
    }


def table(stored: dict[str, dict[str, Any]]) -> str:
    """The campaign, a line each setting."""
    lines = [
        f"{'setting':<36} {'seeds':>5} {'median':>6} {'90 %':>6} {'open only':>9} {'w* left C_t':>11} {'wrong':>5}",
    ]
    for name, part in stored.items():
        found = row(part)
        asked = (
            f"{found[key]:.0f}" if isfinite(found[key]) else f"> {part['configuration']['max_questions']}"
            for key in ("median", "quantile_90", "median_where_something_is_open")
        )
        median, most, several = asked
        lines.append(
            f"{name:<36} {found['seeds']:>5} {median:>6} {most:>6} {several:>9} {found['outside']:>11} "
            f"{found['wrong']:>5}"
        )
    lines.append("open only: sessions with more than one candidate; w* may leave C_t with probability 5 % a session")
    return "\n".join(lines)


def main(argv: list[str]) -> int:
    """Run, or show what is stored."""
    stored = json.loads(STORED.read_text()) if STORED.exists() else {}
    if argv != ["--show"]:
        campaign(stored, argv or list(SETTINGS))
    print(table(stored))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
