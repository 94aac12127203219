"""The tables of embeddings: dimensions and norm bounds."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

from proofs_checks.claim import Claim
from proofs_checks.evidence import exact, mutant, refuted
from proofs_checks.outcome import Outcome, Tally

_SIZES = ((2, 2, 3), (3, 2, 2), (1, 2, 4))


def discrete_bounds(*, long: Fraction = Fraction(2), short: Fraction = Fraction(2), final: int = 1) -> Outcome:
    """Over all trajectories, max ||phi||^2 is 2H, 2H^2, H^2, 1, and the lengths are those of the table."""
    import numpy as np

    from bridge_algos.embeddings import make_embedding
    from bridge_algos.trajectories import Trajectories

    tally = Tally()
    for S, A, H in _SIZES:
        paths = list(product(product(range(S), repeat=H), product(range(A), repeat=H)))
        everything = Trajectories(np.array([s for s, _ in paths]), np.array([a for _, a in paths]))
        table = {
            "identity_long": (H * (S + A), long * H),
            "identity_short": (S + A, short * H**2),
            "state_counts": (S, Fraction(H**2)),
            "final_state": (S, Fraction(final)),
        }
        for name, (dimension, square) in table.items():
            embedding = make_embedding(name, S, A, H)
            features = embedding.of_trajectories(everything).astype(int)  # sums of one-hot vectors: integers
            largest = int((features**2).sum(axis=1).max())
            where = f"{name} at S={S}, A={A}, H={H}"
            tally.expect(largest == square, f"{where}: max of the squared norm is {largest}, not {square}")
            tally.expect(features.shape[1] == dimension, f"{where}: d is {features.shape[1]}, not {dimension}")
            gap = abs(Fraction(embedding.bound) ** 2 - square)
            tally.expect(gap < Fraction(1, 10**12), f"{where}: the code's bound is {embedding.bound}")
    return tally.outcome("every trajectory of three sizes")


CLAIMS = (
    Claim(
        label="tab:discrete_embeddings",
        name="tabular embeddings",
        topic="experiments",
        verdict="true",
        statement=r"""With one-hot states and actions, over the $H$ pairs of a trajectory:
        identity_long has $d = H(S+A)$, $B = \sqrt{2H}$; identity_short has $d = S+A$, $B = \sqrt 2 H$;
        state_counts has $d = S$, $B = H$; final_state has $d = S$, $B = 1$.""",
        because="Each bound is attained: by any trajectory, by one that repeats a pair, by one that stays.",
        assumptions=(
            r"A trajectory has the $H$ pairs of the main text; the table's indices $0, \dots, H$ are one more.",
        ),
        evidence=(
            exact(
                "Largest norm and dimension over all trajectories of three sizes.",
                discrete_bounds,
                mutant("the long norm without its 2", long=Fraction(1)),
                mutant("the short norm without its 2", short=Fraction(1)),
                mutant("final state with norm 2", final=4),
            ),
        ),
        proof=r"""$\lVert (e_{s_1}, e_{a_1}, \dots, e_{s_H}, e_{a_H}) \rVert^2 = 2H$. By the triangle inequality
        $\lVert \sum_h (e_{s_h}, e_{a_h}) \rVert \le \sqrt 2 H$, with equality if the pair never changes.""",
    ),
    Claim(
        label="tab:continuous_embeddings",
        name="continuous embeddings",
        topic="experiments",
        verdict="false",
        statement=r"""The average state-action embedding has $B = \sqrt{\dim s + \dim a}$, the final state
        $B = \sqrt{\dim s}$, the reward features of Reacher $B = 2\sqrt 2$.""",
        because=r"""The first two need coordinates in $[-1, 1]$. Observations of Reacher and Ant contain velocities,
        which no such bound holds for.""",
        evidence=(refuted("apparatus-unbounded-observation"),),
    ),
)
