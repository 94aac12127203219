"""Certificates of a run's logs beside what the run did: ``bridge-rl verify`` on the page."""

from __future__ import annotations

from html import escape
from pathlib import Path

import numpy as np
import xarray as xr

from bridge_algos.run.config import RunConfig
from bridge_algos.run.log_file import log_files
from bridge_theory.errors import InputError
from experiments.compare.certificates import verified
from experiments.report.text import table_html
from proofs_checks.verify import Certificate
from proofs_checks.verify.certificate import rounded_up, shared

_NAMES = {
    "trivial": "trivial",
    "ucb": "optimism (UCB)",
    "width": "width",
    "hindsight": "hindsight",
    "best": "best of these",
    "likelihood": "likelihood set",
}
_TITLES = {
    "bounds": "What the bounds are on",
    "note": "Notes",
    "assuming": "What no log can show",
    "likelihood": "The likelihood set",
    "taken at its word": "What is taken at its word",
}


def certificates_html(directory: Path, config: RunConfig, results: xr.Dataset, most: int) -> str:
    """The first ``most`` logs of a run, each verified; regret after the last round in utility.

    A run without logs, or with one that cannot be read, says so.
    """
    paths = log_files(directory)
    if not paths:
        return "<p>The run kept no log to verify; <code>bridge-rl run ... --log</code> keeps one.</p>"
    found: list[Certificate] = []
    unread = []
    for path in paths[:most]:
        try:
            found += verified(path, config, results)
        except InputError as error:
            unread.append(f'<p class="problem">{escape(str(error))}</p>')
    good = sum(item.certified for item in found)
    verdict = f'<p class="state{"" if good == len(found) and not unread else " bad"}">'
    verdict += (
        f"{good} of {len(found)} certified, from {min(most, len(paths)) - len(unread)} of {len(paths)} logs read.</p>"
    )
    header = ("algorithm", "seed", "verdict", "failure probability", "realised", *map(escape, _NAMES.values()))
    rows = [_row(item, results) for item in found]
    caption = (
        '<p class="quiet">Regret after the last round, in utility: what happened, against the best stationary policy '
        "found, and what the log proves, against the policy named below. The trivial bound cannot fail; the others "
        "but that of the likelihood set hold together, but for the failure probability.</p>"
    )
    reasons = _listed("Why not", [f"{i.algorithm}, seed {i.seed}: {r}" for i in found for r in i.reasons])
    told = "".join(
        _listed(title, [f"{who}: {sentence}" for kind, sentence, who in shared(found) if kind == wanted])
        for wanted, title in _TITLES.items()
    )
    table = table_html(header, rows, "bounds") if rows else ""
    return f"{verdict}{''.join(unread)}{caption}{table}{reasons}{told}"


def _row(item: Certificate, results: xr.Dataset) -> tuple[str, ...]:
    word = '<b class="says">certified</b>' if item.certified else '<b class="problem">not certified</b>'
    bounds = [rounded_up(float(item.bounds[name][-1])) if item.certified else "–" for name in _NAMES]
    failure = item.failure_words if item.certified else "–"
    regret = _realised(item.algorithm, item.seed, results)
    realised = f"{regret:.4g}" if np.isfinite(regret) else "–"
    return (escape(item.algorithm), str(item.seed), word, failure, realised, *bounds)


def _realised(algorithm: str, seed: int, results: xr.Dataset) -> float:
    if algorithm not in results.algorithm or seed not in results.seed:
        return np.nan
    regret = results.pseudo_regret.sel(algorithm=algorithm, seed=seed).sum()
    return float(regret) * float(results.attrs.get("utility_scale", np.nan))


def _listed(title: str, sentences: list[str]) -> str:
    rows = "".join(f"<li>{escape(text)}</li>" for text in dict.fromkeys(sentences))
    return f'<p class="title">{title}</p><ul>{rows}</ul>' if rows else ""
