"""Counterexamples that are small MDPs, drawn as transition diagrams in SVG."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

from proofs_checks.html.names import plain

_COLUMN, _ROW, _RADIUS, _MARGIN = 200, 96, 22, 62
_LARGEST = 9
_SPARE = 22
"""Room around the states that is only needed where there are loops."""
_LINE = 15

Point = tuple[float, float]


@dataclass(frozen=True)
class Edge:
    """An arrow from one state to another with one line of text for each way to take it."""

    source: int
    target: int
    labels: tuple[str, ...]


def drawable(data: Mapping[str, Any]) -> bool:
    """Whether the instance is an MDP small enough to be drawn."""
    return {"states", "initial", "kernels"} <= set(data) and len(data["states"]) <= _LARGEST


def diagram(data: Mapping[str, Any]) -> str:
    """The states in layers by distance from the start, an arrow for every possible transition."""
    states, kernels, initial = data["states"], data["kernels"], data["initial"]
    edges = _edges(kernels, _action_names(data), len(states))
    layers = _layers([s for s, p in enumerate(initial) if _positive(p)], edges, len(states))
    places = _places(layers)
    loops = [edge for edge in edges if edge.source == edge.target and edge.labels]
    lowest = {layer[-1] for layer in layers if len(layer) > 1}
    resting = {edge.source for edge in edges if edge.source == edge.target and not edge.labels}
    parts = [_arrow(edge, places, edges) for edge in edges if edge.source != edge.target]
    parts += [_loop(places[edge.source], edge.labels, -1 if edge.source in lowest else 1) for edge in loops]
    for s, name in enumerate(states):
        parts.append(_state(places[s], plain(name), resting=s in resting))
        if _positive(initial[s]):
            parts.append(_entrance(places[s], "" if str(initial[s]) == "1" else str(initial[s])))
    width = max(x for x, _ in places.values()) + _MARGIN + 30
    above, below = (
        max((_LINE * len(edge.labels) for edge in loops if (edge.source in lowest) == low), default=-_SPARE)
        for low in (False, True)
    )
    height = max(y for _, y in places.values()) + _MARGIN + above + below
    described = f"transition diagram with {len(states)} states, kernels {', '.join(map(plain, kernels))}"
    return (
        f'<svg class="diagram" viewBox="0 {-above:g} {width:g} {height:g}" width="{width:g}" role="img" '
        f'aria-label="{escape(described)}"><defs><marker id="head" viewBox="0 0 10 10" refX="9" refY="5" '
        'markerWidth="7" markerHeight="7" orient="auto-start-reverse"><path class="head" d="M0 0 L10 5 L0 10 z"/>'
        f"</marker></defs>{''.join(parts)}</svg>"
    )


def _edges(kernels: Mapping[str, Any], actions: Sequence[str], n_states: int) -> list[Edge]:
    found: dict[tuple[int, int], list[str]] = {}
    for s in range(n_states):
        rows = {name: [tuple(map(str, row)) for row in table[s]] for name, table in kernels.items()}
        choices = list(zip(*rows.values(), strict=True))  # per action, its row under each kernel
        matters = len(set(choices)) > 1
        for choice in dict.fromkeys(choices):
            named = "" if not matters else ",".join(a for a, c in zip(actions, choices, strict=True) if c == choice)
            for target in range(n_states):
                chances = [row[target] for row in choice]
                if any(map(_positive, chances)):
                    found.setdefault((s, target), []).extend(_labels(named, list(kernels), chances))
    return [Edge(s, target, tuple(labels)) for (s, target), labels in found.items()]


def _labels(action: str, kernels: list[str], chances: list[str]) -> list[str]:
    prefix = f"{action}: " if action else ""
    if len(set(chances)) > 1:
        named = zip(kernels, chances, strict=True)
        return [f"{prefix}{plain(name)} {chance}" for name, chance in named if _positive(chance)]
    return [f"{prefix}{chances[0]}"] if chances[0] != "1" else [action] if action else []


def _action_names(data: Mapping[str, Any]) -> list[str]:
    count = len(next(iter(data["kernels"].values()))[0])
    return [plain(name) for name in data.get("actions", [f"a_{i}" for i in range(count)])]


def _layers(start: list[int], edges: list[Edge], n_states: int) -> list[list[int]]:
    layers, seen = [start], set(start)
    while layers[-1]:
        following = dict.fromkeys(e.target for s in layers[-1] for e in edges if e.source == s and e.target not in seen)
        layers.append(list(following))
        seen |= set(following)
    return [*layers[:-1], rest] if (rest := [s for s in range(n_states) if s not in seen]) else layers[:-1]


def _places(layers: list[list[int]]) -> dict[int, Point]:
    tallest = max(map(len, layers))
    return {
        s: (_MARGIN + 10 + _COLUMN * column, _MARGIN + _ROW * (row + (tallest - len(layer)) / 2))
        for column, layer in enumerate(layers)
        for row, s in enumerate(layer)
    }


def _arrow(edge: Edge, places: Mapping[int, Point], edges: list[Edge]) -> str:
    (x1, y1), (x2, y2) = places[edge.source], places[edge.target]
    length = math.hypot(x2 - x1, y2 - y1)
    ux, uy = (x2 - x1) / length, (y2 - y1) / length
    both_ways = any((e.source, e.target) == (edge.target, edge.source) for e in edges)
    passes = any(_near(places[s], (x1, y1), (x2, y2)) for s in places if s not in (edge.source, edge.target))
    bend = 34 if both_ways else 0.35 * length if passes else 0
    cx, cy = (x1 + x2) / 2 + bend * uy, (y1 + y2) / 2 - bend * ux
    start, end = _rim((x1, y1), (cx, cy), _RADIUS), _rim((x2, y2), (cx, cy), _RADIUS + 2)
    at = 0.5 if both_ways else 0.56  # nearer to the target, where arrows from one state have parted
    x, y = ((1 - at) ** 2 * p + 2 * at * (1 - at) * c + at**2 * q for p, c, q in zip(start, (cx, cy), end, strict=True))
    rows = len(edge.labels)
    if abs(uy) > 0.9:  # a vertical arrow has its text beside it, on the outer side of its bend
        style, x, y = ("label beside", x + 6, y) if uy > 0 else ("label before", x - 6, y)
        y -= _LINE * (rows - 1) / 2 - 4
    else:  # otherwise above an arrow that rises or bends up, below one that falls
        style, below = "label", uy * ux > 0.05 if not both_ways else ux < 0
        y += 16 if below else -7 - _LINE * (rows - 1)
    path = f'<path class="edge" d="M{start[0]:.1f} {start[1]:.1f} Q{cx:.1f} {cy:.1f} {end[0]:.1f} {end[1]:.1f}"/>'
    return path + _text((x, y), edge.labels, style)


def _loop(place: Point, labels: Sequence[str], side: int) -> str:
    x, y = place
    curve = f"M{x - 11:g} {y - side * 19:g} C{x - 30:g} {y - side * 54:g} {x + 30:g} {y - side * 54:g}"
    end = y - 52 - _LINE * (len(labels) - 1) if side > 0 else y + 62
    return f'<path class="edge" d="{curve} {x + 11:g} {y - side * 20:g}"/>{_text((x, end), labels, "label")}'


def _state(place: Point, name: str, *, resting: bool) -> str:
    x, y = place
    ring = f'<circle class="ring" cx="{x:g}" cy="{y:g}" r="{_RADIUS - 4}"/>' if resting else ""
    text = _text((x, y + 5), [name], "name")
    return f'<circle class="state" cx="{x:g}" cy="{y:g}" r="{_RADIUS}"/>{ring}{text}'


def _entrance(place: Point, share: str) -> str:
    x, y = place
    path = f'<path class="edge" d="M{x - 56:g} {y:g} H{x - _RADIUS - 3:g}"/>'
    return path + _text((x - 44, y - 7), [share], "label")


def _near(place: Point, start: Point, end: Point) -> bool:
    (x, y), (x1, y1), (x2, y2) = place, start, end
    along = ((x - x1) * (x2 - x1) + (y - y1) * (y2 - y1)) / ((x2 - x1) ** 2 + (y2 - y1) ** 2)
    apart = math.hypot(x - x1 - along * (x2 - x1), y - y1 - along * (y2 - y1))
    return 0 < along < 1 and apart < _RADIUS + 6


def _rim(centre: Point, towards: Point, radius: float) -> Point:
    length = math.hypot(towards[0] - centre[0], towards[1] - centre[1])
    return (
        centre[0] + radius * (towards[0] - centre[0]) / length,
        centre[1] + radius * (towards[1] - centre[1]) / length,
    )


def _text(at: Point, lines: Sequence[str], style: str) -> str:
    rows = [line for line in lines if line]
    spans = "".join(
        f'<tspan x="{at[0]:.1f}" dy="{_LINE * (i > 0)}">{escape(row)}</tspan>' for i, row in enumerate(rows)
    )
    return f'<text class="{style}" x="{at[0]:.1f}" y="{at[1]:.1f}">{spans}</text>' if rows else ""


def _positive(chance: object) -> bool:
    return str(chance) != "0"
