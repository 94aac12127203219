"""The kernel-checked development as a graph: theorems in layers, each linked to its entry, with what it rests on."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from proofs_checks.kernel.dependencies import formulas, layers, uses
from proofs_checks.kernel.manifest import Development
from proofs_checks.kernel.recorded import origin

_COLUMN, _ROW, _WIDTH, _HEIGHT, _MARGIN = 300, 34, 250, 24, 12


def development(what: Development, places: Mapping[str, str]) -> str:
    """A section of the page; ``places`` are the fragments of the entries that show each theorem."""
    if not what.theorems:
        return ""
    columns = layers(what)
    at = {
        name: (_MARGIN + _COLUMN * column, _MARGIN + _ROW * row)
        for column, names in enumerate(columns)
        for row, name in enumerate(names)
    }
    below = uses(what)
    edges = "".join(_edge(at[other], at[name]) for name in at for other in sorted(below[name]))
    nodes = "".join(_node(at[name], name, what, places.get(name, "")) for name in at)
    width, height = _MARGIN + _COLUMN * len(columns), 2 * _MARGIN + _ROW * max(map(len, columns))
    rows = "".join(_row(name, what, below[name], places.get(name, "")) for names in columns for name in names)
    return (
        f'<section id="development"><h2>The kernel-checked theorems</h2><p>{escape(origin())}. An arrow leads from a '
        "theorem to one that uses it.</p>"
        f'<div class="development"><svg viewBox="0 0 {width} {height}" width="{width}" height="{height}" role="img" '
        f'aria-label="which theorem uses which">{edges}{nodes}</svg></div>'
        "<details><summary>As a table</summary><table><thead><tr><th>theorem</th><th>statement</th><th>in words</th>"
        f"<th>formulas</th><th>rests on</th><th>instance</th></tr></thead><tbody>{rows}</tbody></table></details>"
        "</section>"
    )


def _edge(start: tuple[int, int], end: tuple[int, int]) -> str:
    x1, y1, x2, y2 = start[0] + _WIDTH, start[1] + _HEIGHT / 2, end[0], end[1] + _HEIGHT / 2
    return f'<path class="edge" d="M{x1} {y1} C{x1 + 25} {y1} {x2 - 25} {y2} {x2} {y2}"/>'


def _node(place: tuple[int, int], name: str, what: Development, fragment: str) -> str:
    one = what.theorems[name]
    x, y = place
    box = f'<rect class="theorem" x="{x}" y="{y}" width="{_WIDTH}" height="{_HEIGHT}" rx="4"/>'
    text = f'<text class="theorem" x="{x + 8}" y="{y + 16}">{escape(name)}</text>'
    inner = f"<title>{escape(f'{one.label}: {one.words}')}</title>{box}{text}"
    return f'<a href="#{fragment}">{inner}</a>' if fragment else f"<g>{inner}</g>"


def _row(name: str, what: Development, below: frozenset[str], fragment: str) -> str:
    one = what.theorems[name]
    label = f'<a href="#{fragment}">{escape(one.label)}</a>' if fragment else escape(one.label)
    used = ", ".join(f"<code>{escape(formula)}</code>" for formula in formulas(what, name))
    cells = (
        f"<code>{escape(one.file)}.{escape(name)}</code>",
        label,
        escape(one.words),
        used or "–",
        escape(", ".join(sorted(below))) or "–",
        f"<code>{escape(one.nonvacuity)}</code>",
    )
    return f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"
