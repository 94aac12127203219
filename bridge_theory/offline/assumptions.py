"""The hypotheses that the offline statements share, worded once."""

INDEPENDENT = "the demonstrations are independent trajectories of the expert"
DETERMINISTIC = "the expert is deterministic and stationary"
STATIONARY = "the transition kernel is stationary"
REALIZABLE = "the truth is in the class that is fitted"
MINIMUM_VISITATION = "every state-action pair the expert visits at a step has probability at least gamma_min there"
BOUNDED_FEATURES = "a trajectory's features have Euclidean norm at most B"
COUNT_ESTIMATE = "transitions are estimated by counts for each step, and the first state by its frequency"
