r"""When to stop: a gap in nats, a share of the range, or a share of what there is to gain over a reference."""

from __future__ import annotations

import re
from dataclasses import dataclass

from bridge_theory.errors import InputError

FORMS = "'10%' of a declared range, '0.2nats', or 'share=90%' of what there is to gain over a reference"


@dataclass(frozen=True)
class Goal:
    r"""What a certificate must show.

    Args:
        text: as it was given.
        nats: the certified gap at which to stop; 0 when a share is asked for.
        rho: with a share 1/(1 + rho): :math:`U(\pi^*) - U(\hat\pi) \le \rho\,(U(\hat\pi) - U(\pi_0))`; 0 for a gap.
    """

    text: str
    nats: float
    rho: float = 0.0

    def describe(self) -> str:
        """In words.

        >>> goal("share=90%").describe()
        'at least 90 % of what there is to gain over the reference is gained'
        >>> goal("10%", utility_range=5).describe()
        'the recommended candidate is within 0.5 nats of the best (10 % of the range of 5 nats)'
        """
        if self.rho:
            return f"at least {100 / (1 + self.rho):.4g} % of what there is to gain over the reference is gained"
        words = f"the recommended candidate is within {self.nats:.4g} nats of the best"
        if not self.text.endswith("%"):
            return words
        percent = float(self.text[:-1])
        return f"{words} ({percent:.4g} % of the range of {self.nats / percent * 100:.4g} nats)"


def goal(text: str, utility_range: float | None = None) -> Goal:
    """The goal that a text names.

    Args:
        text: one of the three forms.
        utility_range: best minus worst utility over all policies, in nats; needed for a percentage of it.

    Raises:
        InputError: for another text, or a percentage without a range.

    >>> goal("0.2nats").nats
    0.2
    >>> goal("ten")
    Traceback (most recent call last):
    bridge_theory.errors.InputError: until must be '10%' of a declared range, '0.2nats', or 'share=90%' of what there
    is to gain over a reference, got 'ten'.
    """
    given = str(text).strip()
    match = re.fullmatch(r"(share=)?(\d+(?:\.\d*)?|\.\d+)\s*(%|nats)", given)
    if not match or (match[1] and match[3] != "%"):
        raise InputError(f"until must be {FORMS}, got {text!r}.")
    number = float(match[2])
    if match[3] == "nats":
        if not number > 0:
            raise InputError(f"until must be above 0 nats, got {text!r}.")
        return Goal(given, number)
    if not 0 < number < 100:
        raise InputError(f"the percentage in until must lie between 0 and 100, got {text!r}.")
    if match[1]:
        return Goal(given, 0.0, rho=100 / number - 1)
    if utility_range is None:
        raise InputError(f"until={text!r} is a percentage of the range of utilities; declare the range, in nats.")
    return Goal(given.replace(" ", ""), number / 100 * utility_range)
