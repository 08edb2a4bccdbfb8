"""What can go wrong when the program is run."""

from collections.abc import Iterable
from typing import Optional


class ColmapExtError(RuntimeError):
    """A run of the program that failed.

    line: what the program says is wrong, or what was wrong before it ran.
    exit_code: of the program, -N for signal N; None if it did not run.
    arguments: the command line; empty if there is none.
    """

    def __init__(self, line: str, exit_code: Optional[int] = None,
                 arguments: Iterable[str] = ()) -> None:
        super().__init__(line)
        self.line = line
        self.exit_code = exit_code
        self.arguments = list(arguments)


class ProgramNotFoundError(ColmapExtError):
    """There is no such program, or it has not our commands."""


class OptionError(ColmapExtError):
    """The program has no such option; it is of another version."""


class CommandError(ColmapExtError):
    """The program refused its input or a value of an option; exit code 1."""


class StoppedError(ColmapExtError):
    """A signal ended the program."""


class CrashError(ColmapExtError):
    """The program ended in a way that it should not."""
