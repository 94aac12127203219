r"""The little LaTeX of figure labels (``$\Pi_t$``) as text with ``<sub>``, ``<sup>`` and ``<i>``, escaped.

Interactive figures draw their labels with these tags only. What is not known here is refused, so that no raw LaTeX
reaches a page.
"""

from __future__ import annotations

import re
from html import escape
from unicodedata import normalize

from bridge_theory.errors import InputError

_SYMBOLS = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "varepsilon": "ε", "zeta": "ζ", "eta": "η",
    "theta": "θ", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "pi": "π", "rho": "ρ", "sigma": "σ",
    "tau": "τ", "phi": "φ", "varphi": "φ", "chi": "χ", "psi": "ψ", "omega": "ω", "Gamma": "Γ", "Delta": "Δ",
    "Theta": "Θ", "Lambda": "Λ", "Xi": "Ξ", "Pi": "Π", "Sigma": "Σ", "Phi": "Φ", "Psi": "Ψ", "Omega": "Ω",
    "leq": "≤", "le": "≤", "geq": "≥", "ge": "≥", "neq": "≠", "approx": "≈", "sim": "∼", "propto": "∝", "pm": "±",
    "times": "×", "cdot": "·", "in": "∈", "subset": "⊂", "cup": "∪", "cap": "∩", "infty": "∞", "sum": "Σ", "prod": "Π",
    "to": "→", "rightarrow": "→", "star": "⋆", "ast": "∗", "ell": "ℓ", "langle": "⟨", "rangle": "⟩", "|": "‖",
    "ldots": "…", "dots": "…", "cdots": "⋯", "log": "log", "exp": "exp", "min": "min", "max": "max", "sup": "sup",
    "inf": "inf", "sqrt": "√", "%": "%", "$": "$", "{": "{", "}": "}", "_": "_", ",": "\u2009", ";": "\u2005",
    ":": "\u2005", " ": " ", "quad": "\u2003", "!": "", "left": "", "right": "",
}  # fmt: skip
_ACCENTS = {"hat": "\u0302", "widehat": "\u0302", "tilde": "\u0303", "widetilde": "\u0303", "bar": "\u0304"}
_UPRIGHT = ("mathrm", "text", "operatorname", "mathcal", "mathbf")
_TOKEN = re.compile(r"\\([A-Za-z]+|.)|([A-Za-z]+)|(\s+)|(.)", re.DOTALL)


def markup(label: str) -> str:
    r"""A label of a figure as escaped text with simple tags.

    Raises:
        InputError: for LaTeX that is not known here.

    >>> markup(r"policies in $\Pi_t$ < 5")
    'policies in Π<sub><i>t</i></sub> &lt; 5'
    >>> markup(r"$\mathdefault{10^{-3}}$"), markup(r"$\hat{w}_T^2$")
    ('10<sup>−3</sup>', '<i>ŵ</i><sub><i>T</i></sub><sup>2</sup>')
    """
    pieces = re.split(r"(?<!\\)\$", label)
    if len(pieces) % 2 == 0:
        raise InputError(f"the figure's label {label!r} has a dollar without a partner")
    return "".join(
        _formula(piece, label) if i % 2 else escape(piece.replace(r"\$", "$"), quote=False)
        for i, piece in enumerate(pieces)
    )


def _formula(source: str, label: str) -> str:
    tokens = [match.group() for match in _TOKEN.finditer(source)]
    words, rest = _row(tokens, label)
    if rest:
        raise InputError(f"the figure's label {label!r} closes a brace that it did not open")
    return words


def _row(tokens: list[str], label: str) -> tuple[str, list[str]]:
    """Everything up to the closing brace, and what follows it."""
    words = []
    while tokens and tokens[0] != "}":
        word, tokens = _atom(tokens, label)
        words.append(word)
    return "".join(words), tokens


def _atom(tokens: list[str], label: str) -> tuple[str, list[str]]:
    if not tokens:
        raise InputError(f"the figure's label {label!r} ends where something should follow")
    first, rest = tokens[0], tokens[1:]
    if first == "{":
        words, rest = _row(rest, label)
        if not rest:
            raise InputError(f"the figure's label {label!r} leaves a brace open")
        return words, rest[1:]
    if first in ("_", "^"):
        words, rest = _atom(_letters(rest), label)
        tag = "sub" if first == "_" else "sup"
        return f"<{tag}>{words}</{tag}>", rest
    if not first.startswith("\\"):
        return _plain(first), rest
    name = first[1:]
    if name in _ACCENTS:
        words, rest = _atom(_letters(rest), label)
        return f"<i>{normalize('NFC', re.sub('<[^>]*>', '', words) + _ACCENTS[name])}</i>", rest
    if name in (*_UPRIGHT, "mathdefault", "mathit"):
        words, rest = _atom(_letters(rest), label)
        return (re.sub("</?i>", "", words) if name in _UPRIGHT else words), rest
    if name not in _SYMBOLS:
        raise InputError(f"the figure's label {label!r} uses \\{name}, which cannot be shown on a page")
    return escape(_SYMBOLS[name], quote=False), rest


def _letters(tokens: list[str]) -> list[str]:
    """A script takes one letter or digit of a word, as in TeX."""
    if tokens and len(tokens[0]) > 1 and not tokens[0].startswith("\\"):
        return [tokens[0][0], tokens[0][1:], *tokens[1:]]
    return tokens


def _plain(text: str) -> str:
    if text.isspace():
        return ""
    if text.isalpha():
        return f"<i>{text}</i>"
    return escape({"-": "−", "*": "∗", "'": "′"}.get(text, text), quote=False)
