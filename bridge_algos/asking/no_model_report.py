"""What a study without a model of utility found, in numbers, a table and sentences."""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np

from bridge_algos.asking.config import AskConfig

VERDICTS = ("certified", "no winner", "contradicted", "open")


def summary(outcomes: list[dict[str, Any]]) -> dict[str, Any]:
    """Counts of verdicts and the median of the questions; a session that is not decided counts as infinite."""
    questions = np.array([inf if row["questions"] is None else row["questions"] for row in outcomes])
    median = float(np.quantile(questions, 0.5, method="higher"))
    counts = {name.replace(" ", "_"): sum(row["verdict"] == name for row in outcomes) for name in VERDICTS}
    return {"model": "none", "median_questions": median if np.isfinite(median) else None, **counts, "seeds": outcomes}


def table(outcomes: list[dict[str, Any]]) -> str:
    """One line a seed."""
    lines = [
        f"{'seed':>4} {'verdict':>12} {'questions':>9} {'preferred >=':>12} {'truth, about':>12} {'candidates':>10}"
    ]
    for row in outcomes:
        asked = "-" if row["questions"] is None else str(row["questions"])
        level = "-" if row["certified_preference"] is None else f"{row['certified_preference']:.3f}"
        estimate = row["true_preference_estimate"]
        truth = "-" if estimate is None else f"{estimate:.3f}"
        lines.append(
            f"{row['seed']:>4} {row['verdict']:>12} {asked:>9} {level:>12} {truth:>12} {row['candidates']:>10}"
        )
    return "\n".join(lines)


def in_words(config: AskConfig, eps: float, found: dict[str, Any]) -> str:
    """The summary in sentences."""
    median = found["median_questions"]
    asked = f"more than {config.max_questions}" if median is None else f"{median:.0f}"
    return (
        f"In {found['certified']} of {len(found['seeds'])} sessions a policy is certified to be preferred to every "
        f"other candidate with probability at least {0.5 - eps:.4g}; in {found['no_winner']} there is no winner at "
        f"eps = {eps:g}; {found['contradicted']} contradict steady preferences; {found['open']} end undecided. The "
        f"median needs {asked} questions. This is no statement about utilities: a policy may be best on average and "
        "lose most comparisons."
    )
