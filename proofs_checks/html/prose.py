"""Texts of the ledger as HTML: escaped prose, LaTeX between dollars as MathML, blank lines as paragraphs."""

from __future__ import annotations

import re
from html import escape

from bridge_theory.errors import InputError
from proofs_checks.html.mathml import mathml

_MATH = re.compile(r"\$\$(?P<display>.+?)\$\$|\$(?P<inline>.+?)\$", re.DOTALL)


def paragraphs(text: str) -> str:
    r"""Paragraphs with their formulas.

    >>> paragraphs("Let $x$ < y.")
    '<p>Let <math><mrow><mi>x</mi></mrow></math> &lt; y.</p>'
    """
    return "".join(f"<p>{line(part)}</p>" for part in re.split(r"\n\s*\n", text.strip()) if part.strip())


def line(text: str) -> str:
    """Running text with its formulas, without paragraphs.

    Errors: ``InputError`` if a dollar is left over or LaTeX stands outside of dollars.
    """
    pieces, end = [], 0
    for match in _MATH.finditer(text):
        pieces.append(_plain(text[end : match.start()]))
        display = match["display"]
        pieces.append(mathml(display, display=True) if display else mathml(match["inline"]))
        end = match.end()
    return "".join([*pieces, _plain(text[end:])])


def sentence(text: str) -> str:
    """A phrase as a sentence: it begins with a capital and ends with a full stop.

    >>> sentence("one round"), sentence("$x$ rises?")
    ('One round.', '$x$ rises?')
    """
    begins = text[:1].upper() + text[1:] if re.match("[a-z]{2}|a ", text) else text
    return begins if begins.rstrip().endswith((".", "?", "!", ":")) else f"{begins.rstrip()}."


def _plain(text: str) -> str:
    if "$" in text or re.search(r"\\[A-Za-z]", text):
        raise InputError(f"LaTeX stands outside of dollars in {text.strip()!r}")
    return escape(re.sub(r"\s+", " ", text), quote=False)
