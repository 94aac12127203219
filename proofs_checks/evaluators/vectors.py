"""Instances that are one vector."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from proofs_checks.counterexample import Number, evaluates


@evaluates("squared-norm-against-dimension")
def squared_norm_against_dimension(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """``||x||^2`` and the number of coordinates of x."""
    vector = [Fraction(x) for x in data["vector"]]
    return sum((x * x for x in vector), Fraction(0)), Fraction(len(vector))
