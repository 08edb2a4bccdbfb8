"""One run: its folder, its random numbers, its steps, and what they broke."""

import hashlib
import os
import random
import re
import shlex
import shutil
import signal
import subprocess

from option_values import WILD
from outputs import Fault, check_output
from processes import Limits, run_process

# Of commands that write meshes: what they write is manifold.
MESHING = {"delaunay_manifold_mesher", "facetwise_refiner", "mesh_merger"}

# Options whose files a command writes; * for those of every command.
WRITTEN = {"*": ["output_path", "report_path", "json_path", "error_mesh_path",
                 "picture_path", "screenshot_path", "plan_path", "labels_path"],
           "mesh_viewer": ["screenshot_path"]}
KINDS = {"output_path": ".ply", "json_path": ".json", "error_mesh_path": ".ply",
         "picture_path": ".png", "screenshot_path": ".png", "labels_path": ".ply",
         "report_path": ".csv"}
DEFAULT_OUTPUTS = ["ws/meshed-delaunay-manifold.", "ws/meshed-refined.",
                   "ws/sparse-refined"]

# What a run that was not completed may leave, to go on from.
STATE = re.compile(r"\.(level\d+\.ply(\.vis)?|\d+\.\d+\.ply|resume)$|"
                   r"^plan(/|$)")
TEMPORARY = re.compile(r"(^|/)\.[^/]*(\.tmp\d+$|colmap_ext\.)")

# What no message for users has.
RAW = re.compile(r"bug of colmap_ext|std::|basic_|vector|map::at|json\.exc|"
                 r"bad_alloc|terminate called|filesystem error|Check failed|"
                 r"^\*\*\*|out of memory|[^ -~\u00a0-\uffff]")


def snapshot(folder):
    """{path: what it is} of all below a folder."""
    found = {}
    for parent, folders, files in os.walk(folder):
        for name in folders + files:
            path = os.path.join(parent, name)
            if os.path.islink(path):
                what = "link " + os.readlink(path)
            elif os.path.isdir(path):
                what = "folder"
            else:
                with open(path, "rb") as file:
                    what = hashlib.sha1(file.read()).hexdigest()
            found[os.path.relpath(path, folder)] = what
    return found


def _call(*words):
    """Whether a program ends well."""
    return subprocess.run([str(word) for word in words], check=False,
                          stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL).returncode == 0


def seeded(seed, index):
    """The random numbers of a run."""
    return random.Random(f"{seed} {index}")


def draw_two(rng, workspaces):
    """Which a run uses; drawn first."""
    return rng.choice(workspaces), rng.choice(workspaces)


