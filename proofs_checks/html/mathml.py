r"""LaTeX formulas as MathML, which browsers render without any script.

``latex2mathml`` does the translation; what it leaves to renderers that browsers are not is put right here: spaces
around named functions, limits under ``\max`` in displays, the alignment of table columns. A macro that it does not
know is an error, not a piece of raw LaTeX on the page.
"""

from __future__ import annotations

import re
from functools import cache
from xml.etree import ElementTree

from latex2mathml.converter import convert

from bridge_theory.errors import InputError

_NAMESPACE = "http://www.w3.org/1998/Math/MathML"
_THIN = "0.167em"
_UNDER_IN_DISPLAYS = {"max", "min", "sup", "inf", "lim", "argmax", "argmin", "arg max", "arg min", "lim sup"}
_OPENING = {"(", "[", "{", "⟨", "|", "‖"}
_UNITS = {"aligned": "align*", "gathered": "align*"}


@cache
def mathml(latex: str, *, display: bool = False) -> str:
    r"""One formula as a ``<math>`` element.

    Errors: ``InputError`` naming the formula if it cannot be translated completely.

    >>> mathml("x")
    '<math><mrow><mi>x</mi></mrow></math>'
    """
    source = " ".join(latex.split())
    for ours, theirs in _UNITS.items():
        source = source.replace(f"{{{ours}}}", f"{{{theirs}}}")
    try:
        text = convert(source, display="block" if display else "inline")
        root = ElementTree.fromstring(text.replace(f' xmlns="{_NAMESPACE}"', ""))
    except Exception as error:
        raise InputError(f"cannot translate the formula {latex!r}: {type(error).__name__} {error}") from error
    for element in root.iter():
        if element.text and re.search(r"\\[A-Za-z]|&", element.text):
            raise InputError(f"the formula {latex!r} contains {element.text!r}, which cannot be translated")
    _repair(root, display)
    if not display:
        root.attrib.pop("display", None)
    return ElementTree.tostring(root, encoding="unicode")


def _repair(element: ElementTree.Element, display: bool) -> None:
    for position, child in enumerate(element):
        if align := child.attrib.pop("columnalign", None):
            child.set("style", f"text-align: {align}")
        if _is_name(child):
            child.tag = "mo"
            child.attrib.clear()
        core = _core(child)
        if core is not None:
            # as TeX: a thin space before, unless something opens there, and behind, unless an argument in parentheses
            before = element[position - 1] if position else None
            after = element[position + 1] if position + 1 < len(element) else None
            tight = before is None or (before.tag == "mo" and _core(before) is None and before.text not in {")", "]"})
            core.set("lspace", "0" if tight else _THIN)
            core.set("rspace", "0" if after is None or (after.text or "") in _OPENING else _THIN)
            if display and child.tag == "msub" and core.text in _UNDER_IN_DISPLAYS:
                child.tag = "munder"
        _repair(child, display)


def _core(element: ElementTree.Element) -> ElementTree.Element | None:
    """The named function that this element is, with or without scripts."""
    inner = element[0] if element.tag in {"msub", "msup", "msubsup", "munder"} else element
    if _is_name(inner):
        inner.tag = "mo"
        inner.attrib.clear()
    return inner if inner.tag == "mo" and _is_word(inner.text) else None


def _is_name(element: ElementTree.Element) -> bool:
    return element.tag == "mi" and _is_word(element.text)


def _is_word(text: str | None) -> bool:
    return text is not None and re.fullmatch(r"[A-Za-z]{2,}( [A-Za-z]+)?", text) is not None
