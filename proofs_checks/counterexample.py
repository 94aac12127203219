"""Counterexamples as data: exact rationals in JSON, replayed by evaluators that know nothing of the claims.

A file ``counterexamples/NAME.json`` has the fields

- ``label``, ``part``: the claim it breaks; ``sentence``: what breaks, in one sentence; ``kind``: its evaluator;
- ``data``: the instance; every number a string: ``"9/25"``. Finite MDPs use ``states`` (names), ``initial``
  (a row), ``kernels`` (LaTeX name -> rows ``[s][a][s']``), ``policies`` (LaTeX name -> an action per state, or rows
  per state) and ``horizon``, so that they can be drawn; an instance that one can run names its ``environment``, whose
  numbers stand in ``bridge_algos/envs/counterexamples.json``, and adds what is its own;
- ``left``, ``relation``, ``right``: the inequality that the paper claims, each side with its ``latex`` and its
  ``value``: ``"29/125"``, or a rational enclosure ``["0.12", "0.13"]``;
- ``controls``: nearby instances where the same inequality is *not* violated: a ``name`` and the ``data`` keys that
  change. An evaluator that calls everything a counterexample fails on them.
"""

from __future__ import annotations

import importlib
import json
import pkgutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from importlib import resources
from typing import Any, Literal, TypeAlias

from bridge_theory.errors import InputError
from proofs_checks.outcome import Outcome, Tally

Relation = Literal["<=", "<", ">=", ">", "=="]
Number: TypeAlias = Fraction | tuple[Fraction, Fraction]
"""An exact value, or a pair that encloses it."""
Evaluator = Callable[[Mapping[str, Any]], tuple[Number, Number]]
"""``evaluate(data) -> (left, right)``: both sides of the inequality, from the instance alone."""

_EVALUATORS: dict[str, Evaluator] = {}


def evaluates(kind: str) -> Callable[[Evaluator], Evaluator]:
    """Register the evaluator of one kind; put it in a module of ``proofs_checks.evaluators``."""

    def register(function: Evaluator) -> Evaluator:
        if kind in _EVALUATORS and _EVALUATORS[kind].__qualname__ != function.__qualname__:
            raise TypeError(f"two evaluators for counterexamples of kind {kind!r}")
        _EVALUATORS[kind] = function
        return function

    return register


def evaluator(kind: str) -> Evaluator:
    """The evaluator of one kind; ``InputError`` naming the known kinds if there is none."""
    import proofs_checks.evaluators

    for module in pkgutil.iter_modules(proofs_checks.evaluators.__path__):
        importlib.import_module(f"proofs_checks.evaluators.{module.name}")
    if kind not in _EVALUATORS:
        raise InputError(f"no evaluator for counterexamples of kind {kind!r}; known: {', '.join(sorted(_EVALUATORS))}")
    return _EVALUATORS[kind]


@dataclass(frozen=True)
class Side:
    """One side of the violated inequality."""

    latex: str
    value: Number


@dataclass(frozen=True)
class Control:
    """A nearby instance that does not violate the inequality; ``data`` holds the keys that change."""

    name: str
    data: Mapping[str, Any]


@dataclass(frozen=True)
class Counterexample:
    """A stored instance that violates one inequality of the paper."""

    name: str
    label: str
    part: str
    sentence: str
    kind: str
    data: Mapping[str, Any]
    left: Side
    relation: Relation
    right: Side
    controls: tuple[Control, ...]


@cache
def load(name: str) -> Counterexample:
    """Read ``counterexamples/NAME.json``; ``InputError`` names the file and the field that is wrong."""
    file = resources.files("proofs_checks").joinpath("counterexamples", f"{name}.json")
    return parse(name, json.loads(file.read_text(encoding="utf-8")))


@cache
def on_environment(environment: str) -> tuple[Counterexample, ...]:
    """The stored counterexamples whose instance is the environment of that name."""
    folder = resources.files("proofs_checks").joinpath("counterexamples")
    names = sorted(file.name.removesuffix(".json") for file in folder.iterdir() if file.name.endswith(".json"))
    return tuple(load(name) for name in names if load(name).data.get("environment") == environment)


