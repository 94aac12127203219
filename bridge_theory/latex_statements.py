r"""Read the statements of a LaTeX paper: theorem-like environments, floats, algorithms, numbered displays, proofs.

Only what a fingerprint needs is understood: comments, nested ``\begin``/``\end``, ``\label`` and sectioning. A label
belongs to the innermost statement around it, so a numbered equation inside a theorem keeps its own entry.
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass

THEOREM_LIKE = frozenset({"theorem", "lemma", "corollary", "definition", "assumption", "claim", "remark"})
FLOATS = frozenset({"algorithm", "figure", "table"})
NUMBERED_DISPLAYS = frozenset({"equation", "align", "gather", "multline"})

_TOKEN = re.compile(
    r"\\(?P<edge>begin|end)\{(?P<environment>[A-Za-z]+\*?)\}|\\label(?:\[[^\]]*\])?\{(?P<label>[^}]*)\}"
)
_HEADING = re.compile(r"\\(?:sub)*section\*?\{(?P<text>(?:[^{}]|\{[^{}]*\})*)\}(?:\s*\\label\{(?P<label>[^}]*)\})?")
_TITLE = re.compile(r"\s*(?:\[[htbpH!]+\])?\s*(?:\[(?P<title>(?:[^\[\]]|\[[^\]]*\])*)\])?")
_CAPTION = re.compile(r"\\caption\{(?P<caption>(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*)\}")
_COMMENT = re.compile(r"(?<!\\)%.*")
_BLANK_LINE = re.compile(r"\n[ \t]*\n\s*")


@dataclass(frozen=True)
class LatexStatement:
    """One environment or paragraph of the paper: its kind, title, section, labels, position and source text."""

    kind: str
    title: str
    section: str
    labels: tuple[str, ...]
    start: int
    text: str

    @property
    def fingerprint(self) -> str:
        """SHA-256 of the text with white space collapsed, so that re-wrapped lines keep their fingerprint."""
        return hashlib.sha256(" ".join(self.text.split()).encode()).hexdigest()


@dataclass
class _OpenEnvironment:
    name: str
    start: int
    body: int
    labels: list[str]

    @property
    def kind(self) -> str:
        """``claim*`` is a claim, but ``align*`` is not a numbered display."""
        bare = self.name.removesuffix("*")
        return self.name if bare in NUMBERED_DISPLAYS else bare

    @property
    def is_statement(self) -> bool:
        return self.kind in THEOREM_LIKE | FLOATS | NUMBERED_DISPLAYS


def strip_comments(tex: str) -> str:
    r"""Remove every comment (an unescaped ``%`` to the end of its line), keeping the line breaks.

    >>> strip_comments("a % note\n5\\% b")
    'a \n5\\% b'
    """
    return _COMMENT.sub("", tex)


def read_statements(tex: str) -> list[LatexStatement]:
    r"""All statements of a LaTeX source in order of appearance, labelled or not.

    Args:
        tex: the LaTeX source, comments included.

    Returns:
        One `LatexStatement` for each theorem-like environment, float, algorithm, numbered display, and labelled proof;
        starred displays are formulas, not statements. ``section`` is the label of the innermost heading, or its text.

    Raises:
        ValueError: a ``\begin`` and its ``\end`` do not match.

    >>> [(s.kind, s.labels) for s in read_statements(r"\begin{lemma}[Title]\label{lem:a} x \end{lemma}")]
    [('lemma', ('lem:a',))]
    """
    source = strip_comments(tex)
    stack: list[_OpenEnvironment] = []
    found: list[LatexStatement] = []
    for token in _TOKEN.finditer(source):
        if token["edge"] == "begin":
            stack.append(_OpenEnvironment(token["environment"], token.start(), token.end(), []))
        elif token["edge"] == "end":
            if not stack or stack[-1].name != token["environment"]:
                raise ValueError(f"\\end{{{token['environment']}}} at character {token.start()} closes nothing open")
            opened = stack.pop()
            if opened.is_statement or (opened.kind == "proof" and opened.labels):
                found.append(_statement(opened, source, token.end()))
        else:
            owner = next((o for o in reversed(stack) if o.is_statement or o.kind == "proof"), None)
            if owner is not None:
                owner.labels.append(token["label"])
    return sorted(found, key=lambda statement: statement.start)


def paragraph_around(tex: str, anchor: str) -> LatexStatement:
    r"""The paragraph (text between blank lines) that contains ``anchor``, for formulas stated in running text.

    Args:
        tex: the LaTeX source, comments included.
        anchor: a snippet of one line that occurs exactly once outside comments.

    Raises:
        LookupError: the snippet is missing or occurs more than once.

    >>> paragraph_around("a\n\nLet $x := 1$.\n\nb", "x :=").text
    'Let $x := 1$.'
    """
    source = strip_comments(tex)
    if source.count(anchor) != 1:
        raise LookupError(f"the anchor {anchor!r} occurs {source.count(anchor)} times in the LaTeX; it must occur once")
    at = source.index(anchor)
    breaks = [match.span() for match in _BLANK_LINE.finditer(source)]
    start = max((stop for _, stop in breaks if stop <= at), default=0)
    end = min((begin for begin, _ in breaks if begin > at), default=len(source))
    return LatexStatement("passage", "", _section_at(source, start), (), start, source[start:end])


def _statement(opened: _OpenEnvironment, source: str, end: int) -> LatexStatement:
    text = source[opened.start : end]
    title = ""
    if opened.kind in FLOATS:
        captions = _CAPTION.findall(text)  # subfigures come first, the float's own caption last
        title = captions[-1] if captions else ""
    elif opened.kind in THEOREM_LIKE and (match := _TITLE.match(source, opened.body)):
        title = match["title"] or ""
    section = _section_at(source, opened.start)
    return LatexStatement(opened.kind, " ".join(title.split()), section, tuple(opened.labels), opened.start, text)


def _section_at(source: str, position: int) -> str:
    section = ""
    for heading in _HEADING.finditer(source, 0, position):
        section = heading["label"] or " ".join(heading["text"].split())
    return section
