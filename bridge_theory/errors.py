"""The errors that end in one sentence: a user's mistake, and a computation that failed and says so."""


class InputError(ValueError):
    """A mistake in what the user passed. The command line prints its text as one sentence and exits with status 2."""


class UndefinedInPaperError(InputError):
    """The paper's text has no meaning at this point (log 0, empty counts); the message names the repaired form."""


class ComputationError(RuntimeError):
    """A computation that failed or could not be certified, by no mistake of the user's; exit status 1."""
