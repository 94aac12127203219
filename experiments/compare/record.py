"""A comparison as plain JSON data: everything that the figure and the table show."""

from __future__ import annotations

import math
from typing import Any

from bridge_algos.mdp import FloatArray
from experiments.compare.comparison import Comparison, Row


def record(comparison: Comparison) -> dict[str, Any]:
    """Names, units, curves, verdicts; a number that is not finite becomes null."""
    empirical, replay = comparison.empirical, comparison.empirical.replay
    return {
        "run": comparison.run,
        "environment": comparison.environment,
        "algorithm": comparison.algorithm,
        "units": "utility <phi, w*>",
        "setting": dict(comparison.setting),
        "rounds": comparison.rounds.tolist(),
        "trivial": comparison.trivial,
        "empirical": {
            "seeds": empirical.seeds,
            "mean": _list(empirical.mean),
            "confidence_sequence": None
            if empirical.lower is None or empirical.upper is None
            else {"level": 0.95, "lower": _list(empirical.lower), "upper": _list(empirical.upper)},
            "deterministic": None
            if replay is None
            else {"counterexample": replay.counterexample, "label": replay.label, "regret": str(replay.regret)},
        },
        "versions": [_row(row) for row in comparison.rows],
        "left_out": [{"label": item.label, "reason": item.reason} for item in comparison.left_out],
    }


def _row(row: Row) -> dict[str, Any]:
    return {
        "kind": row.curve.kind,
        "label": row.curve.label,
        "source": row.curve.source,
        "formula": row.curve.formula,
        "failure": row.curve.failure,
        "missing": list(row.curve.missing),
        "mean": _list(row.curve.mean),
        "value": _number(row.value),
        "ratio": _number(row.ratio),
        "verdict": row.verdict,
        "exceeded": row.exceeded,
        "chance": row.chance,
        "ledger": row.ledger,
        "proved": row.proved,
        "violated_from": row.violated_from,
    }


def _list(values: FloatArray) -> list[float | None]:
    return [_number(float(value)) for value in values]


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
