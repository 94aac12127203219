"""What all configurations of a run share: validated entries, canonical JSON, and which kind a text is."""

from __future__ import annotations

import json
import reprlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, fields, replace
from math import isfinite
from typing import Any, Self

from bridge_theory.errors import InputError

ALGORITHMS = ("bridge", "bridge-known", "pbrl", "bc")
NumberRule = tuple[tuple[str, ...], Any, Callable[[Any], bool], str]
"""Names of entries, their type, what holds for them, and that in words."""


@dataclass(frozen=True)
class Configuration:
    """Everything that decides the numbers of a run, except the seed."""

    environment: str

    def to_json(self) -> str:
        """A canonical JSON text: the same configuration gives the same text."""
        return json.dumps(asdict(self), sort_keys=True)

    @classmethod
    def from_json(cls, text: str) -> Self:
        """The configuration that :meth:`to_json` wrote; InputError for anything else."""
        given = _entries(text)
        unknown = set(given) - {f.name for f in fields(cls)}
        if unknown:
            raise InputError(f"a run configuration has unknown entries {sorted(unknown)}; is it from another version?")
        if "environment" not in given:
            raise InputError("a run configuration names no environment; save it again.")
        return cls(**given)

    def but(self, **changes: Any) -> Self:
        """The same configuration with some entries changed, validated again."""
        return replace(self, **changes)


def check_kinds(config: Configuration, kinds: Iterable[tuple[str, Any, str]]) -> None:
    """Refuse entries of another type: each rule is a name, a type, and what was expected in words."""
    for name, kind, expected in kinds:
        if not isinstance(getattr(config, name), kind):
            raise InputError(f"{name} is {getattr(config, name)!r}, expected {expected}.")


def checked_algorithms(given: Iterable[str], known: Iterable[str]) -> tuple[str, ...]:
    """The algorithms as a tuple, after making sure that each is known and there is one."""
    names, choices = tuple(given), tuple(known)
    unknown = [name for name in names if name not in choices]
    if unknown or not names:
        raise InputError(f"unknown algorithm {unknown or 'list, empty'}; expected some of {', '.join(choices)}.")
    if len(set(names)) < len(names):
        raise InputError(f"algorithms is {', '.join(names)}, expected each of them once.")
    return names


def check_choices(config: Configuration, choices: Mapping[str, tuple[str, ...]]) -> None:
    """Refuse an entry that is not one of its choices."""
    for name, allowed in choices.items():
        if getattr(config, name) not in allowed:
            raise InputError(f"{name} is {getattr(config, name)!r}, expected one of {', '.join(allowed)}.")


def check_numbers(config: Configuration, rules: Iterable[NumberRule], optional: tuple[str, ...] = ()) -> None:
    """Refuse numbers out of range; those in ``optional`` may be None."""
    for names, kind, valid, expected in rules:
        for name in names:
            value = getattr(config, name)
            if value is None and name in optional:
                continue
            if isinstance(value, bool) or not isinstance(value, kind) or not _finite(value) or not valid(value):
                raise InputError(f"{name} is {reprlib.repr(value)}, expected {expected}.")


def _finite(value: float) -> bool:
    try:
        return isfinite(value)
    except OverflowError:  # a whole number beyond the largest double
        return False


def read_configuration(text: str) -> Configuration:
    """The configuration that a text describes, of the kind that its environment has; InputError for another text."""
    from bridge_algos.continuous.config import ContinuousConfig, is_continuous
    from bridge_algos.run.config import RunConfig

    environment = _entries(text).get("environment", "")
    kind = ContinuousConfig if is_continuous(str(environment)) else RunConfig
    return kind.from_json(text)


def _entries(text: str) -> dict[str, Any]:
    try:
        given = json.loads(text)
    except (TypeError, ValueError) as error:
        raise InputError(f"a run configuration is not readable JSON ({error}); save it again.") from None
    if not isinstance(given, dict):
        raise InputError(f"a run configuration is a JSON {type(given).__name__}, expected an object; save it again.")
    return given
