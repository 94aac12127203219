"""An immutable, validated description of a problem: the parameters the user knows, as exact numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from bridge_theory.errors import InputError
from bridge_theory.parameters import Given, Stored, parameter, show


class Setting(Mapping[str, "Stored"]):
    r"""The parameters of one problem, e.g. ``Setting(S=5, A=4, H=8, n=2, delta="0.05", gamma_min="0.1")``.

    Source: the paper's Section 3. Every value is stored exactly: integers, ``Fraction``; a float is the binary number
    it is, a string the decimal or fraction it shows. Units and ranges: ``bridge_theory.parameters``. Returns a
    read-only mapping whose entries are also attributes. Errors: ``InputError`` for an unknown name or a value outside
    its domain.

    >>> setting = Setting(S=5, A=4, H=8, n=2, delta="0.05")
    >>> setting.delta, setting.replace(n=10).n
    (Fraction(1, 20), 10)
    >>> Setting(delta=1.5)
    Traceback (most recent call last):
    bridge_theory.errors.InputError: delta = 1.5 is outside its domain; expected 0 < delta < 1 (failure probability)
    """

    __slots__ = ("_values",)
    _values: dict[str, Stored]

    def __init__(self, **values: Given) -> None:
        object.__setattr__(self, "_values", {name: parameter(name).exact(value) for name, value in values.items()})

    def replace(self, **values: Given) -> Setting:
        """A new setting with some values changed or added."""
        return Setting(**{**self._values, **values})

    def __getitem__(self, name: str) -> Stored:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._values:
            raise AttributeError(f"this setting has no {name!r}; it has {', '.join(self._values) or 'nothing'}")
        return self._values[name]

    def __setattr__(self, name: str, value: object) -> None:
        raise InputError(f"a Setting does not change; write setting.replace({name}=...) for a new one")

    def __hash__(self) -> int:
        return hash(frozenset(self._values.items()))

    def __repr__(self) -> str:
        return f"Setting({', '.join(f'{name}={show(value)}' for name, value in self._values.items())})"

    def _repr_html_(self) -> str:
        from bridge_theory.display import table_html

        rows = [(f"${parameter(k).latex}$", show(v), parameter(k).meaning, parameter(k).unit) for k, v in self.items()]
        return table_html(("symbol", "value", "meaning", "unit"), rows)

    def _repr_latex_(self) -> str:
        return f"${', '.join(f'{parameter(name).latex} = {show(value)}' for name, value in self.items())}$"
