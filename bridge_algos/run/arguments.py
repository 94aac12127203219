"""Command-line arguments whose mistakes are told like all others: in one sentence, with exit status 2."""

from __future__ import annotations

import argparse
from typing import NoReturn

from bridge_theory.errors import InputError


class Parser(argparse.ArgumentParser):
    """An argument parser that raises InputError instead of printing its usage and exiting."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message}; try '{self.prog} --help'.")
