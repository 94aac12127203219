"""A stored counterexample on the page: what it violates, its diagram or numbers, and the controls that it is not."""

from __future__ import annotations

import json
from collections.abc import Mapping
from html import escape
from typing import Any

from proofs_checks.counterexample import Counterexample, Number, Side
from proofs_checks.html.diagram import diagram, drawable
from proofs_checks.html.mathml import mathml
from proofs_checks.html.names import plain
from proofs_checks.html.prose import line

_DRAWN = {"states", "actions", "initial", "kernels", "policies", "laws"}
_SIGN = {"<=": r"\le", ">=": r"\ge", "==": "=", "<": "<", ">": ">"}
_FALSE = {"<=": ">", ">=": "<", "==": r"\ne", "<": r"\ge", ">": r"\le"}


def instance(example: Counterexample) -> str:
    """The figure of one counterexample."""
    claimed = f"{example.left.latex} {_SIGN[example.relation]} {example.right.latex}"
    found = f"{_number(example.left)} {_FALSE[example.relation]} {_number(example.right)}"
    data = example.data
    parts = [diagram(data)] if drawable(data) else []
    parts += [_policies(data)] if {"states", "policies"} <= set(data) else []
    parts += [_laws(data["laws"])] if isinstance(data.get("laws"), Mapping) else []
    rest = {name: value for name, value in data.items() if name not in _DRAWN or not parts}
    parts += [_numbers(rest)] if rest else []
    controls = "; ".join(line(control.name) for control in example.controls)
    key = "An arrow without a number is certain; a state in a double circle is never left." if drawable(data) else ""
    return (
        f'<figure class="instance"><figcaption>{line(example.sentence)}'
        f'<div class="sides"><span>claimed</span>{mathml(claimed)}<span>here</span>{mathml(found)}</div></figcaption>'
        f'<div class="scroll">{"".join(parts)}</div>'
        f'<p class="quiet">{key} Not violated by the controls: {controls}. Stored as '
        f"<code>counterexamples/{escape(example.name)}.json</code>.{_command(data)}</p></figure>"
    )


def _command(data: Mapping[str, Any]) -> str:
    environment = data.get("environment")
    return f" To watch it: <code>bridge-rl compare {escape(environment)}</code>." if environment else ""


def _number(side: Side) -> str:
    value: Number = side.value
    if isinstance(value, tuple):
        low, high = (f"{float(end):.8g}" for end in value)
        return rf"{low}\ldots" if low == high else rf"[{low}, {high}]"
    if value.denominator == 1:
        return str(value.numerator)
    if len(str(value.denominator)) > 9:
        return rf"{float(value):.8g}\ldots"
    return rf"\tfrac{{{value.numerator}}}{{{value.denominator}}}"


def _policies(data: Mapping[str, Any]) -> str:
    actions = data.get("actions")

    def cell(choice: Any) -> str:
        if isinstance(choice, list):
            return ", ".join(map(str, choice))
        return plain(actions[int(choice)]) if actions else plain(f"a_{choice}")

    head = "".join(f"<th>{escape(plain(name))}</th>" for name in data["states"])
    rows = [
        f"<tr><th>{escape(plain(name))}</th>" + "".join(f"<td>{escape(cell(c))}</td>" for c in choices) + "</tr>"
        for name, choices in data["policies"].items()
        if len(choices) == len(data["states"]) and not isinstance(choices, Mapping)
    ]
    table = f'<table class="small"><tr><th>policy</th>{head}</tr>{"".join(rows)}</table>' if rows else ""
    return table + _by_history(data)


def _by_history(data: Mapping[str, Any]) -> str:
    """Policies that remember: a row for each pattern of histories, the first that fits counts."""
    actions = "".join(f"<th>{escape(plain(name))}</th>" for name in data.get("actions", ()))
    rows = [
        f"<tr><th>{escape(plain(name))}</th><td><code>{escape(pattern)}</code></td>"
        + "".join(f"<td>{escape(str(p))}</td>" for p in row)
        + "</tr>"
        for name, choices in data["policies"].items()
        if isinstance(choices, Mapping)
        for pattern, row in choices.items()
    ]
    head = f"<tr><th>policy</th><th>after</th>{actions}</tr>"
    return f'<table class="small">{head}{"".join(rows)}</table>' if rows else ""


def _laws(laws: Mapping[str, Any]) -> str:
    rows = "".join(
        f"<tr><th>{escape(plain(name))}</th>" + "".join(f"<td>{escape(str(p))}</td>" for p in law) + "</tr>"
        for name, law in laws.items()
    )
    return f'<table class="small">{rows}</table>'


def _numbers(data: Mapping[str, Any]) -> str:
    rows = [
        f"<tr><th>{escape(plain(name))}</th><td>{escape(_compact(value))}</td></tr>" for name, value in data.items()
    ]
    return f'<table class="small">{"".join(rows)}</table>'


def _compact(value: Any) -> str:
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False).replace('"', "")
    return text if len(text) <= 160 else f"{text[:150]} … ({len(text)} characters)"
