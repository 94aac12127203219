"""What the theory says for a run's setting: every bound that the setting determines, certified."""

from __future__ import annotations

from fractions import Fraction
from html import escape

from bridge_algos.run.config import RunConfig
from bridge_algos.run.setting import theory_setting
from bridge_algos.run.world import build_world, caveats
from bridge_theory.catalog import FORMULAS
from bridge_theory.cli.rows import Row, failure_words, filled_in, row_for
from bridge_theory.defaults import missing
from bridge_theory.errors import InputError
from bridge_theory.parameters import show
from bridge_theory.setting import Setting
from experiments.compare.applicability import of_the_run
from experiments.report.ledger import refuted, row_anchor
from experiments.report.text import table_html

_GROUPS = {"offline": "Offline", "online": "Online", "regret": "Regret, in utility", "answers": "Certified answers"}
_OWN = (
    '<p class="quiet">Each bound has assumptions of its own, listed by <code>bridge-rl bounds --explain LABEL</code>; '
    "those from the version space, for example, are about an offline set of radius zero.</p>"
)
_HEADER = ("bound", "value", "may fail with", "trivial value", "says something?", "status")


def bounds_html(config: RunConfig) -> str:
    """The setting, what of the run takes the guarantees away, and the bounds by group; or why there are none."""
    try:
        world = build_world(config)
    except InputError as error:
        return f"<p>The run's world cannot be built again: {escape(str(error))}</p>"
    setting = theory_setting(config, world).replace(T=config.rounds)
    given = ", ".join(f"{name} = {_short(name, setting)}" for name in setting)
    rows = [row_for(formula, setting) for formula in FORMULAS.values() if not missing(formula, setting)]
    broken = "; ".join(dict.fromkeys(caveats(config, world) + of_the_run(config, world)))
    warning = f'<p class="problem">The bounds assume what this run does not keep: {escape(broken)}.</p>'
    telling = [row for row in rows if row.value is not None and row.value.trivial is not None]
    says = [row for row in telling if row.value is not None and row.value.certified and row.value.vacuous is not True]
    tables = table_html(_HEADER, map(_cells, says), "bounds") if says else "<p>No bound says anything here.</p>"
    for group, title in _GROUPS.items():
        members = [row for row in rows if row.formula.group == group and row not in says]
        empty = [row for row in members if row in telling]
        rest = [row for row in members if row not in empty]
        tables += _folded(f"{title}: {len(empty)} bounds that say nothing here", empty)
        tables += _folded(f"{title}: {len(rest)} parts and rates", rest)
    filled = filled_in((row.formula.name, row.filled) for row in rows)
    assumed = (
        f'<p class="quiet">Filled in, as a run does not show it: {escape("; ".join(filled))}.</p>' if filled else ""
    )
    return f'<p class="quiet">At {escape(given)}.</p>{warning if broken else ""}{_OWN}{assumed}{tables}'


def _folded(summary: str, rows: list[Row]) -> str:
    if not rows:
        return ""
    inner = table_html(_HEADER, map(_cells, rows), "bounds")
    return f"<details><summary>{escape(summary)}</summary>{inner}</details>"


def _cells(row: Row) -> tuple[str, ...]:
    formula = row.formula
    false = refuted(formula.source)
    status = f'{formula.status}, <b class="problem">{false}</b>' if false else formula.status
    doubtful = bool(false) or (false is None and formula.status == "stated")
    link = row_anchor(formula.source)
    source = f"<code>{escape(formula.source)}</code>"
    name = f"{escape(formula.title)}<br>" + (f'<a href="#{link}">{source}</a>' if link else source)
    if row.estimate is not None:
        return (name, f"~ {row.estimate:.4g}", "–", "–", "a rate: for scaling only", status)
    if row.value is None:
        return (name, "undefined", "–", "–", escape(row.problem), status)
    value = row.value
    trivial = "–" if value.trivial is None else value.trivial.at_most
    undecided = "–" if value.trivial is None else "not decided"
    yes = "claims to" if doubtful else '<b class="says">yes</b>'
    no = '<span class="empty">no</span>'
    says = {None: undecided, True: no, False: yes}[value.vacuous] if value.certified else no
    shown = f'<span title="{escape(str(value.enclosure))}">{value.shown}</span>'
    return (name, shown, failure_words(value), trivial, says, status)


def _short(name: str, setting: Setting) -> str:
    value = setting[name]
    return f"{float(value):.4g}" if isinstance(value, Fraction) else show(value)
