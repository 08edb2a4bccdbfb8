#!/usr/bin/env python3
"""Hard use of all commands, at random: options, damaged files, full disks, kills.

  torture.py --program build/release/bin/colmap_ext \\
      --make_workspace build/release/tests/make_workspace [--runs 1000]

Each run takes a small workspace of the scene maker, or one that is given, draws
values of the options that the program lists (-h), valid and not, damages files,
limits their size, or kills jobs and starts them again. A command may end with 0
and files that are whole, meshes that are finite 2-manifolds, or with 1, one line
of ERROR, and every earlier file as it was. Never by a signal, and it takes less
than ten times the time and the memory of others of its kind that end with 0.

A run is drawn from the seed and its index alone: --only INDEX repeats it. Runs
that find something are kept, with their command lines and the workspace before
and after. Ends with 1 if there are any.
"""

import argparse
import collections
import concurrent.futures
import os
import pathlib
import re
import shutil
import statistics
import sys
import tempfile
import time
import traceback
from dataclasses import dataclass

from command_options import COMMANDS
from option_values import read_options
from run import Run, draw_two, seeded
from scenarios import play
from workspaces import make_workspace, take_workspace

TIMES_MEDIAN = 10
MIN_SLOW = 10  # s; less is never too long
MIN_LARGE = 500  # MB; less is never too much


@dataclass
class Tools:
    """program, make_workspace: paths. options: of the commands, as
    option_values.read_options() has them. limit: s of CPU that a process may take."""

    program: pathlib.Path
    make_workspace: pathlib.Path
    options: dict
    limit: float


def read_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--make_workspace", type=pathlib.Path, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="index of the first")
    parser.add_argument("--seconds", type=float, default=float("inf"),
                        help="no run begins later")
    parser.add_argument("--only", type=int, nargs="+", metavar="INDEX")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--limit", type=float, default=60,
                        help="s of CPU; a process that takes more hangs")
    parser.add_argument("--workspaces", type=int, default=16,
                        help="of the scene maker")
    parser.add_argument("--data", type=pathlib.Path, nargs="*", default=[],
                        metavar="WORKSPACE", help="besides; small ones")
    parser.add_argument("--keep", type=pathlib.Path,
                        default=pathlib.Path("build/torture"),
                        help="where runs that find something are kept")
    return parser.parse_args()


def make_workspaces(args, tools, folder, pool):
    """Of the scene maker, and those given; None: not used."""
    numbers = range(args.workspaces + len(args.data))
    used = set(numbers)
    if args.only:
        used = {i for index in args.only
                for i in draw_two(seeded(args.seed, index), numbers)}

    def make(i):
        if i not in used:
            return None
        if i < args.workspaces:
            return pool.submit(make_workspace, tools, args.seed, i,
                               folder / f"made{i}")
        return pool.submit(take_workspace, tools,
                           args.data[i - args.workspaces].resolve(),
                           folder / f"given{i}")
    return [job and job.result() for job in [make(i) for i in numbers]]


def _kind(arguments):
    """The command, and whether it draws by OpenGL, which is slow in software."""
    draws = any(re.search(r"backend=(gl|auto)", text) for text in arguments)
    return arguments[1] + (", OpenGL" if draws else "")


def do_run(tools, seed, index, workspaces, folder, keep):
    """Returns what the summary needs: a dict."""
    at = folder / f"run{index}"
    before = folder / f"run{index}-before"
    at.mkdir()
    run = Run(tools, seed, index, workspaces, at)
    try:
        play(run)
    except Exception:  # of this script
        run.fault("the script failed: " + traceback.format_exc())
    result = {"index": index, "kind": run.scenario, "base": run.base.name,
              "faults": run.faults, "lines": run.lines, "hazards": run.hazards,
              "ended": [(_kind(e.arguments), e.code, e.cpu, e.memory,
                         e.err.strip().splitlines()[:1]) for e in run.ended]}
    if run.faults:
        kept = keep / f"{seed}-{index}"
        shutil.rmtree(kept, ignore_errors=True)
        keep.mkdir(parents=True, exist_ok=True)
        shutil.copytree(at, kept, symlinks=True)
        if before.is_dir():
            shutil.move(before, kept / "before")
        (kept / "what.txt").write_text("\n".join(run.lines + run.faults) + "\n",
                                       "utf-8")
    run.unmount()
    for path in (at, before):
        shutil.rmtree(path, ignore_errors=True)
    return result


