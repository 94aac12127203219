"""``bridge-rl bounds``, with the data-dependent bounds of a demonstrations file where one is given."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from bridge_theory.cli.bounds import main as bounds_of_a_setting
from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError
from bridge_theory.parameters import to_exact
from bridge_theory.value import BoundValue

if TYPE_CHECKING:
    from bridge_algos.offline.transitions import EmptyRow


def main(argv: list[str]) -> int:
    """``bridge-rl bounds``; ``--demos FILE --mdp FILE_OR_NAME`` adds what those demonstrations certify by themselves.

    Sizes that the files show (S, A, H, n) are filled in; others are refused. Without ``--demos`` nothing but
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
    delta = _flag_value(rest, "--delta") or "0.05"
    sizes, values, note = _from_data(options.demos, options.mdp, options.empty_row, delta)
    for flag, size in (sizes | {"--delta": delta}).items():
        given = _flag_value(rest, flag)
        if given is None:
            rest += [flag, str(size)]
        elif flag != "--delta" and to_exact(flag, given) != size:
            raise InputError(f"{flag} {given} contradicts the files, which show {size}; leave it out.")
    status = bounds_of_a_setting(rest, values)
    if {"--json", "--latex"} & set(rest):
        print(note, file=sys.stderr)
    else:
        print(f"\n{note}")
    return status


def _from_data(demos: str, mdp: str, empty_row: EmptyRow, delta: str) -> tuple[dict[str, int], list[BoundValue], str]:
    """The sizes that the files show, the values that the demonstrations certify, and what to know about them."""
    from bridge_algos.demonstrations import load_demonstrations
    from bridge_algos.mdp_file import load_mdp
    from bridge_algos.offline.data_bounds import bounds_from_demonstrations
    from bridge_algos.offline.step_counts import step_counts
    from bridge_theory.from_data import contradicted_states

    world = load_mdp(mdp)
    s, a, h = world.n_states, world.n_actions, world.horizon
    data = load_demonstrations(demos, world)
    values = bounds_from_demonstrations(world, data, delta=delta, empty_row=empty_row)
    note = f"From {len(data)} demonstrations, with delta = {delta} in each bound."
    if "offline_radius_mass" in values:
        rows = {"uniform": "uniform", "self_loop": "self-loops"}[empty_row]
        note += f" In offline_radius_mass rows without data are {rows}, and the clone takes the first action there."
    contradicted = contradicted_states(step_counts(data, s, a).visits).tolist()
    if contradicted:
        note += (
            f" They refute a deterministic stationary expert, for {len(contradicted)} of {s} states show more than one "
            f"action, {world.state_names[contradicted[0]]!r} first; bounds that assume one are left out here and say "
            "nothing about this expert above."
        )
    return {"--S": s, "--A": a, "--H": h, "--n": len(data)}, list(values.values()), note


def _flag_value(arguments: list[str], flag: str) -> str | None:
    for position, text in reversed(list(enumerate(arguments))):  # of two the parser takes the last
        if text == flag and position + 1 < len(arguments):
            return arguments[position + 1]
        if text.startswith(f"{flag}="):
            return text.split("=", 1)[1]
    return None
