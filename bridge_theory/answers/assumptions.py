"""What the statements about certified answers assume, in one place."""

from __future__ import annotations

ANSWERS = (
    "each question is fixed before its answer, and the answer follows the Bradley-Terry model with the true weights",
    "answers enter in an order fixed without looking at them, and a skipped question does not depend on its answer",
)
PRIOR = "the prior scales are fixed before the first answer"
BALL = "the true weights have norm at most W"
LIKELIHOOD_SET = "the true weights lie in the likelihood set"
OFFLINE_SET = "the best policy is one of the candidates"