def find_excessive(results):
    """Adds the faults of processes that took far more than others do."""
    kinds = collections.defaultdict(list)
    for result in results:
        for command, exit_code, cpu, memory, _ in result["ended"]:
            if exit_code == 0:  # What is refused ends at once.
                for base in ("", result["base"]):
                    kinds[command, base].append((cpu, memory))
    for result in results:
        for command, _, cpu, memory, _ in result["ended"]:
            like = kinds[command, result["base"]]
            if len(like) < 10:
                like = kinds[command, ""] or [(cpu, memory)]
            slow = TIMES_MEDIAN * statistics.median(c for c, _ in like)
            large = TIMES_MEDIAN * statistics.median(m for _, m in like)
            if cpu > max(slow, MIN_SLOW):
                result["faults"].append(f"{command} takes {cpu:.1f} s of CPU")
            if memory > max(large, MIN_LARGE):
                result["faults"].append(f"{command} takes {memory:.0f} MB")


def print_findings(seed, results, keep):
    for result in results:
        if result["faults"]:
            print(f"\nrun {result['index']} of seed {seed}: {result['kind']}, "
                  f"{result['base']}, kept in {keep}/{seed}-{result['index']}")
            print("\n".join("  " + line for line in result["lines"][-12:]))
            print("\n".join("  FAULT " + fault for fault in result["faults"]))


def print_summary(args, results, seconds):
    commands = collections.Counter()
    messages = collections.Counter()
    for result in results:
        for command, code, _, _, error in result["ended"]:
            commands[command, "0" if code == 0 else "1" if code == 1 else
                     "signals"] += 1
            if code == 1 and error:
                messages[command, re.sub(r"\d+", "#", error[0])[:200]] += 1
    args.keep.mkdir(parents=True, exist_ok=True)
    (args.keep / f"messages-{args.seed}.txt").write_text("".join(
        f"{count:5} {command}: {text}\n" for (command, text), count in
        messages.most_common()), "utf-8")
    print(f"\nseed {args.seed}, {len(results)} runs in {seconds:.0f} s; exit codes:")
    for command in sorted({command for command, _ in commands}):
        counts = ", ".join(f"{code}: {count}" for (name, code), count in
                           sorted(commands.items()) if name == command)
        print(f"  {command:26} {counts}")
    found = [result["index"] for result in results if result["faults"]]
    print(f"{len(found)} runs found faults" + (f": {found}" if found else ""))
    return not found


def main():
    args = read_arguments()
    program = args.program.resolve()
    tools = Tools(program, args.make_workspace.resolve(),
                  {command: read_options(program, command)
                   for command in [*COMMANDS, "mesh_merger"]}, args.limit)
    start = time.monotonic()
    indices = iter(args.only or range(args.first, args.first + args.runs))
    results = []
    with tempfile.TemporaryDirectory(prefix="torture-") as name, \
            concurrent.futures.ProcessPoolExecutor(args.workers) as pool:
        folder = pathlib.Path(name)
        workspaces = make_workspaces(args, tools, folder, pool)
        running = set()
        while True:
            while (len(running) < 2 * args.workers and
                   time.monotonic() - start < args.seconds and
                   (index := next(indices, None)) is not None):
                running.add(pool.submit(do_run, tools, args.seed, index,
                                        workspaces, folder, args.keep.resolve()))
            if not running:
                break
            done, running = concurrent.futures.wait(
                running, return_when=concurrent.futures.FIRST_COMPLETED)
            results += [job.result() for job in done]
    results.sort(key=lambda result: result["index"])
    find_excessive(results)
    print_findings(args.seed, results, args.keep)
    if not print_summary(args, results, time.monotonic() - start):
        sys.exit(1)


if __name__ == "__main__":
    main()
