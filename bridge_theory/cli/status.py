"""How a command ends: a user's mistake is a sentence and a status, never a traceback."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Callable, Sequence

from bridge_theory.errors import ComputationError, InputError


def exit_status(program: str, command: Callable[[list[str]], int], arguments: Sequence[str]) -> int:
    """Run a command; status 0: success, 1: failed computation, 2: a user's mistake, 130: interrupted.

    Args:
        program: how the command was called; it begins every sentence.
        command: takes the arguments and returns its status.
        arguments: what follows the program's name.
    """

    def sentence(text: str) -> None:
        print(f"{program}: {text}", file=sys.stderr)

    try:
        status = int(command(list(arguments)))
        sys.stdout.flush()
        return status
    except InputError as error:
        sentence(str(error))
        return 2
    except ComputationError as error:
        sentence(str(error))
        return 1
    except MemoryError as error:
        sentence(f"there is not enough memory ({error}); ask for something smaller")
        return 1
    except BrokenPipeError:  # the reader, such as head, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            sentence("the disk is full; make room and run it again: finished parts are kept")
            return 1
        if error.filename is None:
            raise
        place = error.filename2 or error.filename  # of a move the place asked for, not the temporary file
        sentence(f"{place} cannot be used ({error.strerror}); choose another")
        return 2
    except KeyboardInterrupt:
        sentence("interrupted; finished parts are kept")
        return 130