class Run:
    """rng is seeded by the seed and the index alone, so that a run can be
    repeated by itself. folder: its own; what it works in lies below. hazards:
    what was done to its files, texts. faults: what was found, texts."""

    def __init__(self, tools, seed, index, workspaces, folder):
        self.tools = tools
        self.rng = seeded(seed, index)
        self.index = index
        self.folder = folder
        self.base, self.other = draw_two(self.rng, workspaces)
        self.scenario = ""
        self.hazards = []
        self.faults = []
        self.ended = []
        self.lines = []
        self.mounts = []

    def chance(self, share):
        """True in so many cases."""
        return self.rng.random() < share

    def place(self, name="a plàce"):
        """A folder with the workspace, ws, in it."""
        path = self.folder / name
        path.mkdir()
        shutil.copytree(self.base.path, path / "ws", symlinks=True)
        return path

    def mount(self, path, room):
        """Moves a folder to a disk of its own, where that is allowed.

        room: bytes that are left there; None: it can only be read.
        """
        size = (1 << 28) if room is None else room + sum(
            8192 + p.lstat().st_size for p in path.rglob("*"))
        aside = path.with_name(path.name + " aside")
        path.rename(aside)
        path.mkdir()
        if _call("mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", path):
            self.mounts.append(path)
        shutil.copytree(aside, path, symlinks=True, dirs_exist_ok=True)
        shutil.rmtree(aside)
        if self.mounts and room is None:
            _call("mount", "-o", "remount,ro", path)
        if self.mounts:
            what = "can only be read" if room is None else f"has room for {room}"
            self.hazards.append(f"{path.name} {what}")
            self.lines.append("# " + self.hazards[-1])

    def unmount(self):
        """Before the folder is removed."""
        for path in self.mounts:
            _call("umount", path)

    def keep_before(self):
        """Keeps what the steps begin with; run files are small."""
        shutil.copytree(self.folder, self.folder.with_name(
            self.folder.name + "-before"), symlinks=True)

    def fault(self, text):
        """Notes what is wrong."""
        self.faults.append(text)

    def step(self, command, options, place, limits=None, may_leave=()):
        """Runs a command in a place, and checks what came of it.

        options: {name: value}. may_leave: signals after which temporary files
        are no fault. Returns an Ended.
        """
        arguments = [str(self.tools.program), command]
        for name, value in options.items():
            arguments.append(f"--{name}={value}")
        self.lines.append(f"{place.name}$ " + shlex.join(arguments))
        before = snapshot(place)
        limits = limits or Limits(self.tools.limit)
        ended = run_process(arguments, place, limits)
        self.ended.append(ended)
        self.lines.append(f"# {ended.code} in {ended.seconds:.2f} s, cpu "
                          f"{ended.cpu:.2f} s, {ended.memory:.0f} MB"
                          + (f", sent {ended.sent}" if ended.sent else ""))
        self.lines.extend("# " + line for line in ended.err.splitlines()[:5])
        self._check_end(ended)
        self._check_files(command, options, place, before, ended)
        return ended

    def _check_end(self, ended):
        if ended.is_hanging:
            self.fault("hangs")
            return
        stopped = (ended.sent is not None and
                   ended.code in (-ended.sent, 128 + ended.sent))
        if ended.code not in (0, 1) and not stopped:
            name = (signal.Signals(-ended.code).name if ended.code < 0
                    else str(ended.code))
            self.fault(f"ended by {name}")
            return
        errors = [line for line in ended.err.splitlines() if line.strip()]
        if ended.code == 1:
            if len(errors) != 1 or not errors[0].startswith("ERROR: "):
                self.fault(f"{len(errors)} lines of error: {errors[:2]}")
            elif self._is_raw(errors[0], ended.arguments):
                self.fault(f"a raw message: {errors[0]}")
        elif ended.code == 0 and errors and ended.sent is None:
            self.fault(f"errors and exit 0: {errors[:2]}")
        if ended.code == 0 and re.search(r"[ (]-?(nan|inf)\b", ended.out):
            line = re.search(r".*[ (]-?(?:nan|inf)\b.*", ended.out)[0]
            self.fault(f"prints {line.strip()}")

    @staticmethod
    def _is_raw(message, arguments):
        """Whether users can make nothing of it, but for what they typed."""
        for text in WILD + [text.split("=", 1)[-1] for text in arguments]:
            if RAW.search(text):
                message = message.replace(text, "")
        return RAW.search(message)

    def _check_files(self, command, options, place, before, ended):
        after = snapshot(place)
        changed = [path for path in before if after.get(path) != before[path]]
        new = [path for path in after if path not in before]
        for path in new:
            if TEMPORARY.search(path) and ended.sent != signal.SIGKILL:
                self.fault(f"leaves {path}")
        if ended.code == 0:
            names = self._written(command, options)
            for path in changed:
                if not path.startswith(tuple(names)) and not STATE.search(path):
                    self.fault(f"exit 0, but changes {path}")
            for path in changed + new:
                self._check_output(command, place / path, options)
            self._check_there(command, options, place)
            return
        for path in changed:
            is_whole_output = (ended.sent is not None and path in after and
                               path.startswith(tuple(self._written(command, options))))
            if is_whole_output:
                self._check_output(command, place / path, options)
            elif not (STATE.search(path) and ended.sent is not None):
                self.fault(f"exit {ended.code}, but changes {path}")
        for path in new:
            is_left = STATE.search(path) or (
                ended.sent is not None and
                path.startswith(tuple(self._written(command, options))))
            if not TEMPORARY.search(path) and not is_left:
                self.fault(f"exit {ended.code}, but writes {path}")

    @staticmethod
    def _written(command, options):
        """How the names of what a command may write begin."""
        names = list(DEFAULT_OUTPUTS) if command in MESHING else []
        for option in WRITTEN.get(command, WRITTEN["*"]):
            value = options.get(option)
            if value:
                names.append(os.path.splitext(os.path.normpath(str(value)))[0])
        return names

    def _check_output(self, command, path, options):
        """What an option names is of its kind, whatever it is called."""
        kinds = {os.path.normpath(str(options[name])): kind
                 for name, kind in KINDS.items()
                 if options.get(name) and name in WRITTEN.get(command, WRITTEN["*"])}
        kind = next((kind for end, kind in kinds.items()
                     if str(path).endswith("/" + end) and path.suffix != ".html"),
                    None)
        if path.is_file() and not path.is_symlink():
            try:
                check_output(path, command in MESHING, kind)
            except Fault as fault:
                self.fault(f"writes {fault}")

    def _check_there(self, command, options, place):
        for name in ("output_path", "json_path", "error_mesh_path",
                     "picture_path"):
            value = options.get(name)
            if value and not (place / value).exists():
                self.fault(f"exit 0, but {value} is not there")

    def expect_same(self, first, second, what):
        """What two places hold is the same, but for reports with times."""
        one, other = snapshot(first), snapshot(second)
        for path in sorted(set(one) | set(other)):
            if (TEMPORARY.search(path) or
                    not path.endswith((".ply", ".vis", ".png", ".bin", ".txt"))):
                continue
            if one.get(path) != other.get(path):
                self.fault(f"{what}: {path} differs")
                return
