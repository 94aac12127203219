"""A comparison in a table and in sentences."""

from __future__ import annotations

import math
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction

from experiments.compare.comparison import Comparison, Row
from experiments.compare.ledger import false_word
from experiments.compare.theory_curves import Curve

_UNDECIDED = ("informative", "vacuous")

MEANINGS = {
    "informative": "informative",
    "vacuous": "vacuous",
    "violated": "VIOLATED",
    "below, not certified": "below some runs, not certified",
    "below, not about this run": "below, but not about this run",
    "rate": "a rate, no bound",
}


def table(comparison: Comparison) -> str:
    """One row a version of the theory, after the last round."""
    last = int(comparison.rounds[-1])
    rows = [("after T rounds", "value", "value / regret", "holds w.p.", "verdict", "source")]
    rows.append(
        ("empirical regret, mean", _number(float(comparison.empirical.mean[-1])), "1", "", _band(comparison), "")
    )
    for row in comparison.rows:
        curve = row.curve
        verdict = "the yardstick" if curve.kind == "trivial" else MEANINGS[row.verdict]
        if not row.proved and row.verdict in _UNDECIDED:
            verdict += f", {false_word(row.ledger)} in general" if row.ledger else ", not proved"
        if curve.missing and row.verdict in _UNDECIDED:
            verdict += ", not about this run"
        value = _number(row.value) if curve.kind == "rate" else _bound(row.value)
        rows.append((curve.label, value, _number(row.ratio), _holds(curve), verdict, curve.source))
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    right = (False, True, True, True, False, False)
    lines = [
        "  ".join(cell.rjust(w) if r else cell.ljust(w) for cell, w, r in zip(row, widths, right, strict=True)).rstrip()
        for row in rows
    ]
    seeds = comparison.empirical.seeds
    size = f"T = {last:,}, {seeds} seed{'s' if seeds > 1 else ''}"
    head = f"{comparison.run}, {comparison.algorithm}: {size}, units of utility <phi, w*>"
    return "\n".join([head, *lines])


def words(comparison: Comparison) -> str:
    """What the picture shows, in sentences."""
    sentences = [_empirical_sentence(comparison)]
    informative = [row for row in comparison.rows if row.verdict == "informative"]
    best = min(
        (row for row in informative if row.proved and not row.curve.missing), key=lambda row: row.value, default=None
    )
    if best is None:
        sentences.append(
            f"No proved bound that is about this run is better than the trivial {_number(comparison.trivial)}."
        )
    else:
        sentences.append(
            f"The best proved bound that is about this run is '{best.curve.label}' ({best.curve.source}) with "
            f"{_bound(best.value)}, {_number(best.ratio)} times the regret; trivial is {_number(comparison.trivial)}."
        )
    sentences += [sentence for row in comparison.rows if (sentence := _row_sentence(comparison, row))]
    sentences += _for_scale([row for row in comparison.rows if row.curve.missing and row.verdict in _UNDECIDED])
    sentences += [f"'{item.label}' is left out: {item.reason.rstrip('.')}." for item in comparison.left_out]
    if any(row.ledger is None for row in comparison.rows):
        sentences.append(
            "Which of the stated bounds are false in general is not told here: the ledger needs pip install "
            "'bridge-rl[checks]'."
        )
    shown = ", ".join(f"{name} = {value}" for name, value in comparison.setting.items())
    sentences.append(f"Settings: {shown}; each event of a bound may fail with probability delta.")
    return " ".join(sentences)


def _empirical_sentence(comparison: Comparison) -> str:
    empirical, last = comparison.empirical, int(comparison.rounds[-1])
    start = f"After T = {last:,} rounds on {comparison.environment} {comparison.algorithm} has"
    mean = _number(float(empirical.mean[-1]))
    if empirical.replay is not None:
        return (
            f"{start} the pseudo-regret {mean}. The regret is deterministic, so that there is no band: the ledger's "
            f"exact replay '{empirical.replay.counterexample}' proves that it is {empirical.replay.regret} whatever is "
            "answered."
        )
    if empirical.lower is None or empirical.upper is None:
        return f"{start} the pseudo-regret {mean} in the one seed that was run, which says nothing about other seeds."
    return (
        f"{start} the mean pseudo-regret {mean} over {empirical.seeds} seeds, 95 % confidence sequence "
        f"{_interval(float(empirical.lower[-1]), float(empirical.upper[-1]))} for its expectation: at each "
        "round it holds for every number of seeds at once, so that seeds may be added after looking; it is not "
        "simultaneous over rounds. The bounds are about single runs, not about the mean."
    )


