r"""LaTeX formulas as MathML, which browsers render without any script.

``latex2mathml`` does the translation; what it leaves to renderers that browsers are not is put right here: spaces
around named functions, relations and fences, primes, limits under ``\max`` in displays, the alignment of columns. A
macro that it does not know is an error, not a piece of raw LaTeX on the page.
"""

from __future__ import annotations

import re
from functools import cache
from xml.etree.ElementTree import Element, SubElement, fromstring, tostring

from latex2mathml.converter import convert

from bridge_theory.errors import InputError

_NAMESPACE = "http://www.w3.org/1998/Math/MathML"
_THIN, _THICK = "0.167em", "0.278em"
_RELATIONS = frozenset("=<>≤≥≠≈∼~⪰⪯≻≺⟺⟹⇒⇔→⟶↦∈∉⊆⊂≲≳≪≫≍≡⟂≔:∣")
_FENCES = frozenset("()[]{}⟨⟩⌈⌉⌊⌋|‖/!")
_OPENING = frozenset("([{⟨⌈⌊|‖")
_CLOSING = frozenset(")]}⟩⌉⌋|‖")
_SIGNS = frozenset("+−±-")
_PRIMES = frozenset("′″")
_UNDER_IN_DISPLAYS = frozenset({"max", "min", "sup", "inf", "lim", "argmax", "argmin"})
_ARGUMENTS = {"mfrac": 2, "msub": 2, "msup": 2, "munder": 2, "mover": 2, "mroot": 2, "msubsup": 3, "munderover": 3}
_SPELLINGS = (
    ("{aligned}", "{align*}"),
    ("{gathered}", "{align*}"),
    (r"\arg\max", r"\operatorname{argmax}"),
    (r"\arg\min", r"\operatorname{argmin}"),
    (":=", "≔"),
)


@cache
def mathml(latex: str, *, display: bool = False) -> str:
    r"""One formula as a ``<math>`` element.

    Errors: ``InputError`` naming the formula if it cannot be translated completely.

    >>> mathml("x")
    '<math><mrow><mi>x</mi></mrow></math>'
    """
    source = " ".join(latex.split())
    for ours, theirs in _SPELLINGS:
        source = source.replace(ours, theirs)
    try:
        text = convert(source, display="block" if display else "inline")
        root = fromstring(text.replace(f' xmlns="{_NAMESPACE}"', ""))
    except Exception as error:
        raise InputError(f"cannot translate the formula {latex!r}: {type(error).__name__} {error}") from error
    for element in root.iter():
        if element.text and re.search(r"\\[A-Za-z]|&", element.text):
            raise InputError(f"the formula {latex!r} contains {element.text!r}, which cannot be translated")
        if len(element) != _ARGUMENTS.get(element.tag, len(element)):
            raise InputError(f"the formula {latex!r} cannot be translated: {element.tag} lacks an argument")
    _repair(root, display)
    if not display:
        root.attrib.pop("display", None)
    return tostring(root, encoding="unicode")


def _repair(parent: Element, display: bool) -> None:
    for child in parent:
        if align := child.attrib.pop("columnalign", None):
            child.set("style", f"text-align: {align}")
        _lower_prime(child)
        _lower_script(child)
        _space(child)
        _repair(child, display)
    for position, child in enumerate(parent):
        before = parent[position - 1] if position else None
        after = parent[position + 1] if position + 1 < len(parent) else None
        if child.tag == "mo" and child.text in _SIGNS and (before is None or _awaits(before)):
            child.attrib.update(form="prefix", lspace="0", rspace="0")
        name = _named_function(child)
        if name is None:
            continue
        # as TeX: a thin space before, unless something opens there, and behind, unless an argument in parentheses
        before = parent[position - 1] if position else None
        after = parent[position + 1] if position + 1 < len(parent) else None
        tight = before is None or (
            before.tag == "mo" and _named_function(before) is None and before.text not in _CLOSING
        )
        name.set("lspace", "0" if tight else _THIN)
        name.set("rspace", "0" if after is None or _opens(after) else _THIN)
        if display and child.tag == "msub" and name.text in _UNDER_IN_DISPLAYS:
            child.tag = "munder"


def _space(element: Element) -> None:
    if element.tag not in {"mi", "mo"} or element.text is None:
        return
    if element.text in _RELATIONS:
        element.tag = "mo"
        element.text = element.text.replace("~", "∼")
        element.attrib.update(lspace=_THICK, rspace=_THICK)
    elif element.text in _FENCES:
        element.tag = "mo"
        element.attrib.update(lspace="0", rspace="0")
        element.attrib.setdefault("stretchy", "false")


def _lower_prime(element: Element) -> None:
    """A prime is raised already; as a superscript it would be raised twice and too small to see."""
    if element.tag not in {"msup", "msubsup"} or element[-1].text not in _PRIMES:
        return
    base, prime = element[0], element[-1]
    prime.tag = "mo"
    prime.attrib.update(lspace="0", rspace="0")
    inner = [base, prime]
    if element.tag == "msup":
        element.tag = "mrow"
        element[:] = inner
    else:
        subscript = element[1]
        element.tag = "msub"
        element[:] = []
        SubElement(element, "mrow").extend(inner)
        element.append(subscript)


def _lower_script(element: Element) -> None:
    """A superscript belongs where the letter ends, not above its accent."""
    if element.tag in {"msup", "msubsup"} and element[0].tag == "mover":
        letter = Element("mpadded", height="0.7em")
        letter.append(element[0])
        element[0] = letter


def _named_function(element: Element) -> Element | None:
    """The named function that this element is, with or without scripts."""
    inner = element[0] if element.tag in {"msub", "msup", "msubsup", "munder"} else element
    if inner.tag == "mi" and inner.text and re.fullmatch("[A-Za-z]{2,}", inner.text):
        inner.tag = "mo"
        inner.attrib.clear()
    is_name = inner.tag == "mo" and inner.text is not None and re.fullmatch("[A-Za-z]+", inner.text)
    return inner if is_name else None


def _awaits(element: Element) -> bool:
    """Something still has to follow this element: it is an operator, a relation, a comma or an opening fence."""
    return element.tag == "mo" and element.text not in _CLOSING


def _opens(element: Element) -> bool:
    first = next(iter(element), element) if element.tag == "mrow" else element
    return first.text is not None and first.text in _OPENING
