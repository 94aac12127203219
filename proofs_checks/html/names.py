r"""Short LaTeX names (``s_0``, ``P^*``, ``\hat P``, ``\pi``) as plain text, for places where MathML cannot stand."""

from __future__ import annotations

import re

_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "varepsilon": "ε", "eta": "η", "theta": "θ",
    "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "pi": "π", "rho": "ρ", "sigma": "σ", "tau": "τ",
    "phi": "φ", "omega": "ω", "Pi": "Π", "star": "*", "ast": "*", "infty": "∞", "cdot": "·", "prime": "′",
}  # fmt: skip
_ACCENTS = {"hat": "\u0302", "widehat": "\u0302", "bar": "\u0304", "overline": "\u0304", "tilde": "\u0303"}
_SUBSCRIPTS = str.maketrans("0123456789+-=()aehijklmnoprstuvx", "₀₁₂₃₄₅₆₇₈₉₊₋₌₍₎ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ")
_SUPERSCRIPTS = str.maketrans("0123456789+-=()n", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁼⁽⁾ⁿ")


def plain(latex: str) -> str:
    r"""The name as text.

    >>> plain(r"s_0"), plain(r"P^*"), plain(r"\hat P"), plain(r"\pi^{\mathrm{BC}}"), plain("gamma_min")
    ('s₀', 'P*', 'P̂', 'π BC', 'γₘᵢₙ')
    """
    text = re.sub(r"\\(?:mathrm|text|operatorname|mathcal|mathbf|boldsymbol)\{([^{}]*)\}", r"\1", str(latex))
    text = re.sub(r"(?<![A-Za-z\\])([a-z]+)(?![A-Za-z])", lambda m: _GREEK.get(m[1], m[0]), text)
    text = re.sub(r"\\([A-Za-z]+)", lambda m: _GREEK.get(m[1], m[0] if m[1] in _ACCENTS else m[1]), text)
    text = re.sub(r"\\([a-z]+)\s*\{?(\w)\}?", lambda m: m[2] + _ACCENTS[m[1]] if m[1] in _ACCENTS else m[0], text)
    text = re.sub(r"_\{([^{}]*)\}|_([0-9A-Za-z]+)", lambda m: _script(m[1] or m[2], _SUBSCRIPTS), text)
    text = re.sub(r"\^\{([^{}]*)\}|\^(\S)", lambda m: _script(m[1] or m[2], _SUPERSCRIPTS), text)
    return re.sub(r"[{}$\\]", "", text).strip()


def _script(text: str, table: dict[int, int]) -> str:
    if set(text) <= {"*", "′"}:
        return text
    return text.translate(table) if all(ord(character) in table for character in text) else f" {text}"
