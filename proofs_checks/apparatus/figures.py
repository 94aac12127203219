"""Figures and tables: drawings, and outcomes of experiments."""

from __future__ import annotations

from proofs_checks.claim import Claim, Verdict


def _shown(label: str, name: str, statement: str, because: str, verdict: Verdict = "empirical") -> Claim:
    return Claim(label, name, "experiments", verdict, statement, because)


_AGAIN = "It is measured, not proved; bridge-rl reproduce repeats the tabular ones."
_NOT_HERE = "It is measured, not proved, on a continuous environment."

CLAIMS = (
    _shown("fig:bridge_diagram", "overview", "A drawing of the framework.", "It states nothing.", "definition"),
    _shown("fig:proof_overview", "proof overview", "A drawing of which lemma serves which.", "It states nothing of its"
           " own; each lemma in it has its own entry.", "definition"),
    _shown("fig:regret_2x2", "regret against baselines", "BRIDGE has less cumulative regret than behavioural cloning"
           " and than PbRL on StarMDP, Gridworld, Reacher and Ant.", _AGAIN),
    _shown("fig:pisize_comparison", "size of the policy set", "BRIDGE prunes its set of policies sooner than PbRL on"
           " StarMDP and Reacher.", _AGAIN),
    _shown("fig:ablation_radius", "effect of the radius", "A larger radius approaches PbRL; one too small excludes the"
           " expert.", _NOT_HERE),
    _shown("tab:confidence_set_scaling", "effect of data on the offline set", "On Gridworld, 100 times the"
           " demonstrations shrink the offline set from 99.9 % to 8.0 % of the policies; noise weakens the effect.",
           _AGAIN),
    _shown("fig:ablation_offlinedata", "effect of demonstrations", "More demonstrations lower the regret of BRIDGE on"
           " Reacher.", _NOT_HERE),
    _shown("fig:ablation_embeddings", "effect of the embedding", "Embeddings nearer to the reward do better on"
           " Reacher.", _NOT_HERE),
)  # fmt: skip
