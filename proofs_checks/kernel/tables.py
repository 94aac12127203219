"""A finite model of a stored counterexample as definitions of Coq."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from fractions import Fraction
from itertools import product
from typing import Any

PREAMBLE = """Require Import Reals QArith Qreals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Mdp Bridge.Distances Bridge.Tables Bridge.Claims Bridge.Evaluation.
Import ListNotations.
Open Scope R_scope."""


def number(value: object) -> str:
    """An exact number in Coq's rationals.

    >>> number("9/25"), number(1), number("-1/2")
    ('(9 # 25)', '1', '(-1 # 2)')
    """
    exact = Fraction(str(value))
    if exact.denominator == 1:
        return str(exact.numerator) if exact >= 0 else f"({exact.numerator})"
    return f"({exact.numerator} # {exact.denominator})"


def model(data: Mapping[str, Any], names: Mapping[str, str]) -> list[str]:
    """States, actions, the first law, kernels and policies; ``names`` says what each kernel and policy is called."""
    n_states, n_actions = len(data["states"]), len(next(iter(data["kernels"].values()))[0])
    parts = [PREAMBLE, finite("state", "s", n_states), finite("action", "a", n_actions)]
    parts.append(row_table("start", "s", data["initial"]))
    for latex, name in names.items():
        if latex in data["kernels"]:
            parts.append(_kernel(name, data["kernels"][latex]))
        else:
            parts.append(_policy(name, data["policies"][latex], data, n_states, n_actions))
    return parts


def finite(kind: str, letter: str, size: int) -> str:
    """A type of ``size`` elements, named by a letter and a number, with the list of them."""
    elements = [f"{letter}{i}" for i in range(size)]
    return (
        f"Inductive {kind} := {' | '.join(elements)}.\n"
        f"Definition {kind}s : finite.\nProof.\n"
        f"  refine (Finite {kind} [{'; '.join(elements)}] _ _ _);\n"
        "    [decide equality | intros []; simpl; tauto | repeat constructor; simpl; intuition congruence].\nDefined."
    )


def row_table(name: str, letter: str, row: Sequence[object]) -> str:
    """A law on states (``s``) or actions (``a``) with the entries of a row."""
    entries = " | ".join(f"{letter}{i} => {number(p)}" for i, p in enumerate(row))
    kind = {"s": "state", "a": "action"}[letter]
    return (
        f"Definition {name}_entry (x : {kind}) : Q := (match x with {entries} end)%Q.\n"
        f"Definition {name} : table {kind}s.\n"
        f"Proof. refine (Table (X := {kind}s) {name}_entry _ _); vm_compute; reflexivity. Defined."
    )


def _kernel(name: str, rows: Sequence[Sequence[Sequence[object]]]) -> str:
    cases = [
        f"  | s{s}, a{a}, s{target} => {number(p)}"
        for s, actions in enumerate(rows)
        for a, row in enumerate(actions)
        for target, p in enumerate(row)
        if Fraction(str(p))
    ]
    return (
        f"Definition {name}_entry (s : state) (a : action) (x : state) : Q :=\n  (match s, a, x with\n"
        + "\n".join(cases)
        + "\n  | _, _, _ => 0\n  end)%Q.\n"
        f"Definition {name} (s : states) (a : actions) : table states.\n"
        f"Proof. refine (Table (X := states) ({name}_entry s a) _ _); destruct s, a; vm_compute; reflexivity. Defined."
    )


def _policy(name: str, table: Any, data: Mapping[str, Any], n_states: int, n_actions: int) -> str:
    if isinstance(table, Mapping):
        return _remembering(name, table, data, n_states, n_actions)
    if isinstance(table[0], list):
        rows = [row_table(f"{name}_{s}", "a", row) for s, row in enumerate(table)]
        cases = " | ".join(f"s{s} => {name}_{s}" for s in range(n_states))
        head = f"Definition {name} (s : states) : table actions :="
        return "\n".join([*rows, f"{head} match (s : state) with {cases} end."])
    cases = " | ".join(f"s{s} => a{action}" for s, action in enumerate(table))
    return f"Definition {name} (s : states) : actions := match (s : state) with {cases} end."


def _remembering(
    name: str, patterns: Mapping[str, Sequence[object]], data: Mapping[str, Any], n_states: int, n_actions: int
) -> str:
    """A policy by patterns of the past: all pasts up to the horizon whose row is not the last pattern's are listed."""
    order = list(patterns)
    rows = [row_table(f"{name}_{k}", "a", patterns[pattern]) for k, pattern in enumerate(order)]
    cases = []
    for length in range(int(data["horizon"])):
        for past in product(product(range(n_states), range(n_actions)), repeat=length):
            for s in range(n_states):
                words = [name for i, a in past for name in (data["states"][i], data["actions"][a])]
                written = " ".join([*words, data["states"][s]])
                k = next(k for k, pattern in enumerate(order) if fnmatchcase(written, pattern))
                if k != len(order) - 1:
                    latest_first = "; ".join(f"(s{i}, a{a})" for i, a in reversed(past))
                    cases.append(f"  | [{latest_first}], s{s} => {name}_{k}")
    return "\n".join(
        [
            *rows,
            f"Definition {name} (h : list (states * actions)) (s : states) : table actions :=",
            "  match (h : list (state * action)), (s : state) with",
            *cases,
            f"  | _, _ => {name}_{len(order) - 1}",
            "  end.",
        ]
    )
