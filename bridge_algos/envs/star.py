r"""StarMDP: a hub with four spokes (appendix "Environments" of the paper, figure ``fig:starMDP``)."""

from __future__ import annotations

import numpy as np

from bridge_algos.envs.published import check_variant, published_mdp
from bridge_algos.mdp import FloatArray, TabularMDP

ACTIONS = ("right", "left", "up", "down")
SUCCESS = 0.7

_ARROWS = {
    (0, "right"): 1,
    (1, "right"): 2,
    (1, "left"): 0,
    (1, "up"): 4,
    (1, "down"): 3,
    (2, "left"): 1,
    (3, "up"): 1,
    (4, "down"): 1,
}
"""The solid arrows of the figure: (state, action) -> state."""


def star_mdp(variant: str = "published") -> TabularMDP:
    r"""StarMDP with S = 5, A = 4, H = 8, starting in s_0; arriving in s_2, s_3, s_4 pays 6, -1, 10.

    Source: appendix "Environments" (figure and text) for ``"text"``; the authors' published runs for ``"published"``.

    How the text is read. "Actions have a probability of 0.7 of success, with an agent being moved to a different,
    random state with a probability of 0.3", and the caption's "one of the other states": the failure goes to one of the
    three states that are neither the present one nor the arrow's head, with probability 0.1 each,

    .. math:: P(s' \mid s, a) = 0.7 \cdot 1[s' = f(s, a)] + 0.1 \cdot 1[s' \notin \{s, f(s, a)\}].

    "Taking an impossible action ... will result in not moving with probability 1": a pair without an arrow stays, and
    cannot fail. Rewards are paid on arrival, as in the published runs, so that the first state pays nothing.

    Where ``"published"`` differs. Horizon, start, rewards and the 8 pairs with an arrow agree. The 12 impossible pairs
    do not: there the agent stays with probability 0.7 only; one other state has probability 0 and the remaining three
    0.1 each. The state left out is

    ======  ======  ======  ======  ======
    in      right   left    up      down
    ======  ======  ======  ======  ======
    s_0     arrow   s_1     s_2     s_3
    s_2     s_4     arrow   s_4     s_3
    s_3     s_2     s_1     arrow   s_4
    s_4     s_2     s_1     s_3     arrow
    ======  ======  ======  ======  ======

    Hence in ``"text"`` an agent can wait in s_4 and collect 10 in each step with certainty, in ``"published"`` only
    with probability 0.7.

    Raises:
        InputError: for another variant.

    >>> star_mdp("text").transitions[0, 0]
    array([0. , 0.7, 0.1, 0.1, 0.1])
    >>> star_mdp("text").transitions[4, 1], star_mdp("published").transitions[4, 1]
    (array([0., 0., 0., 0., 1.]), array([0.1, 0. , 0.1, 0.1, 0.7]))
    """
    check_variant(variant)
    if variant == "published":
        return published_mdp("StarMDP")
    return TabularMDP(
        transitions=_text_transitions(),
        initial=np.eye(5)[0],
        horizon=8,
        reward=np.array([0.0, 0.0, 6.0, -1.0, 10.0]),
        name="StarMDP (text)",
        action_names=ACTIONS,
        axes="state-action",
        reward_on="arrival",
    )


def _text_transitions() -> FloatArray:
    kernel = np.zeros((5, len(ACTIONS), 5))
    for state in range(5):
        for action, direction in enumerate(ACTIONS):
            head = _ARROWS.get((state, direction))
            if head is None:
                kernel[state, action, state] = 1.0
            else:
                kernel[state, action] = 0.1
                kernel[state, action, [state, head]] = 0.0, SUCCESS
    return kernel
