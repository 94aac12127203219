"""HTML for notebooks: bounds, values, settings and solutions as small tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

from bridge_theory.parameters import parameter, show

if TYPE_CHECKING:
    from bridge_theory.bound import Bound
    from bridge_theory.solution import Solution
    from bridge_theory.value import BoundValue


def table_html(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A plain HTML table; text between dollar signs is left to the notebook's MathJax.

    >>> table_html(("a",), [("1 < 2",)])
    '<table><thead><tr><th>a</th></tr></thead><tbody><tr><td>1 &lt; 2</td></tr></tbody></table>'
    """
    head = "".join(f"<th>{escape(cell)}</th>" for cell in header)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def bound_html(bound: Bound) -> str:
    """Statement, source, assumptions and parameters of a bound."""
    rows = [
        (
            f"${parameter(name).latex}$",
            parameter(name).meaning,
            parameter(name).domain.describe(name),
            _moves(bound, name),
        )
        for name in bound.parameters
    ]
    assumed = "".join(f"<li>{escape(text)}</li>" for text in bound.assumptions)
    return (
        f"<p><b>{escape(bound.title)}</b> ({bound.status}; {escape(bound.source)})</p>"
        f"<p>$${escape(bound.latex())}$$</p><ul>{assumed}</ul>"
        + table_html(("symbol", "meaning", "domain", "the bound"), rows)
    )


def value_html(value: BoundValue) -> str:
    """Enclosure, terms and words of an evaluated bound."""
    rows = [("value", str(value.enclosure), "")]
    rows += [(name, str(term), _share(value, name)) for name, term in value.terms.items()]
    rows.append(("failure probability", value.failure.at_most, "" if value.certified else "nothing is certified"))
    if value.trivial is not None:
        rows.append(("trivial", str(value.trivial), "vacuous" if value.vacuous else ""))
    return f"<p>{escape(value.words)}</p>" + table_html((value.bound.name, "enclosure", "share"), rows)


def solution_html(solution: Solution) -> str:
    """The answer in words with its two certificates."""
    rows = []
    if solution.value is not None:
        rows.append((f"{solution.name} = {show(solution.value)}", str(solution.meets), "meets the target"))
    if solution.beyond is not None and solution.fails is not None:
        rows.append((f"{solution.name} = {show(solution.beyond)}", str(solution.fails), "exceeds the target"))
    return f"<p>{escape(solution.words)}</p>" + table_html(("at", "enclosure", "certifies"), rows)


def _moves(bound: Bound, name: str) -> str:
    direction = bound.monotone.get(name)
    return "" if direction is None else f"{direction.direction}: {direction.because}"


def _share(value: BoundValue, name: str) -> str:
    return f"{value.shares[name]:.1%}" if name in value.shares else ""
