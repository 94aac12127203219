"""The one error a user's mistake raises: its text says what came in, what was expected and what to do."""


class InputError(ValueError):
    """A mistake in what the user passed. The command line prints its text as one sentence and exits with status 2."""


class UndefinedInPaperError(InputError):
    """The paper's text has no meaning at this point (log 0, empty counts); the message names the repaired form."""