def _row_sentence(comparison: Comparison, row: Row) -> str:
    label, missing = f"'{row.curve.label}' ({row.curve.source})", "; ".join(row.curve.missing)
    mean = float(comparison.empirical.mean[-1])
    if row.verdict == "violated" and comparison.empirical.replay is not None:
        since = f", certified from round {row.violated_from:,} on" if row.violated_from else ""
        return (
            f"{label} is violated: regret {_number(mean)} where {_bound(row.value)} is claimed, "
            f"{_number(1 / row.ratio)} times as much (the run is deterministic{since}).{_ledger(row)}"
        )
    if row.verdict == "violated":
        return (
            f"{label} is violated: {row.exceeded} of {comparison.empirical.seeds} seeds exceed it, hence at least a "
            f"share {_decimals(row.chance, ROUND_FLOOR)} of all runs with 95 % confidence, where "
            f"{_allowed(row)} is allowed."
            f"{_ledger(row)}"
        )
    if row.verdict == "below, not about this run":
        return (
            f"{label} lies below the regret, {_bound(row.value)} < {_number(mean)}, which refutes nothing: "
            f"{missing}.{_ledger(row)}"
        )
    if row.verdict == "below, not certified":
        return (
            f"{label} is exceeded by {row.exceeded} of {comparison.empirical.seeds} seeds; its failure probability "
            f"{_allowed(row)} allows that, or there are too few seeds to tell.{_ledger(row)}"
        )
    if row.curve.kind in ("stated", "stated-sums") and row.ledger:
        return f"{label} is not violated here, but {false_word(row.ledger)} in general.{_ledger(row)}"
    return ""


def _for_scale(rows: list[Row]) -> list[str]:
    """Which curves are drawn although they are not about the run, each reason once."""
    if not rows:
        return []
    shared = [reason for reason in rows[0].curve.missing if all(reason in row.curve.missing for row in rows)]
    names = ", ".join(f"'{row.curve.label}'" for row in rows)
    sentences = [f"Drawn for scale, but not about this run: {names}" + (f"; {'; '.join(shared)}." if shared else ".")]
    for row in rows:
        own = [reason for reason in row.curve.missing if reason not in shared]
        if own:
            sentences.append(f"'{row.curve.label}': {'; '.join(own)}.")
    return sentences


def _ledger(row: Row) -> str:
    return f" See the ledger: bridge-rl check --only {row.ledger}." if row.ledger else ""


def _holds(curve: Curve) -> str:
    if curve.failure is None:
        return ""
    claimed = "claimed " if curve.kind in ("stated", "stated-sums") else ""
    if curve.failure == 0:
        return f"{claimed}always"
    return f"{claimed}>= {_decimals(1 - _shortest(curve.failure), ROUND_FLOOR)}"


def _band(comparison: Comparison) -> str:
    empirical = comparison.empirical
    if empirical.replay is not None:
        return "deterministic"
    if empirical.lower is None or empirical.upper is None:
        return "one seed"
    return f"95 % CS {_interval(float(empirical.lower[-1]), float(empirical.upper[-1]))}"


def _number(value: float) -> str:
    if not math.isfinite(value):
        return "-"
    if abs(value) >= 1e7:
        return f"{value:.3e}"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.4g}" if abs(value) > 1e-9 else "0"


def _bound(value: float) -> str:
    """An upper bound, rounded up: what is printed is a bound too."""
    return f"{math.ceil(value):,}" if 1000 <= value < 1e7 else _decimals(value, ROUND_CEILING)


def _interval(low: float, high: float) -> str:
    """An interval, rounded outward; what is zero but for the rounding of regrets is zero."""
    return f"[{_decimals(low, ROUND_FLOOR) if abs(low) > 1e-9 else '0'}, {_decimals(high, ROUND_CEILING)}]"


def _allowed(row: Row) -> str:
    """The failure probability that a statement allows itself, rounded up."""
    return _decimals(_shortest(row.curve.failure or 0.0), ROUND_CEILING)


def _shortest(probability: float) -> Fraction:
    """The decimal that a sum of decimals is without its rounding: 3/20 for 0.15000000000000002."""
    return Fraction(f"{probability:.12g}")


def _decimals(value: float | Fraction, rounding: str) -> str:
    """Four significant digits, rounded in the direction in which the statement stays true."""
    if not math.isfinite(value):
        return "-"
    context = Context(prec=4, rounding=rounding)
    return f"{float(context.divide(*map(Decimal, value.as_integer_ratio()))):.4g}"
