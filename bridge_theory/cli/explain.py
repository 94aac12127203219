"""``--explain LABEL``: everything a formula knows about itself, in a terminal."""

from __future__ import annotations

import inspect
import re
import textwrap

from bridge_theory.bound import Bound
from bridge_theory.cli.options import flag
from bridge_theory.cli.rows import described_parameters, failure_words
from bridge_theory.cli.table import text_table
from bridge_theory.defaults import missing
from bridge_theory.formula import Formula
from bridge_theory.setting import Setting
from bridge_theory.value import BoundValue


def explain(formula: Formula, setting: Setting) -> str:
    """Statement, source, assumptions, parameters, directions; with a complete setting also value, terms and words."""
    documentation = _plain(inspect.cleandoc(formula.__doc__ or "").split(">>>")[0].strip())
    parts = [f"{formula.name}: {formula.title} ({formula.status}, {formula.source})", documentation]
    parts += [_listed("Assumptions", formula.assumptions), _listed("Parameters", described_parameters(formula))]
    directions = [f"{move.direction} in {name}: {move.because}" for name, move in formula.monotone.items()]
    parts.append(_listed("Directions", directions))
    lacking = missing(formula, setting)
    if lacking:
        wanted = " ".join(map(flag, lacking))
        parts.append(f"Its value also needs {wanted}.")
    elif isinstance(formula, Bound):
        parts.append(_valued(formula.value(setting)))
    return "\n\n".join(part for part in parts if part)


def _plain(documentation: str) -> str:
    """A docstring without its markup: LaTeX stays, roles and literals become plain text."""
    without_roles = re.sub(r":math:`([^`]*)`", r"\1", documentation)
    return re.sub(r"\.\. math::\s*", "", without_roles).replace("``", "")


def _listed(heading: str, lines: tuple[str, ...] | list[str]) -> str:
    return "\n".join([f"{heading}:", *(f"  - {line}" for line in lines)]) if lines else ""


def _valued(value: BoundValue) -> str:
    lines = [f"Value: {value.enclosure}"]
    if value.trivial is not None:
        lines.append(f"Trivial value: {value.trivial.at_most}")
    lines.append(f"May fail with probability: {failure_words(value)}")
    if value.terms:
        mark = {value.dominant: "dominates"}
        rows = [
            (name, value.safe_side(term), f"{value.shares[name]:.1%}" if value.shares else "", mark.get(name, ""))
            for name, term in value.terms.items()
        ]
        lines.append(text_table(("term", "value", "share", ""), rows))
    return "\n".join([*lines, textwrap.fill(value.words, 110)])
