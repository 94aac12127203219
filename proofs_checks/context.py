"""What a check may know about the run it is part of: fast or full, and its own random numbers."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

Amount = TypeVar("Amount")


@dataclass(frozen=True)
class Context:
    """One run of one check. Its randomness depends on ``seed`` and the check's name only, not on the other checks."""

    quick: bool = False
    seed: int = 0
    name: str = ""

    def pick(self, *, quick: Amount, full: Amount) -> Amount:
        """The amount of work for this mode: ``context.pick(quick=50, full=2000)``."""
        return quick if self.quick else full

    def rng(self) -> np.random.Generator:
        """A fresh generator, the same at every call."""
        return np.random.default_rng([self.seed, zlib.crc32(self.name.encode())])
