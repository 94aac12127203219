"""Counterexamples that are small MDPs, drawn as transition diagrams in SVG."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

from proofs_checks.html.names import plain

_COLUMN, _ROW, _RADIUS, _MARGIN = 190, 92, 22, 46
_LARGEST = 9
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
    states, kernels = data["states"], data["kernels"]
    edges = _edges(kernels, _action_names(data), len(states))
    layers = _layers([s for s, p in enumerate(data["initial"]) if _positive(p)], edges, len(states))
    places = _places(layers)
    resting = {edge.source for edge in edges if edge.source == edge.target and not edge.labels}
    parts = [_arrow(edge, places, edges) for edge in edges if edge.source != edge.target]
    parts += [_loop(places[edge.source], edge.labels) for edge in edges if edge.source == edge.target and edge.labels]
    for s, name in enumerate(states):
        x, y = places[s]
        ring = f'<circle class="ring" cx="{x:g}" cy="{y:g}" r="{_RADIUS - 4}"/>' if s in resting else ""
        parts.append(f'<circle class="state" cx="{x:g}" cy="{y:g}" r="{_RADIUS}"/>{ring}')
        parts.append(_text((x, y + 5), [plain(name)], "name"))
        if _positive(data["initial"][s]):
            share = "" if str(data["initial"][s]) == "1" else str(data["initial"][s])
            parts.append(f'<path class="edge" d="M{x - 56:g} {y:g} H{x - _RADIUS - 3:g}"/>')
            parts.append(_text((x - 44, y - 7), [share], "label"))
    width = max(x for x, _ in places.values()) + _MARGIN + 20
    height = max(y for _, y in places.values()) + _MARGIN
    legend = " ".join([f"{plain(n)}" for n in kernels])
    return (
        f'<svg class="diagram" viewBox="0 0 {width:g} {height:g}" width="{width:g}" role="img" '
        f'aria-label="transition diagram with {len(states)} states, kernels {escape(legend)}">'
        '<defs><marker id="head" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" '
        'orient="auto-start-reverse"><path class="head" d="M0 0 L10 5 L0 10 z"/></marker></defs>'
        f"{''.join(parts)}</svg>"
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
        return [f"{prefix}{plain(name)} {chance}" for name, chance in zip(kernels, chances, strict=True)]
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
        s: (_MARGIN + 34 + _COLUMN * column, _MARGIN + _ROW * (row + (tallest - len(layer)) / 2))
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
    at = 0.56  # nearer to the target, where arrows from one state have parted
    label = tuple(
        (1 - at) ** 2 * p + 2 * at * (1 - at) * c + at**2 * q for p, c, q in zip(start, (cx, cy), end, strict=True)
    )
    path = f'<path class="edge" d="M{start[0]:.1f} {start[1]:.1f} Q{cx:.1f} {cy:.1f} {end[0]:.1f} {end[1]:.1f}"/>'
    return path + _text((label[0], label[1] - _LINE * (len(edge.labels) - 1) / 2 + 4), edge.labels, "label")


def _loop(place: Point, labels: Sequence[str]) -> str:
    x, y = place
    path = f'<path class="edge" d="M{x - 11:g} {y - 19:g} C{x - 30:g} {y - 54:g} {x + 30:g} {y - 54:g} {x + 11:g} {y - 20:g}"/>'
    return path + _text((x + 26, y - 34 - _LINE * (len(labels) - 1) / 2), labels, "label beside")


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
