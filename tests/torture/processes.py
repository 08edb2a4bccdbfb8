"""Runs one program, with limits, and says how it ended."""

import math
import os
import resource
import select
import signal
import subprocess
import threading
import time
from dataclasses import dataclass

MAX_ADDRESSES = 16 << 30  # bytes that a process may map
MAX_WAIT = 10  # s for each s of CPU, where other processes are at work


@dataclass
class Ended:
    """How a process ended.

    code: its exit code, or minus the signal that ended it.
    sent: the signal that it was sent while it ran; None: none.
    cpu: s. memory: MB, at the peak.
    """

    arguments: list
    code: int
    out: str
    err: str
    seconds: float
    cpu: float
    memory: float
    is_hanging: bool
    sent: object


@dataclass
class Limits:
    """seconds: of CPU; a process that takes more hangs, or that takes MAX_WAIT
    times as long. file_bytes: of a file that it writes. kill: (seconds, signal)
    that it is sent."""

    seconds: float
    file_bytes: object = None
    kill: object = None


def _set_limits(seconds, file_bytes):
    seconds = math.ceil(seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (MAX_ADDRESSES, MAX_ADDRESSES))
    if file_bytes is not None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (file_bytes, file_bytes))


def _start(arguments, folder, limits):
    environment = {name: value for name, value in os.environ.items()
                   if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    return subprocess.Popen(
        arguments, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, restore_signals=True,
        preexec_fn=lambda: _set_limits(limits.seconds, limits.file_bytes))


def _read_in_background(pipe):
    chunks = []
    thread = threading.Thread(target=lambda: chunks.append(pipe.read()))
    thread.start()

    def finish():
        thread.join()
        pipe.close()
        return chunks[0].decode("utf-8", "replace")
    return finish


def run_process(arguments, folder, limits):
    """Runs a program in a folder. Returns an Ended."""
    start = time.monotonic()
    process = _start(arguments, folder, limits)
    finish_out = _read_in_background(process.stdout)
    finish_err = _read_in_background(process.stderr)
    waiter = select.poll()
    descriptor = os.pidfd_open(process.pid)
    waiter.register(descriptor, select.POLLIN)

    def ends_within(seconds):
        left = start + seconds - time.monotonic()
        return bool(waiter.poll(max(0, 1000 * left)))

    sent, is_hanging = None, False
    if limits.kill is not None and not ends_within(limits.kill[0]):
        sent = limits.kill[1]
        signal.pidfd_send_signal(descriptor, sent)
    if not ends_within(MAX_WAIT * limits.seconds):
        is_hanging = True
        signal.pidfd_send_signal(descriptor, signal.SIGKILL)
    # Popen's own signals and waits would take the usage of one that has ended.
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.monotonic() - start
    os.close(descriptor)
    process.returncode = code = os.waitstatus_to_exitcode(status)
    return Ended(list(arguments), code, finish_out(), finish_err(), seconds,
                 usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024,
                 is_hanging or code == -signal.SIGXCPU, sent)
