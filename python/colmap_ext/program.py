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

from .errors import (CommandError, CrashError, OptionError, ProgramNotFoundError,
                     StoppedError)

# "Walking rays ... 12.3 s" ends a stage, "Walking rays ... 40 %" is on the way.
_STAGE = re.compile(r"(\S.*) \.\.\. (?:(\d+) %.*|\d.* s)\s*$")

# The program inside the package, if that was installed as a wheel of scripts/make_wheel.
_INSIDE = str(pathlib.Path(__file__).with_name("bin") / "colmap_ext")


def find_program(program=None):
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
def _options(program, command):
    """The options of a command: what stands behind -- by the name's last part."""
    shown = subprocess.run([program, command, "-h"], stdin=subprocess.DEVNULL,
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                           check=False, encoding="utf-8", errors="replace")
    names = re.findall(r"^  --([\w.]+)", shown.stdout, re.MULTILINE)
    if shown.returncode != 0 or not names:
        raise ProgramNotFoundError(f"{program} has no command {command}")
    options = {}
    for name in names:  # aliases come last
        options.setdefault(name.rpartition(".")[2], name)
    return options


def make_arguments(program, command, options):
    """The command line for options by their names without a section.

    Options that are None are left out; True and False are 1 and 0.
    Raises OptionError for those that the command does not have.
    """
    known = _options(program, command)
    arguments = [program, command]
    for name, value in options.items():
        if value is None:
            continue
        if name not in known:
            raise OptionError(f"{command} has no option {name}; it has "
                              + ", ".join(sorted(known)))
        text = str(int(value)) if isinstance(value, bool) else os.fspath(
            value) if isinstance(value, os.PathLike) else str(value)
        arguments.append(f"--{known[name]}={text}")
    return arguments


def _raise_failure(exit_code, errors, arguments):
    lines = [line for line in errors.splitlines() if line.strip()]
    said = [line for line in lines if line.startswith(("ERROR: ", "Interrupted: "))]
    line = said[-1].split(": ", 1)[1] if said else (
        lines[-1] if lines else f"ended with exit code {exit_code}")
    number = -exit_code if exit_code < 0 else exit_code - 128
    if number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL):
        raise StoppedError(line, exit_code, arguments)
    if exit_code == 1:
        raise CommandError(line, exit_code, arguments)
    raise CrashError(line, exit_code, arguments)


def _watch(process, progress):
    """Reads and returns the output of the program."""
    printed = []
    for line in process.stdout:
        printed.append(line)
        stage = _STAGE.match(line)
        if stage and progress:
            progress(stage[1], int(stage[2]) / 100 if stage[2] else 1.0)
    return "".join(printed)


def run(arguments, progress=None):
    """Runs a command line. Returns what it prints.

    progress: is called with the name of the stage, and the share of it that is
        done, 0 to 1. If it raises, the program is ended and the exception propagates.
    Raises CommandError, StoppedError or CrashError.
    """
    with tempfile.TemporaryFile() as errors:
        with subprocess.Popen(arguments, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=errors,
                              encoding="utf-8", errors="replace") as process:
            try:
                printed = _watch(process, progress)
            except BaseException:
                process.terminate()
                process.stdout.close()
                process.wait()
                raise
        if process.returncode != 0:
            errors.seek(0)
            _raise_failure(process.returncode,
                           errors.read().decode("utf-8", "replace"), arguments)
    return printed


def main():
    """The command colmap_ext of a wheel: runs the program inside the package."""
    os.execv(_INSIDE, [_INSIDE, *sys.argv[1:]])