def parse(name: str, record: Mapping[str, Any]) -> Counterexample:
    """Validate one record of the schema above."""
    wanted = {"label", "sentence", "kind", "data", "left", "relation", "right", "controls"}
    missing, unknown = wanted - set(record), set(record) - wanted - {"part"}
    if missing or unknown:
        raise InputError(
            f"counterexample {name}: missing fields {sorted(missing)}, unknown fields {sorted(unknown)}; "
            f"expected {sorted(wanted)} and optionally part"
        )
    if record["relation"] not in _VIOLATED:
        raise InputError(f"counterexample {name}: relation {record['relation']!r} is none of {', '.join(_VIOLATED)}")
    if not record["controls"]:
        raise InputError(f"counterexample {name} has no control: add a nearby instance where the inequality holds")
    environment = record["data"].get("environment")
    data = {**(_instance(name, environment) if environment else {}), **record["data"]}
    _refuse_floats(name, data)
    return Counterexample(
        name, record["label"], record.get("part", ""), record["sentence"], record["kind"], data,
        _side(record["left"]), record["relation"], _side(record["right"]),
        tuple(Control(control["name"], control["data"]) for control in record["controls"]),
    )  # fmt: skip


def replay(*, name: str, control: str = "") -> Outcome:
    """Evaluate the instance (or one of its controls) afresh and decide whether it violates the inequality.

    For the instance itself, the recorded values of both sides must agree with the recomputed ones.
    """
    example = load(name)
    changes = {item.name: item.data for item in example.controls}[control] if control else {}
    left, right = evaluator(example.kind)({**example.data, **changes})
    shown = f"{show(left)} {example.relation} {show(right)}"
    tally = Tally()
    tally.expect(violated(example.relation, left, right), f"{shown} is not certainly violated")
    if not control:
        for side, value, recorded in (("left", left, example.left.value), ("right", right, example.right.value)):
            agrees = overlap(_ends(value), _ends(recorded))
            tally.expect(agrees, f"the {side} side is {show(value)}, but the file says {show(recorded)}")
    return tally.outcome(f"the paper claims {shown}")


def violated(relation: Relation, left: Number, right: Number) -> bool:
    """Whether ``left relation right`` certainly fails, whatever the exact values inside the enclosures are.

    >>> violated("<=", Fraction(2, 5), (Fraction(1, 5), Fraction(3, 10)))
    True
    """
    return _VIOLATED[relation](_ends(left), _ends(right))


def show(value: Number) -> str:
    """``29/125 = 0.232``, or the ends of an enclosure to nine digits."""
    if isinstance(value, Fraction):
        return str(value) if value.denominator == 1 else f"{value} = {float(value):.6g}"
    return f"[{float(value[0]):.9g}, {float(value[1]):.9g}]"


def overlap(a: tuple[Fraction, Fraction], b: tuple[Fraction, Fraction]) -> bool:
    """Two enclosures have a point in common; for exact values: they are equal."""
    return a[0] <= b[1] and b[0] <= a[1]


_VIOLATED: dict[str, Callable[[tuple[Fraction, Fraction], tuple[Fraction, Fraction]], bool]] = {
    "<=": lambda left, right: left[0] > right[1],
    "<": lambda left, right: left[0] >= right[1],
    ">=": lambda left, right: left[1] < right[0],
    ">": lambda left, right: left[1] <= right[0],
    "==": lambda left, right: not overlap(left, right),
}


def _ends(value: Number) -> tuple[Fraction, Fraction]:
    return value if isinstance(value, tuple) else (value, value)


@cache
def _instance(name: str, environment: str) -> Mapping[str, Any]:
    # data of another room, none of its code: evaluators share nothing with what they judge
    text = resources.files("bridge_algos.envs").joinpath("counterexamples.json").read_text(encoding="utf-8")
    instances: dict[str, dict[str, Any]] = json.loads(text)
    if environment not in instances:
        raise InputError(f"counterexample {name}: no environment {environment!r} in {', '.join(instances)}")
    return instances[environment]


def _side(record: Mapping[str, Any]) -> Side:
    value = record["value"]
    exact = (Fraction(value[0]), Fraction(value[1])) if isinstance(value, list) else Fraction(value)
    return Side(record["latex"], exact)


def _refuse_floats(name: str, data: Any) -> None:
    if isinstance(data, float):
        raise InputError(f"counterexample {name}: {data!r} is a float; write numbers as exact strings such as '9/25'")
    for item in data.values() if isinstance(data, Mapping) else data if isinstance(data, list) else ():
        _refuse_floats(name, item)
