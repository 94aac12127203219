"""Files of chosen and rejected items: which of the two is shown first must not depend on the answer.

"Chosen first" makes every answer 1 and hides it in the order. The likelihood of the linear model and the forecasters
here treat both orders alike; anything else that reads the pairs (a table by position, an intercept) is misled.
"""

from __future__ import annotations

import hashlib

from bridge_theory.errors import InputError


def orient(chosen: str, rejected: str) -> tuple[str, str, int]:
    """The pair as a question and its answer, oriented by a hash of both identifiers.

    Args:
        chosen, rejected: identifiers of the two items, which must not tell which one was chosen.

    Returns:
        First item, second item, and the answer: 1 when the first one was chosen.

    Raises:
        InputError: when both are the same.

    >>> orient("a", "b"), orient("b", "a")
    (('b', 'a', 0), ('b', 'a', 1))
    """
    if chosen == rejected:
        raise InputError(f"a pair must have two different items, got {chosen!r} twice.")
    low, high = sorted((chosen, rejected))
    # the length keeps apart the pairs ("a", "bc") and ("ab", "c")
    coin = hashlib.sha256(f"{len(low)}:{low}{high}".encode()).digest()[0] & 1
    first, second = (low, high) if coin else (high, low)
    return first, second, int(first == chosen)
