"""The arithmetic a formula is written over, and its three interpretations.

``FLOATS`` (NumPy, broadcasting), ``BALLS`` (python-flint, rigorous) and ``SYMBOLS`` (SymPy, loaded on first use).
Every formula of the package is an ordinary function ``f(m, *, S, A, ...)`` whose first argument is one of them.
"""

from __future__ import annotations

from bridge_theory.arithmetic.protocol import Arithmetic, Value

__all__ = ["Arithmetic", "Value"]
