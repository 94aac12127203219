"""``bridge-rl``: one command, one subcommand per use, each resolved only when it is asked for."""

from __future__ import annotations

import importlib
import sys

from bridge_theory.cli.status import exit_status

SUBCOMMANDS = {
    "run": ("bridge_algos.run.cli", "run BRIDGE, PbRL and BC on an environment, tabular or of MuJoCo"),
    "watch": ("bridge_algos.continuous.watch", "animate expert, clone and learned policies of a MuJoCo run"),
    "compare": ("experiments.compare.cli", "empirical regret beside every version of the theory"),
    "reproduce": ("experiments.reproduce", "reproduce the paper's figures, beside the published ones"),
    "expert": ("bridge_algos.continuous.expert_cli", "train, evaluate and record experts for MuJoCo Reacher and Ant"),
    "report": ("experiments.report.cli", "runs and reproductions as one self-contained page"),
    "bounds": ("experiments.bounds", "evaluate the paper's bounds for a setting"),
    "ask": ("bridge_algos.asking.cli", "ask preference questions until the answers certify a policy"),
    "verify": ("proofs_checks.verify.cli", "does a run's log prove its regret bounds?"),
    "check": ("proofs_checks.cli", "is each statement of the paper true? run the machine evidence"),
    "plan": ("experiments.plan", "how many demonstrations and questions a target needs"),
}


def main(argv: list[str] | None = None) -> int:
    """Run one subcommand; status 0: success, 1: failed computation, 2: a user's mistake, 130: interrupted."""
    arguments = sys.argv[1:] if argv is None else list(argv)
    if not arguments or arguments[0] in ("-h", "--help"):
        print(_overview())
        return 0
    name, *rest = arguments
    if name == "--version":
        from bridge_algos.run.versions import package_versions

        print(f"bridge-rl {package_versions()['bridge-rl']}")
        return 0
    if name not in SUBCOMMANDS:
        known = ", ".join(SUBCOMMANDS)
        print(
            f"bridge-rl: unknown subcommand {name!r}; expected one of {known}; try 'bridge-rl --help'", file=sys.stderr
        )
        return 2
    return exit_status(f"bridge-rl {name}", importlib.import_module(SUBCOMMANDS[name][0]).main, rest)


def _overview() -> str:
    lines = ["usage: bridge-rl SUBCOMMAND [options]", "", "subcommands:"]
    lines += [f"  {name:<10} {help_text}" for name, (_, help_text) in SUBCOMMANDS.items()]
    lines += ["", "'bridge-rl SUBCOMMAND --help' lists the options of one; --version prints the version"]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
