"""A campaign: how often teachers who do not follow the model are refuted, and certified before.

``python -m experiments.wrong_teachers [SEEDS]`` runs what is missing (half an hour for 100 seeds each) and writes
``experiments/data/wrong_teachers.json`` after each teacher; with ``--show`` it prints the stored table.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from bridge_algos.asking.elicitation import Ball, Elicitation
from bridge_algos.asking.model_test import DELTA_MODEL
from bridge_algos.asking.wrong_teachers import TEACHERS, wrong_teacher
from bridge_algos.envs.registry import make_mdp
from bridge_algos.files import atomic_write_text

HONEST = "follows the model"
STORED = Path(__file__).parent / "data" / "wrong_teachers.json"

SEEDS = 100
"""Of each teacher; ten times as many of the one who follows the model."""

SETTINGS = {"utility_range": 5.0, "n_demonstrations": 2, "until": "10%", "max_questions": 100, "pool": 200}

SHAPES = {
    "corners": np.eye(3),
    "triangle": np.array([[1.0, 0.0], [-0.5, 0.866], [-0.5, -0.866]]),
    "nearly on a line": np.array([[0.0, 0.0], [1.0, 0.1], [2.0, 0.0]]),
}
"""Features of three items that are preferred in a cycle at .9."""


def three_items(features: np.ndarray, seed: int, asking: str = "pool") -> tuple[str, int]:
    """How a session about three items that are preferred in a cycle ends, and after how many questions."""
    rng = np.random.default_rng(seed)
    session = Elicitation(features, Ball(3.0), features, 0.05, "0.5nats", rng, fresh=True, asking=asking)
    while not session.done and len(session.history) < 200:
        question = session.ask()
        session.tell(question, int(rng.random() < (0.9 if (question.second - question.first) % 3 == 1 else 0.1)))
    word = "refuted" if session.contradicted else "certified" if session.certified else "open"
    return word, len(session.history)


def campaign(stored: dict[str, Any], seeds: int) -> None:
    """Add what is missing to what is stored, and store it, part by part."""
    mdp = make_mdp("starmdp")
    for shape, features in SHAPES.items():
        if shape not in stored["three_items"]:
            ends = [three_items(features, seed) for seed in range(seeds)]
            counts = {word: sum(one == word for one, _ in ends) for word in ("refuted", "certified", "open")}
            quick = sum(word == "refuted" and asked <= 50 for word, asked in ends)
            stored["three_items"][shape] = {**counts, "refuted_within_50": quick, "sessions": seeds}
            _store(stored)
    for name in reversed(TEACHERS):
        if name not in stored["teachers"]:
            sessions = 10 * seeds if name == HONEST else seeds
            found = wrong_teacher(name, mdp, sessions, **SETTINGS)  # type: ignore[arg-type]
            median = found.median_questions if isfinite(found.median_questions) else None
            stored["teachers"][name] = {**asdict(found), "median_questions": median}
            _store(stored)


def _store(stored: dict[str, Any]) -> None:
    atomic_write_text(STORED, json.dumps(stored, indent=1) + "\n")


def table(stored: dict[str, Any]) -> str:
    """The campaign in words."""
    lines = [
        f"{'teacher':<32} {'sessions':>8} {'refuted':>8} {'certified':>9} {'wrongly':>8} {'open':>5} {'median':>7}"
    ]
    for row in (stored["teachers"][name] for name in TEACHERS if name in stored["teachers"]):
        median = "-" if row["median_questions"] is None else f"{row['median_questions']:.0f}"
        open_ = row["sessions"] - row["refuted"] - row["certified"]
        lines.append(
            f"{row['teacher']:<32} {row['sessions']:>8} {row['refuted']:>8} {row['certified']:>9} {row['wrong']:>8} "
            f"{open_:>5} {median:>7}"
        )
    lines += [
        f"three items in a cycle, {shape}: {row['refuted']} of {row['sessions']} refuted, "
        f"{row['refuted_within_50']} within 50 answers; {row['certified']} certified before"
        for shape, row in stored["three_items"].items()
    ]
    honest = stored["teachers"].get(HONEST)
    if honest is not None:
        chance = binomtest(honest["refuted"], honest["sessions"], DELTA_MODEL, alternative="greater").pvalue
        lines.append(
            f"delta_M = {DELTA_MODEL:g}: if it were attained, so many or more refuted who follow the model would have "
            f"probability {chance:.2g}"
        )
    return "\n".join(lines)


def main(argv: list[str]) -> int:
    """Run, or show what is stored."""
    stored: dict[str, Any] = {"environment": "starmdp", "settings": SETTINGS, "teachers": {}, "three_items": {}}
    if STORED.exists():
        stored = json.loads(STORED.read_text())
    if argv != ["--show"]:
        campaign(stored, int(argv[0]) if argv else SEEDS)
    print(table(stored))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
