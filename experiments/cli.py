"""``bridge-rl``: one command, one subcommand per use, each resolved only when it is asked for."""

from __future__ import annotations

import errno
import importlib
import os
import sys

from bridge_theory.errors import ComputationError, InputError

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
    if name not in SUBCOMMANDS:
        known = ", ".join(SUBCOMMANDS)
        print(
            f"bridge-rl: unknown subcommand {name!r}; expected one of {known}; try 'bridge-rl --help'", file=sys.stderr
        )
        return 2
    module = importlib.import_module(SUBCOMMANDS[name][0])
    try:
        status = int(module.main(rest))
        sys.stdout.flush()
        return status
    except InputError as error:
        print(f"bridge-rl {name}: {error}", file=sys.stderr)
        return 2
    except ComputationError as error:
        print(f"bridge-rl {name}: {error}", file=sys.stderr)
        return 1
    except MemoryError as error:
        print(f"bridge-rl {name}: there is not enough memory ({error}); ask for something smaller", file=sys.stderr)
        return 1
    except BrokenPipeError:  # the reader, such as head, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            print(
                f"bridge-rl {name}: the disk is full; make room and run it again: finished parts are kept",
                file=sys.stderr,
            )
            return 1
        if error.filename is None:
            raise
        place = error.filename2 or error.filename  # of a move the place asked for, not the temporary file
        print(f"bridge-rl {name}: {place} cannot be used ({error.strerror}); choose another", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"bridge-rl {name}: interrupted; finished parts are kept", file=sys.stderr)
        return 130


def _overview() -> str:
    lines = ["usage: bridge-rl SUBCOMMAND [options]", "", "subcommands:"]
    lines += [f"  {name:<10} {help_text}" for name, (_, help_text) in SUBCOMMANDS.items()]
    return "\n".join([*lines, "", "'bridge-rl SUBCOMMAND --help' lists the options of one"])


if __name__ == "__main__":
    sys.exit(main())
