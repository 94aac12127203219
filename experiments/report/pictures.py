"""Figures of the page: interactive panels under one legend, or the picture itself where they cannot be made."""

from __future__ import annotations

import base64
import io
import json
from html import escape
from typing import Any

from bridge_theory.errors import InputError
from experiments.report.interactive import Spec, panels


def picture_html(picture: Any, caption: str) -> str:
    """A ``<figure>``; the panels' data stand in it as JSON, which the page's script draws."""
    try:
        specs = panels(picture)
    except InputError:
        return _still(picture, caption)
    boxes = "".join(f'<div>{_heading(spec)}<div class="panel" role="img"></div></div>' for spec in specs)
    data = json.dumps(specs, allow_nan=False).replace("<", "\\u003c")
    return (
        f'<figure class="interactive"><div class="panels">{boxes}</div>{_colours(specs)}{_legend(specs)}'
        f'<figcaption>{escape(caption)}</figcaption><script type="application/json">{data}</script></figure>'
    )


def _heading(spec: Spec) -> str:
    return f'<p class="panel-title">{spec["title"]}</p>' if spec["title"] else ""


def _colours(specs: list[Spec]) -> str:
    told = dict.fromkeys(trace["meta"].get("colour") for spec in specs for trace in spec["data"])
    return "".join(f'<p class="panel-title">colour: {words}</p>' for words in told if words)


def _legend(specs: list[Spec]) -> str:
    named = {trace["name"]: trace for spec in specs for trace in reversed(spec["data"]) if trace.get("name")}
    order = dict.fromkeys(trace["name"] for spec in specs for trace in spec["data"] if trace.get("name"))
    entries = "".join(
        f'<button type="button" aria-pressed="true" data-group="{escape(named[name]["meta"]["group"])}">'
        f"{_swatch(named[name])}<span>{name}</span></button>"
        for name in order
    )
    return f'<div class="legend" aria-label="Show and hide curves">{entries}</div>' if entries else ""


def _swatch(trace: Spec) -> str:
    """A short piece of the curve."""
    parts = ""
    mode = trace.get("mode", "")
    if "fill" in trace:
        parts += f'<rect width="26" height="12" fill="{trace["fillcolor"]}"/>'
    elif trace["type"] == "bar":
        parts += f'<rect width="26" height="12" fill="{trace["marker"]["color"][0]}"/>'
    if "lines" in mode and "fill" not in trace:
        line = trace["line"]
        dash = {"dash": "6 3", "dot": "2 2", "dashdot": "6 2 2 2", "solid": ""}.get(line.get("dash", "solid"))
        dash = line["dash"].replace("px", "").replace(",", " ") if dash is None else dash
        parts += (
            f'<line x1="0" x2="26" y1="6" y2="6" stroke="{line["color"]}" stroke-width="{line.get("width", 2):g}" '
            f'stroke-dasharray="{dash}"/>'
        )
    if "markers" in mode:
        colour = trace["marker"]["color"]
        parts += f'<circle cx="13" cy="6" r="4" fill="{colour if isinstance(colour, str) else colour[0]}"/>'
    return f'<svg width="26" height="12" viewBox="0 0 26 12" aria-hidden="true">{parts}</svg>'


def _still(picture: Any, caption: str) -> str:
    buffer = io.BytesIO()
    picture.savefig(buffer, format="png", dpi=160)
    source = base64.b64encode(buffer.getvalue()).decode()
    return (
        f'<figure><img alt="{escape(caption)}" src="data:image/png;base64,{source}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )
