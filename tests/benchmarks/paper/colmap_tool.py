"""Calls to the colmap executable."""

import re
import subprocess


class CommandFailed(RuntimeError):
    """A command that ended with another exit code than 0."""


class Colmap:
    """A colmap executable and what it can do."""

    def __init__(self, program):
        self.program = str(program)
        text = self._output("help")
        self.commands = set(re.findall(r"^  ([a-z]\w+)$", text, re.MULTILINE))
        self.has_cuda = "with CUDA" in text

    def _output(self, *arguments):
        return subprocess.run([self.program, *arguments], text=True,
                              capture_output=True, check=False).stdout

    def has_option(self, command, option):
        """Whether -h of a command lists --option."""
        return (command in self.commands and re.search(
            rf"--{re.escape(option)}\b", self._output(command, "-h"))
            is not None)

    def run(self, command, options, log):
        """Runs a command with {option: value}; returns what it printed, which
        is also left in the file log."""
        line = [self.program, command]
        for name, value in options.items():
            line += [f"--{name}", str(value)]
        log.parent.mkdir(parents=True, exist_ok=True)
        result = subprocess.run(line, text=True, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, check=False)
        log.write_text(" ".join(line) + "\n" + result.stdout)
        if result.returncode != 0:
            last_line = (result.stdout.strip().splitlines() or ["failed"])[-1]
            raise CommandFailed(f"{command}: {last_line} (more in {log})")
        return result.stdout
