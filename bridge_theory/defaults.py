"""What is filled in where a setting leaves a parameter open: the one table, and the assumption that each entry brings.

Nothing else in the package fills in a parameter, and the words of a value repeat what was filled in for it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from bridge_theory.offline.assumptions import DETERMINISTIC
from bridge_theory.parameters import Stored, show

if TYPE_CHECKING:
    from bridge_theory.formula import Formula


@dataclass(frozen=True)
class Default:
    """How one parameter is filled in: from which others, with what value, and what that assumes.

    ``upper`` marks a value that is at least the true one whatever the problem: it is only taken where a larger value
    weakens the statement, which is not so for a bound from below.
    """

    needs: tuple[str, ...]
    value: Callable[..., Any]
    assumes: str
    upper: bool = False


@dataclass(frozen=True)
class Filled:
    """A parameter that the setting did not hold: the value taken and what it assumes."""

    name: str
    value: Stored
    assumes: str
    part_of_delta: bool = False

    def __str__(self) -> str:
        return f"{self.name} = {show(self.value)} ({self.assumes})"


# bounds about a deterministic stationary expert say so themselves; all others are about every pair
_EXPERT_PAIRS = Default(("S",), lambda S: S, "S: a deterministic stationary expert uses one action in each state", True)
_ALL_PAIRS = Default(("S", "A"), lambda S, A: S * A, "S A: every state-action pair", True)
_FIXED = {
    "K": Default((), lambda: 1, "one comparison is made in each round"),
    "t": Default(("T",), lambda T: T, "the last round"),
    "Delta_n": Default((), lambda: 1, "always true", upper=True),
    "diameter": Default(("B",), lambda B: 2 * B, "2 B: no two policies are farther apart", upper=True),
    "delta1": Default(("delta",), lambda delta: Fraction(delta) / 2, "half of delta, as in the paper's theorem"),
    "delta2": Default(("delta",), lambda delta: Fraction(delta) / 2, "half of delta, as in the paper's theorem"),
}


def default_of(name: str, formula: Formula) -> Default | None:
    """How ``formula`` fills in its parameter ``name``, or None where the user has to give it.

    >>> from bridge_theory import offline_radius_repaired, transition_error_repaired
    >>> default_of("rows", offline_radius_repaired).needs, default_of("rows", transition_error_repaired).needs
    (('S',), ('S', 'A'))
    """
    spends = getattr(formula, "spends", ())
    if name in ("rows", "S_reach"):
        found: Default | None = _EXPERT_PAIRS if DETERMINISTIC in formula.assumptions else _ALL_PAIRS
    elif name in _FIXED:
        found = _FIXED[name]
    elif name in spends and name != "delta":
        parts = len(spends)
        shared = f"one of {parts} equal parts of delta" if parts > 1 else "delta"
        found = Default(("delta",), lambda delta: Fraction(delta) / parts, shared)
    else:
        found = None
    from_below = "{at_least}" in getattr(formula, "words", "")
    return None if found is None or (found.upper and from_below) else found


def completed(formula: Formula, setting: Mapping[str, Stored]) -> tuple[dict[str, Stored], tuple[Filled, ...]]:
    """The parameters of ``formula`` that a setting determines, and which of them had to be filled in.

    Source: ``delta1`` and ``delta2`` are halves of ``delta``, as in the paper's theorem; other failure probabilities
    that a bound spends are equal parts of ``delta``. The paper compares once a round.

    >>> from bridge_theory import Setting, transition_error_repaired
    >>> known, filled = completed(transition_error_repaired, Setting(S=2, A=1000, H=1, n=1000, delta="0.05"))
    >>> known["rows"], *map(str, filled)
    (2000, 'rows = 2000 (S A: every state-action pair)')
    """
    known = {name: setting[name] for name in formula.parameters if name in setting}
    filled = []
    for name in formula.parameters:
        default = default_of(name, formula)
        if name in setting or default is None or not all(other in setting for other in default.needs):
            continue
        value: Stored = default.value(**{other: setting[other] for other in default.needs})
        filled.append(Filled(name, value, default.assumes, part_of_delta=default.needs == ("delta",)))
    return known | {item.name: item.value for item in filled}, tuple(filled)


def missing(formula: Formula, setting: Mapping[str, Stored], *, varied: str | None = None) -> tuple[str, ...]:
    """What a user would have to give before ``formula`` has a value, in the order of its parameters.

    ``varied`` is a parameter that takes many values: it is not missing, and what would be filled in from it is.

    >>> from bridge_theory import Setting, transition_error_repaired
    >>> missing(transition_error_repaired, Setting(S=2, H=1, n=1000))
    ('delta', 'A')
    >>> missing(transition_error_repaired, Setting(A=3, H=1, n=1000, delta="0.05"), varied="S")
    ('rows',)
    """
    known, _ = completed(formula, setting)
    lacking: list[str] = []
    for name in formula.parameters:
        if name not in known and name != varied:
            default = default_of(name, formula)
            if default is None or varied in default.needs:
                lacking.append(name)
            else:
                lacking += [other for other in default.needs if other not in setting]
    return tuple(dict.fromkeys(lacking))


def filled_in_words(filled: tuple[Filled, ...]) -> str:
    """The sentence that says what was filled in; empty if nothing was."""
    return f" Filled in, as it was not given: {'; '.join(map(str, filled))}." if filled else ""
