"""A study's words as HTML: sentences as paragraphs, aligned tables as they are."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from html import escape
from itertools import groupby


def words_html(text: str) -> str:
    """Escaped paragraphs and lists; lines whose columns are aligned by spaces keep their alignment.

    >>> words_html("Two lines:" + chr(10) * 2 + "a  1" + chr(10) + "b  2")
    '<p>Two lines:</p><pre>a  1\\nb  2</pre>'
    """
    blocks = []
    for block in re.split(r"\n\s*\n", text.strip("\n")):
        for aligned, group in groupby(block.splitlines(), key=_aligned):
            lines = list(group)
            blocks.append(_table(lines) if aligned else _sentences(lines))
    return "".join(blocks)


def table_html(header: Sequence[str], rows: Iterable[Sequence[str]], kind: str = "") -> str:
    """A table that scrolls sideways where it has to; the cells are HTML already."""
    head = "".join(f"<th>{cell}</th>" for cell in header)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    top = f"<thead><tr>{head}</tr></thead>" if header else ""
    return f'<div class="wide"><table class="{kind}">{top}<tbody>{body}</tbody></table></div>'


def _aligned(line: str) -> bool:
    return re.search(r"\S {2,}\S", line) is not None


def _table(lines: list[str]) -> str:
    return f"<pre>{escape(chr(10).join(lines), quote=False)}</pre>"


def _sentences(lines: list[str]) -> str:
    introduced = len(lines) == 1 or lines[0].endswith(":")
    head = f"<p>{escape(lines[0], quote=False)}</p>" if introduced else ""
    items = "".join(f"<li>{escape(line.strip(), quote=False)}</li>" for line in lines[introduced:])
    return head + (f"<ul>{items}</ul>" if items else "")
