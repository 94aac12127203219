"""The ledger as a table for the terminal, coloured where somebody is looking."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from proofs_checks.claim import MEANING as VERDICT_MEANING
from proofs_checks.claim import Verdict
from proofs_checks.evidence import STRENGTH, Kind
from proofs_checks.standing import Standing

_HEADER = ("label", "name", "verdict", "weakest link", "seconds", "repaired by")
_NARROW = 110
"""Narrower terminals do without the last column."""
_GREEN, _RED, _YELLOW, _GREY, _BOLD = "32", "31", "33", "90", "1"
_VERDICT_COLOUR = {"true": _GREEN, "true, proof wrong": _YELLOW, "false": _RED, "undefined": _RED, "open": _YELLOW}


def table(standings: Sequence[Standing], *, width: int | None, colour: bool) -> str:
    """One line per claim; labels are cut so that lines fit into ``width`` characters (None: no limit)."""
    shown = slice(None, -1 if width is not None and width < _NARROW else None)
    header, rows = _HEADER[shown], [_cells(item)[shown] for item in standings]
    widths = [max(len(row[column]) for row in (header, *rows)) for column in range(len(header))]
    if width is not None:
        for column, least in ((5, 12), (0, 28), (1, 20), (0, 14), (1, 16)):  # what to shorten first, and how far
            excess = sum(widths) + 2 * (len(widths) - 1) - width
            if column < len(widths):
                widths[column] = max(min(least, widths[column]), widths[column] - max(0, excess))
    lines = [_line(header, widths, [_BOLD] * len(header) if colour else None)]
    for item, row in zip(standings, rows, strict=True):
        lines.append(_line(row, widths, _colours(item)[shown] if colour else None))
    return "\n".join(lines)


def closing(standings: Sequence[Standing], *, rejected: int, planted: int, seconds: float, colour: bool) -> str:
    """Counts by verdict and weakest link, what could not be supported, the mutants, and every problem in full."""
    lines = [f"{len(standings)} claims, with the weakest link of each:"]
    lines += [f"  {line}" for line in verdict_lines((item.claim.verdict, item.weakest) for item in standings)]
    if unsupported := [item.claim.key for item in standings if item.unsupported]:
        lines.append(f"without evidence in this run (skipped or not quick): {', '.join(unsupported)}")
    if planted:
        lines.append(f"mutants: {rejected} of {planted} rejected")
    problems = list(dict.fromkeys(text for item in standings for text in item.problems))
    lines += [_painted(f"PROBLEM {text}", _RED, colour) for text in problems]
    verdict = f"{len(problems)} problems" if problems else "everything that should hold holds"
    lines.append(_painted(f"{verdict}; {seconds:.0f} s", _RED if problems else _GREEN, colour))
    return "\n".join(lines)


def verdict_lines(pairs: Iterable[tuple[Verdict, Kind | None]]) -> list[str]:
    """One line a verdict: how many claims have it, and how many of these reach how far at their weakest link.

    >>> verdict_lines([("true", "proved"), ("true", "text"), ("definition", None)])
    ['2 true (1 proved, 1 text)', '1 definition']
    """
    counts = Counter(pairs)
    lines = []
    for verdict in VERDICT_MEANING:
        total = sum(number for (word, _), number in counts.items() if word == verdict)
        shown = ", ".join(f"{counts[verdict, kind]} {kind}" for kind in STRENGTH if counts[verdict, kind])
        lines += [f"{total} {verdict}" + (f" ({shown})" if shown not in ("", f"{total} {verdict}") else "")] * (
            total > 0
        )
    return lines


def _cells(item: Standing) -> tuple[str, ...]:
    shown: str = "PROBLEM" if item.problems else item.weakest or ("not run" if item.unsupported else "-")
    repaired = ", ".join(f"{name}: {_short(kind)}" for name, kind in item.repaired)
    claim = item.claim
    return (claim.key, claim.name, claim.verdict, shown, f"{item.seconds:.2f}", repaired or "-")


def _short(kind: Kind | None) -> str:
    return "not run" if kind is None else kind.removesuffix(" on instances")


def _colours(item: Standing) -> list[str]:
    evidence = _RED if item.problems else _YELLOW if item.unsupported else _GREEN if item.weakest else _GREY
    return ["", "", _VERDICT_COLOUR.get(item.claim.verdict, _GREY), evidence, _GREY, _GREY]


def _line(cells: Sequence[str], widths: Sequence[int], colours: Sequence[str] | None) -> str:
    fitted = []
    for column, (cell, width) in enumerate(zip(cells, widths, strict=True)):
        text = cell if len(cell) <= width else cell[: width - 1] + "…"
        text = text.rjust(width) if _HEADER[column] == "seconds" else text.ljust(width)
        fitted.append(_painted(text, colours[column], True) if colours and colours[column] else text)
    return "  ".join(fitted).rstrip()


def _painted(text: str, colour_code: str, colour: bool) -> str:
    return f"\033[{colour_code}m{text}\033[0m" if colour else text
