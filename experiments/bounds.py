"""``bridge-rl bounds``, with the data-dependent bounds of a demonstrations file where one is given."""

from __future__ import annotations

from bridge_theory.cli.bounds import main as bounds_of_a_setting
from bridge_theory.cli.options import Parser
from bridge_theory.value import BoundValue


def main(argv: list[str]) -> int:
    """``bridge-rl bounds``; ``--demos FILE --mdp FILE_OR_NAME`` adds what those demonstrations certify by themselves.

    Sizes that the files show (S, A, H, n) are filled in unless they are given. Without ``--demos`` nothing but
    ``bridge_theory`` is loaded.
    """
    p = Parser(prog="bridge-rl bounds", add_help=False, allow_abbrev=False)
    p.add_argument("--demos", metavar="FILE")
    p.add_argument("--mdp", metavar="FILE_OR_NAME")
    p.add_argument("--empty-row", choices=("self_loop", "uniform"), default="uniform")
    options, rest = p.parse_known_args(argv)
    if options.demos is None and options.mdp is None:
        if "-h" in rest or "--help" in rest:
            print("from data: --demos FILE.npz --mdp FILE.npz|NAME [--empty-row self_loop|uniform]; otherwise:\n")
        return bounds_of_a_setting(rest)
    if options.demos is None or options.mdp is None:
        p.error("--demos and --mdp belong together")
    sizes, values = _from_data(options.demos, options.mdp, options.empty_row, _flag_value(rest, "--delta") or "0.05")
    for flag, size in sizes.items():
        if _flag_value(rest, flag) is None:
            rest += [flag, str(size)]
    return bounds_of_a_setting(rest, values)


def _from_data(demos: str, mdp: str, empty_row: str, delta: str) -> tuple[dict[str, int], list[BoundValue]]:
    import numpy as np

    from bridge_algos.hellinger import disagreement_probability
    from bridge_algos.mdp_file import load_mdp
    from bridge_algos.offline.cloning import clone_deterministic
    from bridge_algos.offline.step_counts import step_counts
    from bridge_algos.offline.transitions import estimate_transitions
    from bridge_algos.trajectories import load_trajectories
    from bridge_theory.from_data import bounds_from_counts

    world = load_mdp(mdp)
    s, a, h = world.n_states, world.n_actions, world.horizon
    data = load_trajectories(demos, s, a, h)
    counts = step_counts(data, s, a)
    estimate = world.dynamics.under(
        estimate_transitions(counts.pooled, "self_loop" if empty_row == "self_loop" else "uniform")
    )
    unvisited = (counts.pairs.sum(axis=1) == 0).astype(np.float64)[None]
    mass = disagreement_probability(estimate, clone_deterministic(counts.pairs, tie_break="first"), unvisited)[0]
    values = bounds_from_counts(counts.visits, counts.transitions, delta=delta, mass=float(mass))
    return {"--S": s, "--A": a, "--H": h, "--n": len(data)}, list(values.values())


def _flag_value(arguments: list[str], flag: str) -> str | None:
    for position, text in enumerate(arguments):
        if text == flag and position + 1 < len(arguments):
            return arguments[position + 1]
        if text.startswith(f"{flag}="):
            return text.split("=", 1)[1]
    return None
