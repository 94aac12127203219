"""A campaign: how often teachers who do not follow the model are refuted, and certified before.

``python -m experiments.wrong_teachers`` runs it (about half an hour) and writes
``experiments/data/wrong_teachers.json``; with ``--show`` it prints the stored table.
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

STORED = Path(__file__).parent / "data" / "wrong_teachers.json"

HONEST, SEEDS = 1000, 100
"""Seeds of the teacher who follows the model, and of each other one."""

SETTINGS = {"utility_range": 5.0, "n_demonstrations": 2, "until": "10%", "max_questions": 150, "pool": 200}

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


def campaign() -> dict[str, Any]:
    """Everything that is stored, teacher by teacher."""
    mdp, found = make_mdp("starmdp"), []
    for name in TEACHERS:
        verdicts = wrong_teacher(name, mdp, HONEST if name == "follows the model" else SEEDS, **SETTINGS)  # type: ignore[arg-type]
        row = asdict(verdicts)
        row["median_questions"] = row["median_questions"] if isfinite(row["median_questions"]) else None
        found.append(row)
        print(verdicts.sentence, flush=True)
    cycles = []
    for shape, features in SHAPES.items():
        ends = [three_items(features, seed) for seed in range(SEEDS)]
        quick = sum(word == "refuted" and asked <= 50 for word, asked in ends)
        counts = {word: sum(one == word for one, _ in ends) for word in ("refuted", "certified", "open")}
        cycles.append({"shape": shape, **counts, "refuted_within_50": quick, "sessions": SEEDS})
        print(cycles[-1], flush=True)
    return {"environment": "starmdp", "settings": SETTINGS, "teachers": found, "three_items": cycles}


def table(stored: dict[str, Any]) -> str:
    """The campaign in words."""
    lines = [
        f"{'teacher':<32} {'sessions':>8} {'refuted':>8} {'certified':>9} {'wrongly':>8} {'open':>5} {'median':>7}"
    ]
    for row in stored["teachers"]:
        median = "-" if row["median_questions"] is None else f"{row['median_questions']:.0f}"
        open_ = row["sessions"] - row["refuted"] - row["certified"]
        lines.append(
            f"{row['teacher']:<32} {row['sessions']:>8} {row['refuted']:>8} {row['certified']:>9} {row['wrong']:>8} "
            f"{open_:>5} {median:>7}"
        )
    lines += [
        f"three items in a cycle, {row['shape']}: {row['refuted']} of {row['sessions']} refuted, "
        f"{row['refuted_within_50']} within 50 answers; {row['certified']} certified before"
        for row in stored["three_items"]
    ]
    honest = stored["teachers"][0]
    chance = binomtest(honest["refuted"], honest["sessions"], DELTA_MODEL, alternative="greater").pvalue
    lines.append(
        f"delta_M = {DELTA_MODEL:g}: if it were attained, so many refuted who follow the model, or more, would have "
        f"probability {chance:.2g}"
    )
    return "\n".join(lines)


def main(argv: list[str]) -> int:
    """Run, or show what is stored."""
    if argv != ["--show"]:
        atomic_write_text(STORED, json.dumps(campaign(), indent=1) + "\n")
    print(table(json.loads(STORED.read_text())))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
