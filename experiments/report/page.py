"""The page: one HTML document that needs nothing else and may fetch nothing."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Sequence
from html import escape
from importlib import resources
from typing import Any

from experiments.report.bounds import bounds_html
from experiments.report.certificate import certificates_html
from experiments.report.comparison import comparison_html
from experiments.report.found import Item
from experiments.report.ledger import ANCHOR, ledger_html, link_labels
from experiments.report.pictures import picture_html
from experiments.report.text import table_html, words_html


def page(items: Sequence[Item], title: str, *, verify: int = 3, check: str | None = None, jobs: int = 1) -> str:
    """A complete HTML document on some runs and reproductions.

    Args:
        verify: how many logs of each run to verify.
        check: replay the ledger first; see :func:`experiments.report.ledger.ledger_html`.
        jobs: processes.

    Its content security policy allows the two scripts that it contains, by their digests, and no connection at all;
    texts that come from files are escaped.
    """
    library = _resource("plotly", "package_data/plotly.min.js")
    script = _resource("experiments.report", "report.js")
    policy = (
        f"default-src 'none'; script-src {_digest(library)} {_digest(script)}; style-src 'unsafe-inline'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    style = _resource("proofs_checks.html", "style.css") + _resource("experiments.report", "report.css")
    sections = "".join(_section(number, item, verify, jobs) for number, item in enumerate(items))
    links = "".join(f'<li><a href="#{_anchor(n)}">{escape(item.title)}</a></li>' for n, item in enumerate(items))
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1"><link rel="icon" href="data:,">'
        f"<title>BRIDGE report: {escape(title)}</title><style>{style}</style></head><body>"
        f'<header class="top"><h1>BRIDGE report</h1><nav aria-label="Contents"><ul>{links}'
        f'<li><a href="#{ANCHOR}">The paper\'s statements</a></li></ul></nav></header>'
        f'<main>{sections}<section id="{ANCHOR}"><h2>Is each statement of the paper true?</h2>'
        f"{ledger_html(check, jobs)}</section></main>"
        f"<script>{library}</script><script>{script}</script></body></html>"
    )


def _section(number: int, item: Item, verify: int, jobs: int) -> str:
    pictures = "".join(
        picture_html(picture, f"{item.title}{f', {suffix}' if suffix else ''}")
        for suffix, picture in item.figures.items()
    )
    parts = [
        f'<section id="{_anchor(number)}"><h2>{escape(item.title)}</h2>',
        f'<p class="quiet">From <code>{escape(item.name)}</code>.</p>{pictures}',
        f"<h3>In words</h3>{link_labels(words_html(item.words))}",
        f"<details><summary>Settings</summary>{_settings(item)}</details>",
    ]
    if item.configuration is not None:
        parts += [
            f"<h3>What the theory says here</h3>{bounds_html(item.configuration)}",
            f"<h3>Regret beside the theory</h3>{comparison_html(item.directory, item.title, jobs)}",
            f"<h3>Certificate</h3>{certificates_html(item.directory, item.configuration, item.data, verify)}",
        ]
    return "".join([*parts, "</section>"])


def _settings(item: Item) -> str:
    rows = [(escape(name), f"<code>{escape(value)}</code>") for name, value in _flat(item.settings)]
    return table_html((), rows, "settings") + f'<p class="quiet">Made with {escape(_versions(item.versions))}.</p>'


def _versions(recorded: str) -> str:
    try:
        return ", ".join(f"{package} {version}" for package, version in json.loads(recorded).items())
    except (ValueError, AttributeError):  # a text, where they differ
        return recorded


def _flat(settings: dict[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    rows = []
    for name, value in settings.items():
        if isinstance(value, dict) and value:
            rows += _flat(value, f"{prefix}{name}.")
        else:
            rows.append((prefix + name, json.dumps(value, ensure_ascii=False)))
    return rows


def _anchor(number: int) -> str:
    return f"item-{number + 1}"


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _resource(package: str, name: str) -> str:
    return resources.files(package).joinpath(name).read_text(encoding="utf-8")
