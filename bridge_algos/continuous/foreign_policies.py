"""Policies made elsewhere, in memory: torch modules. Files of torch are pickles, and are never loaded."""

from __future__ import annotations

from typing import Any

import numpy as np

from bridge_algos.continuous.needs import need
from bridge_algos.continuous.policies import Policy
from bridge_algos.mdp import FloatArray


def policy_from_module(module: Any) -> Policy:
    """A torch module in memory, from (m, d_s) observations to (m, d_a) actions, as a policy; its dtype is kept."""
    torch = need("torch")
    first = next(iter(module.parameters()), None)
    dtype = torch.float64 if first is None else first.dtype

    def act(observations: FloatArray) -> FloatArray:
        with torch.no_grad():
            return np.asarray(module(torch.from_numpy(observations).to(dtype)).cpu().numpy(), dtype=np.float64)

    return act
