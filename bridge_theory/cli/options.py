"""Options shared by the subcommands: one flag per scalar parameter of the table."""

from __future__ import annotations

import argparse
from typing import NoReturn

from bridge_theory.errors import InputError
from bridge_theory.parameters import PARAMETERS
from bridge_theory.setting import Setting

_FLAGS = {name: f"--{name.replace('_', '-')}" for name, row in PARAMETERS.items() if not row.array}


class Parser(argparse.ArgumentParser):
    """An argument parser whose complaints are one sentence, raised as ``InputError``."""

    def error(self, message: str) -> NoReturn:
        """Raise instead of printing the whole usage."""
        raise InputError(f"{message}; try '{self.prog} --help'")


def add_parameters(parser: argparse.ArgumentParser) -> None:
    """One flag per parameter; values are read exactly, ``0.05`` as 1/20."""
    group = parser.add_argument_group("parameters of the problem (exact: 0.05 means 1/20)")
    for name, flag in _FLAGS.items():
        row = PARAMETERS[name]
        group.add_argument(flag, dest=name, metavar="X", help=f"{row.meaning}; {row.domain.describe(name)}")


def setting_from(arguments: argparse.Namespace) -> Setting:
    """The setting of all parameters that were given."""
    given = {name: getattr(arguments, name) for name in _FLAGS}
    return Setting(**{name: value for name, value in given.items() if value is not None})


def flag(name: str) -> str:
    """The command-line flag of a parameter; a table of counts has none.

    >>> flag("gamma_min")
    '--gamma-min'
    """
    return _FLAGS.get(name, f"(the table {name})")
