"""End to end: certificates from rollouts and answers are wrong no more often than is said; without errors they are."""

import numpy as np
import pytest
from scipy.special import expit
from scipy.stats import binom

from bridge_algos.asking.elicitation import Ball, Elicitation
from bridge_algos.asking.feature_errors import ball_errors
from bridge_algos.asking.rollout_estimates import paired_estimate
from bridge_theory.errors import InputError

SESSIONS, DELTA, UNLIKELY = 16, 0.02, 1e-7
ALLOWED = binom.ppf(1 - UNLIKELY, SESSIONS, DELTA)
"""Wrong certificates of as many sessions of a sound method, but with chance UNLIKELY."""


def _wrong_and_certified(n: int, questions: int, goal: float, with_errors: bool) -> tuple[int, int]:
    """Of SESSIONS sessions, how many wrong certificates, and how many certificates there are."""
    wrong = certified = 0
    for seed in range(SESSIONS):
        rng = np.random.default_rng(seed)
        truth = 3 * rng.choice([-1.0, 1.0], size=3)
        expected = 0.3 + 0.4 * rng.random((8, 3))
        samples = (rng.random((n, 3)) < expected[:, None]).astype(np.float64)  # the same random numbers for all
        estimate = paired_estimate(samples, np.sqrt(3), 0.2 * DELTA)
        session = Elicitation(
            estimate.features,
            Ball(2 * float(np.linalg.norm(truth))),
            rng.random((80, 3)),
            0.8 * DELTA if with_errors else DELTA,
            f"{goal}nats",
            rng,
            fresh=True,
            errors=estimate.errors if with_errors else ball_errors(np.zeros(len(expected))),
        )
        while not session.done and len(session.history) < questions:
            question = session.ask()
            session.tell(question, int(rng.random() < expit(question.difference @ truth)))
        utilities = expected @ truth
        certified += session.certified
        wrong += session.certified and bool(utilities.max() - utilities[session.recommended] > goal)
    return wrong, certified


def test_certificates_with_errors_are_right() -> None:
    wrong, certified = _wrong_and_certified(8000, 60, 0.6, with_errors=True)
    assert certified > SESSIONS // 2
    assert wrong <= ALLOWED


def test_certificates_that_ignore_errors_are_wrong_and_those_that_do_not_are_withheld() -> None:
    assert _wrong_and_certified(2, 60, 0.3, with_errors=False)[0] > ALLOWED
    assert _wrong_and_certified(2, 3, 0.3, with_errors=True)[1] == 0


@pytest.mark.parametrize(
    ("shape", "reach", "delta", "words"),
    [
        ((3, 1, 2), 2.0, 0.1, "shape"),
        ((3, 4), 2.0, 0.1, "shape"),
        ((3, 40, 2), 2.0, 0.0, "delta"),
        ((3, 40, 2), 0.01, 0.1, "reach"),
    ],
)
def test_samples_that_cannot_be_used_are_refused(
    shape: tuple[int, ...], reach: float, delta: float, words: str
) -> None:
    with pytest.raises(InputError, match=words):
        paired_estimate(np.random.default_rng(0).random(shape), reach, delta)
