"""Finds the program and runs its commands."""

import functools
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from typing import IO, Any, Optional

from .base_options import StrPath
from .errors import (CommandError, CrashError, OptionError, ProgramNotFoundError,
                     StoppedError)
from .progress import ProgressCallback, parse_progress

# The program inside the package, if that was installed as a wheel of scripts/make_wheel.
_INSIDE = str(pathlib.Path(__file__).with_name("bin") / "colmap_ext")


def find_program(program: Optional[StrPath] = None) -> str:
    """The path of the program.

    program: a path or a name; default: the environment's COLMAP_EXT, else the one
        inside the package, else colmap_ext or else colmap of the PATH.
    Raises ProgramNotFoundError.
    """
    wanted = program or os.environ.get("COLMAP_EXT")
    for name in [os.fspath(wanted)] if wanted else [_INSIDE, "colmap_ext", "colmap"]:
        path = shutil.which(name)
        if path:
            return path
    raise ProgramNotFoundError(
        f"{wanted}: no such program" if wanted else
        "neither colmap_ext nor colmap is on the PATH; pass program=...")


@functools.lru_cache(maxsize=None)
def _options(program: str, command: str) -> dict[str, str]:
    """The options of a command: what stands behind -- by the name's last part."""
    shown = subprocess.run([program, command, "-h"], stdin=subprocess.DEVNULL,
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                           check=False, encoding="utf-8", errors="replace")
    names = re.findall(r"^  --([\w.]+)", shown.stdout, re.MULTILINE)
    if shown.returncode != 0 or not names:
        raise ProgramNotFoundError(f"{program} has no command {command}")
    options: dict[str, str] = {}
    for name in names:  # aliases come last
        options.setdefault(name.rpartition(".")[2], name)
    return options


def _text(value: Any) -> str:
    """A value as the program reads it."""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ",".join(map(str, value))
    return str(value)


def make_arguments(program: str, command: str, options: Mapping[str, Any]) -> list[str]:
    """The command line for options by their names without a section.

    Raises OptionError for those that this program does not have.
    """
    known = _options(program, command)
    for name in options:
        if name not in known:
            raise OptionError(f"{command} of {program} has no option {name}; it has "
                              + ", ".join(sorted(known)))
    return [program, command] + [
        f"--{known[name]}={_text(value)}" for name, value in options.items()]


def _last_line(errors: IO[bytes], default: str) -> str:
    """What the program says was wrong, or where it was interrupted."""
    errors.seek(0)
    lines = [line for line in errors.read().decode("utf-8", "replace").splitlines()
             if line.strip()]
    said = [line for line in lines if line.startswith(("ERROR: ", "Interrupted: "))]
    return said[-1].split(": ", 1)[1] if said else lines[-1] if lines else default


def _raise_failure(exit_code: int, line: str, arguments: list[str]) -> None:
    number = -exit_code if exit_code < 0 else exit_code - 128
    if number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL):
        raise StoppedError(line, exit_code, arguments)
    if exit_code == 1:
        raise CommandError(line, exit_code, arguments)
    raise CrashError(line, exit_code, arguments)


def _stop(process: "subprocess.Popen[str]", number: int) -> None:
    """Ends the program by a signal. The refiner ends after its iteration and keeps
    its complete levels; another Ctrl-C ends it at once."""
    while True:
        try:
            process.send_signal(number)
            for _ in process.stdout or ():
                pass
            process.wait()
            return
        except KeyboardInterrupt:
            pass


def run(arguments: list[str], progress: Optional[ProgressCallback] = None) -> None:
    """Runs a command line.

    progress: is called with each Progress. If it raises, the program is ended and the
        exception propagates.
    Raises CommandError, StoppedError or CrashError; KeyboardInterrupt at Ctrl-C, with
    the line that the program ends with.
    """
    with tempfile.TemporaryFile() as errors:
        # In a session of its own, the program does not get the terminal's Ctrl-C
        # besides the one that is passed on.
        with subprocess.Popen(arguments, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=errors, encoding="utf-8",
                              errors="replace", start_new_session=True) as process:
            try:
                for line in process.stdout or ():
                    shown = parse_progress(line) if progress else None
                    if shown and progress:
                        progress(shown)
            except KeyboardInterrupt:
                _stop(process, signal.SIGINT)
                raise KeyboardInterrupt(_last_line(errors, "")) from None
            except BaseException:
                _stop(process, signal.SIGTERM)
                raise
        if process.returncode != 0:
            line = _last_line(errors, f"ended with exit code {process.returncode}")
            _raise_failure(process.returncode, line, arguments)


def main() -> None:
    """The command colmap_ext of a wheel: runs the program inside the package."""
    os.execv(_INSIDE, [_INSIDE, *sys.argv[1:]])
