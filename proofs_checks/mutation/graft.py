"""Put a mutated module in the place of the one that is loaded, in this process."""

from __future__ import annotations

import sys
from types import FunctionType

from bridge_theory.formula import Formula
from proofs_checks.mutation.sites import Site, mutated


def graft(site: Site) -> None:
    """Run the mutated source and hand its meaning to the objects that other modules already hold.

    Only ever called in a process that is thrown away afterwards.
    """
    module = sys.modules[site.module]
    fresh = {"__name__": site.module, "__file__": str(site.path)}
    exec(compile(mutated(site), str(site.path), "exec"), fresh)
    for name, value in fresh.items():
        known = getattr(module, name, None)
        if isinstance(known, Formula) and isinstance(value, Formula):
            known.__dict__.update(value.__dict__)
        elif isinstance(known, FunctionType) and isinstance(value, FunctionType) and known.__module__ == site.module:
            known.__code__ = value.__code__
            known.__defaults__, known.__kwdefaults__ = value.__defaults__, value.__kwdefaults__
        elif known is not None and not name.startswith("__") and not callable(known):
            setattr(module, name, value)
