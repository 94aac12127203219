"""The two tabular environments: does their code say what the figure and the text say?"""

from __future__ import annotations

import numpy as np

from proofs_checks.claim import Claim
from proofs_checks.evidence import agrees, mutant
from proofs_checks.outcome import Outcome, Tally

_DOUBLES = 1e-15


def star_arrows(*, success: float = 0.7, arrows: int = 8) -> Outcome:
    """The text variant of StarMDP moves along each solid arrow with 0.7 and else to one of the other states."""
    from bridge_algos.envs.star import star_mdp

    tally = Tally()
    kernel = star_mdp("text").transitions
    moving = [(s, a) for s in range(5) for a in range(4) if kernel[s, a, s] != 1]
    tally.expect(len(moving) == arrows, f"{len(moving)} pairs can move, the figure has {arrows} arrows")
    for s, a in moving:
        row = np.sort(kernel[s, a])
        expected = np.sort([0, success, *[(1 - success) / 3] * 3])
        tally.expect(np.abs(row - expected).max() < _DOUBLES, f"the row of s_{s}, a_{a} is {row}, not {expected}")
    return tally.outcome(f"{len(moving)} arrows, each row compared")


def gridworld_success(*, text: float = 0.8, published: float = 0.84) -> Outcome:
    """Where nothing is in the way, the chosen direction succeeds with 0.8 in the text's variant, 0.84 as published."""
    from bridge_algos.envs.gridworld import gridworld

    tally = Tally()
    for variant, success in (("text", text), ("published", published)):
        kernel = gridworld(variant).transitions[:, :4]
        # in an open cell the four directions lead to four different cells
        free = [s for s in range(16) if len(set(kernel[s].argmax(axis=1)) - {s}) == 4 and kernel[s, :, s].max() < 0.05]
        tally.expect(len(free) > 0, f"{variant}: no cell is open on all sides")
        for s in free:
            reached = kernel[s].max(axis=1)
            tally.expect(np.abs(reached - success).max() < _DOUBLES, f"{variant}: state {s} succeeds with {reached}")
    return tally.outcome("every cell with four open sides, both variants")


CLAIMS = (
    Claim(
        label="fig:starMDP",
        name="StarMDP",
        topic="experiments",
        verdict="definition",
        statement=r"""Five states, four actions, $H = 8$. Along a solid arrow
        $P(s' \mid s, a) = \tfrac{7}{10}$; otherwise the agent lands in one of the other states.""",
        because="""A definition. The kernel behind the published runs differs from it in the 12 impossible pairs: there
        an agent that should not move does move with probability 3/10.""",
        evidence=(
            agrees(
                "The variant called text follows the figure, pair by pair.",
                star_arrows,
                mutant("success 0.8", success=0.8),
                mutant("nine arrows", arrows=9),
            ),
        ),
    ),
    Claim(
        label="fig:gridworld",
        name="Gridworld",
        topic="experiments",
        verdict="undefined",
        statement=r"A $4 \times 4$ grid, $H = 10$; an action moves in its direction with probability $\tfrac{9}{10}$.",
        because="""The caption says 0.9, the text says 0.8, and the published runs use 0.84 on a transposed map, so
        that the figure does not determine an environment. Both readings are provided as variants.""",
        evidence=(
            agrees(
                "Neither the text's kernel (0.8) nor the published one (0.84) has the caption's 0.9.",
                gridworld_success,
                mutant("the caption's 0.9", text=0.9),
                mutant("the text's 0.8 in the published runs", published=0.8),
            ),
        ),
    ),
)
