"""Numbers of questions over simulated sessions, some of which end without a certificate, summarised and drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from experiments.intervals import median_interval


@dataclass(frozen=True)
class Asked:
    """Quantiles of the questions until a certificate; infinite where too many sessions had none.

    Args:
        median, low, high: the median and its 95 % interval from order statistics.
        tenth, ninetieth: 10 % and 90 % quantiles.
        certified, sessions: how many sessions had a certificate, of how many.
    """

    median: float
    low: float
    high: float
    tenth: float
    ninetieth: float
    certified: int
    sessions: int


def asked(questions: ArrayLike) -> Asked:
    """Summarise sessions; a session without a certificate is infinite, or NaN.

    >>> asked([0, 3, 5, np.nan, 9]).median, asked([4, np.inf, np.inf]).median
    (5.0, inf)
    """
    values = np.asarray(questions, dtype=np.float64)
    values = np.sort(np.where(np.isnan(values), np.inf, values))
    tenth, median, ninetieth = (float(np.quantile(values, q, method="higher")) for q in (0.1, 0.5, 0.9))
    low, high = median_interval(values)
    return Asked(median, low, high, tenth, ninetieth, int(np.isfinite(values).sum()), len(values))


def count_text(value: float, most: int) -> str:
    """A number of questions in words, where sessions end after ``most``.

    >>> count_text(12, 300), count_text(np.inf, 300)
    ('12', 'more than 300')
    """
    return f"{value:.0f}" if np.isfinite(value) else f"more than {most}"


def interval_text(one: Asked, most: int) -> str:
    """The interval of the median in words.

    >>> interval_text(asked([3] * 20), 300), interval_text(asked([3, 5]), 300), interval_text(asked([np.inf] * 20), 300)
    ('3 to 3', '0 to no limit', 'more than 300')
    """
    if not np.isfinite(one.low):
        return count_text(one.low, most)
    return f"{one.low:.0f} to {one.high:.0f}" if np.isfinite(one.high) else f"{one.low:.0f} to no limit"


def wanted(until: str) -> str:
    """What a session asks for, in words.

    >>> wanted("10%"), wanted("0.2nats"), wanted("share=90%")
    ('a gap of 10 % of the range is certified', 'a gap of 0.2 nats is certified', '90 % of the gain is certified')
    """
    number = until.removeprefix("share=").strip()
    amount = number.removesuffix("%").removesuffix("nats").strip()
    if number != until.strip():
        return f"{amount} % of the gain is certified"
    return f"a gap of {amount} {'% of the range' if number.endswith('%') else 'nats'} is certified"


def censored_level(most: int) -> float:
    """Where a figure shows what needs more than ``most`` questions."""
    return 1.08 * most


def draw_axes(axes: Any, demonstrations: list[int], most: int, until: str) -> None:
    """One place for each number of demonstrations, and a strip above for sessions without a certificate."""
    axes.axhspan(1.03 * most, 1.13 * most, color="#eeeeee", linewidth=0)
    ticks = np.unique(np.linspace(0, most, 6).round().astype(np.int64))
    axes.set_yticks([*ticks, censored_level(most)], [*(str(tick) for tick in ticks), f"> {most}"])
    axes.set_xticks(range(len(demonstrations)), [str(n) for n in demonstrations])
    axes.set(xlim=(-0.5, len(demonstrations) - 0.5), ylim=(-0.03 * most, 1.13 * most))
    axes.set(xlabel="demonstrations", ylabel=f"questions until {wanted(until)}")


def draw_medians(axes: Any, places: ArrayLike, summaries: list[Asked], most: int, style: dict[str, Any]) -> None:
    """Medians joined by a line, with bars from the 10 % to the 90 % quantile; hollow where the median is censored."""

    def shown(values: list[float]) -> np.ndarray:
        return np.where(np.isfinite(values), values, censored_level(most))

    x, middle = np.asarray(places, dtype=np.float64), shown([s.median for s in summaries])
    axes.vlines(
        x,
        shown([s.tenth for s in summaries]),
        shown([s.ninetieth for s in summaries]),
        color=style["color"],
        linewidth=1.6,
        alpha=0.45,
    )
    hollow = ~np.isfinite([s.median for s in summaries])
    axes.plot(x, middle, **{"linewidth": 1.2, "marker": "o", "markersize": 5, **style})
    axes.plot(x[hollow], middle[hollow], "o", color=style["color"], markerfacecolor="white", markersize=5, zorder=3)
