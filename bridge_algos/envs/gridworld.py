r"""Gridworld: 4 x 4 cells with an enclosed prize (appendix "Environments" of the paper, figure ``fig:gridworld``)."""

from __future__ import annotations

import numpy as np

from bridge_algos.envs.grid import DIRECTIONS, NO_CELL, cell_names, move_targets
from bridge_algos.envs.published import check_variant, published_mdp
from bridge_algos.mdp import FloatArray, TabularMDP

ACTIONS = (*DIRECTIONS, "stay")
SUCCESS = 0.8

LAYOUTS = {
    "text": ("S.--", "..--", ".#..", "...G"),
    "published": ("S...", "..#.", "--..", "--.G"),
}
"""S start, G goal (10), - negative region (-1), # the enclosed cell (20)."""

_REWARDS = {"S": 0.0, ".": 0.0, "-": -1.0, "#": 20.0, "G": 10.0}


def gridworld(variant: str = "published") -> TabularMDP:
    r"""Gridworld with S = 16 (reading order), A = 5 (left, right, up, down, stay), H = 10, from the top left corner.

    Source: appendix "Environments" (figure and text) for ``"text"``; the authors' published runs for ``"published"``.

    How the text is read.

    - Success probability: the text says 0.8, the caption "transition probabilities are 0.9". The text is followed.
    - "With probability 0.2 a randomly chosen different action is executed": one of the other three of "the four actions
      (up, left, down, right)" that the sentence speaks of, each with probability 0.2/3; ``stay`` is not among them.
    - "Transitions beyond the grid limits or through obstacles have probability zero, with the remainder of the
      probability mass for each action being distributed among other directions equally": with q(d | a) the law of the
      direction executed and D(s) the directions open in s,

      .. math:: P(s + d \mid s, a) = q(d \mid a) + \frac{1}{|D(s)|} \sum_{d' \notin D(s)} q(d' \mid a), \; d \in D(s).

      A blocked agent therefore moves elsewhere; it never stays in place by bumping into something.
    - "Stay remains in the current state with probability 1": it cannot fail.
    - The "high-reward but unreachable state" is the cell in thick lines, row 2, column 1 (state 9). It is closed from
      both sides; nothing open remains to move to, so each action stays there with probability 1.
    - "Negative-reward region in the top-right corner": states 2, 3, 6, 7, as drawn. The goal (state 15) does not end
      the episode; each arrival there, by ``stay`` too, pays 10. Rewards are paid on arrival, as in the published runs.

    Where ``"published"`` differs. Horizon, start, actions and goal agree; nothing else does:

    - The picture is transposed: the negative region is the bottom *left* corner (states 8, 9, 12, 13) and the enclosed
      cell is row 1, column 2 (state 6), while the actions keep their directions.
    - With probability 0.2 an action drawn uniformly from all *five* is executed, the chosen one and ``stay`` included:
      each other action has probability 0.04, the chosen one 0.84.
    - ``stay`` fails like any other action.
    - A blocked move stays in place, and keeps its probability there.

    Consequently 79 of the 80 rows of the two kernels differ; (state 6, ``stay``) agrees.

    Raises:
        InputError: for another variant.

    >>> gridworld("text").transitions[0, 0, [0, 1, 4]]
    array([0. , 0.5, 0.5])
    >>> gridworld("published").transitions[0, 0, [0, 1, 4]]
    array([0.92, 0.04, 0.04])
    """
    check_variant(variant)
    layout = LAYOUTS[variant]
    if variant == "published":
        return published_mdp("Gridworld", layout=layout, state_names=cell_names(layout))
    return TabularMDP(
        transitions=_text_transitions(),
        initial=np.eye(16)[0],
        horizon=10,
        reward=np.array([_REWARDS[character] for row in layout for character in row]),
        name="Gridworld (text)",
        action_names=ACTIONS,
        state_names=cell_names(layout),
        layout=layout,
        axes="state-action",
        reward_on="arrival",
    )


def _text_transitions() -> FloatArray:
    targets = move_targets(LAYOUTS["text"])
    n_states, n_directions = targets.shape
    executed = np.full((n_directions, n_directions), (1 - SUCCESS) / (n_directions - 1))
    np.fill_diagonal(executed, SUCCESS)
    kernel = np.zeros((n_states, len(ACTIONS), n_states))
    kernel[:, ACTIONS.index("stay")] = np.eye(n_states)
    for state in range(n_states):
        is_open = targets[state] != NO_CELL
        if not is_open.any():
            kernel[state, :, state] = 1.0
            continue
        blocked_mass = executed[:, ~is_open].sum(axis=1, keepdims=True)
        kernel[state, :n_directions, targets[state, is_open]] = (executed[:, is_open] + blocked_mass / is_open.sum()).T
    return kernel
