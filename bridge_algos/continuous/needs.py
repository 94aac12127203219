"""Packages of the extras ``continuous`` and ``sb3``, imported when they are used; a missing one gets a sentence."""

from __future__ import annotations

import importlib
from typing import Any

from bridge_theory.errors import InputError


def need(module: str, extra: str = "continuous") -> Any:
    """Import a module of an optional extra.

    Raises:
        InputError: it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise InputError(
            f"this needs the package {module.partition('.')[0]!r}, which cannot be imported ({error}); install it with "
            f"pip install 'bridge-rl[{extra}]'."
        ) from None
