"""The shapes that arrays have here, by name: checked at run time in the tests, read by people everywhere.

Axes: N policies, S states, A actions, H steps, d features, m comparisons. Within one call the same letter means the
same number.
"""

import numpy as np
from jaxtyping import Bool, Float, Int

Kernel = Float[np.ndarray, "S A S"]
"""P(s'|s, a), rows that sum to one."""
TransitionCounts = Int[np.ndarray, "S A S"]
"""N(s, a, s')."""
PairCounts = Int[np.ndarray, "S A"]
"""N(s, a)."""
PairTable = Float[np.ndarray, "S A"]
"""One number a state-action pair."""
Policy = Int[np.ndarray, " S"]
"""A deterministic stationary policy."""
Policies = Int[np.ndarray, "N S"]
"""A batch of deterministic stationary policies."""
PolicyStates = Float[np.ndarray, "N S"]
"""One number a policy and state."""
Occupancies = Float[np.ndarray, "N H S"]
"""d_h(s) of each policy."""
Features = Float[np.ndarray, "N d"]
"""One feature vector a policy."""
PerPolicy = Float[np.ndarray, " N"]
"""One number a policy."""
PerChallenger = Float[np.ndarray, " M"]
"""One number a challenger, of which there may be another number than of policies."""
Kept = Bool[np.ndarray, " N"]
"""Whether each policy belongs."""
Weights = Float[np.ndarray, " d"]
"""Preference weights w."""
DataMatrix = Float[np.ndarray, "d d"]
"""V, positive definite."""
Comparisons = Float[np.ndarray, "m d"]
"""Feature differences x_l, one row a comparison."""
Outcomes = Float[np.ndarray, " m"]
"""Answers o_l in [0, 1]."""
