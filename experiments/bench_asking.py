"""Rows of ``make bench`` about asking: what a question costs, from ``ask`` to its certificate, in CPU time."""

from __future__ import annotations

import time

import numpy as np
from scipy.special import expit

from bridge_algos.asking.elicitation import Ball, Elicitation
from bridge_algos.mdp import FloatArray

NEVER = "0.001nats"
"""A goal that no session here reaches: every contender stays to be looked at."""


def question_seconds(candidates: int, dimension: int, answers: int, timed: int) -> float:
    """Median CPU seconds of ask, tell and certificate together, after so many answers of a Bradley-Terry teacher.

    Args:
        candidates: random feature vectors, all distinct.
        dimension: d.
        answers: given before the clock starts.
        timed: questions that are timed.
    """
    rng = np.random.default_rng(4)
    truth = rng.normal(size=dimension)
    truth /= np.linalg.norm(truth)
    features = rng.normal(size=(candidates, dimension))
    session = Elicitation(features, Ball(2.0), rng.normal(size=(2000, dimension)), 0.05, NEVER, rng, fresh=True)
    for _ in range(answers):
        _one_question(session, truth, rng)
    times = []
    for _ in range(timed):
        start = time.process_time()
        _one_question(session, truth, rng)
        assert not session.certificate.certified
        times.append(time.process_time() - start)
    return float(np.median(times))


def _one_question(session: Elicitation, truth: FloatArray, rng: np.random.Generator) -> None:
    question = session.ask()
    session.tell(question, int(rng.random() < expit(question.difference @ truth)))
