"""What a run does: commands with random options, and what befalls them."""

import re
import shutil
import signal

from command_options import COMMANDS, MESH, add_options
from damage import damage
from degenerate import edit_cloud, edit_mesh
from processes import Limits

EARLIER = b"an earlier file\n"


def make_hard(run, place, share):
    """Points or the mesh, in so many cases."""
    if run.chance(share):
        how = (edit_cloud(run.rng, place / "ws") if run.chance(0.6)
               else edit_mesh(run.rng, place / MESH))
        run.hazards.append(how)
        run.lines.append("# " + how)


def damage_some(run, place, below, share):
    """Damages files in a folder of the place, in so many cases."""
    if not run.chance(share):
        return
    for _ in range(run.rng.choice([1, 1, 1, 2, 4])):
        files = sorted(p for p in (place / below).rglob("*")
                       if p.is_file() and not p.is_symlink())
        if not files:
            return
        # Images and depth maps are many; the rest counts as much.
        many = [p for p in files if p.parent.name in
                ("images", "depth_maps", "normal_maps", "masks")]
        few = [p for p in files if p not in many]
        path = run.rng.choice(many if many and run.chance(0.2) or not few else few)
        others = [p for p in (run.other.path / path.relative_to(place / "ws"),)
                  if p.is_file()] if below == "ws" else []
        others += [p for p in files if p.suffix == path.suffix]
        how = damage(run.rng, path, others)
        run.hazards.append(how)
        run.lines.append("# " + how.replace(str(place) + "/", ""))


def place_earlier(run, place):
    """Files of earlier runs, at places of outputs."""
    for name in ("out.ply", "out.ply.vis", "ws/meshed-refined.ply",
                 "ws/meshed-refined.ply.vis", "figures.json", "shot.png",
                 "ws/sparse-refined/images.bin"):
        if run.chance(0.3):
            (place / name).parent.mkdir(exist_ok=True)
            (place / name).write_bytes(EARLIER)


def draw_limits(run):
    """A full disk, as a limit on the size of files, in few cases."""
    limits = Limits(run.tools.limit)
    if run.chance(0.06):
        limits.file_bytes = int(10 ** run.rng.uniform(0, 6))
        run.hazards.append(f"files of up to {limits.file_bytes} bytes")
    return limits


def one_command(run, command):
    """A command with anything."""
    place = run.place()
    options = COMMANDS[command](run)
    add_options(run, place, command, options)
    place_earlier(run, place)
    make_hard(run, place, 0.25)
    damage_some(run, place, "ws", 0.35)
    limits = draw_limits(run)
    run.keep_before()
    if run.chance(0.05):
        if run.chance(0.5):
            options["output_path"] = "out.ply"
        run.mount(run.rng.choice([place, place / "ws"]), run.rng.choice(
            [None, int(10 ** run.rng.uniform(0, 6.5))]))
    run.step(command, options, place, limits)


def threads(run):
    """The same bytes on one and on several threads."""
    command = run.rng.choice(["delaunay_manifold_mesher", "facetwise_refiner",
                              "facetwise_refiner", "mesh_evaluator"])
    name = next(option for option in run.tools.options[command]
                if option.endswith("num_threads"))
    place = run.place("öne")
    options = COMMANDS[command](run)
    add_options(run, place, command, options,
                keep=(name, "project_path", "report_path"))
    make_hard(run, place, 0.25)
    damage_some(run, place, "ws", 0.1)
    several = run.folder / "several"
    shutil.copytree(place, several, symlinks=True)
    run.keep_before()
    codes = [run.step(command, {**options, name: count}, at).code
             for count, at in ((1, place), (run.rng.choice([2, 3, 8]), several))]
    if codes[0] != codes[1]:
        run.fault(f"exit codes differ by the threads: {codes}")
    run.expect_same(place, several, "by the threads")


def _kill(run, seconds):
    """A signal within the time that a process took, or a bit later."""
    number = run.rng.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
    return Limits(run.tools.limit,
                  kill=(seconds * run.rng.uniform(0, 1.1), number))


def resume(run):
    """Ended at any time, and gone on with: the bytes of a run at one go."""
    place = run.place("whole")
    options = COMMANDS["facetwise_refiner"](run)
    options["FacetwiseRefinement.levels"] = 3
    add_options(run, place, "facetwise_refiner", options,
                keep=("project_path", "report_path", "FacetwiseRefinement.levels"))
    broken = run.folder / "broken"
    shutil.copytree(place, broken, symlinks=True)
    run.keep_before()
    whole = run.step("facetwise_refiner", options, place)
    if whole.code != 0:
        return
    for _ in range(run.rng.choice([1, 1, 2, 3])):
        run.step("facetwise_refiner", {**options, "resume": run.rng.choice([0, 1])},
                 broken, _kill(run, whole.seconds))
    states = [p for p in broken.rglob("*") if re.search(
        r"\.(level\d+.*|resume)$", p.name)]
    if states and run.chance(0.2):
        path = run.rng.choice(sorted(states))
        run.hazards.append(damage(run.rng, path, []))
        run.lines.append("# " + run.hazards[-1])
        if run.step("facetwise_refiner", {**options, "resume": 1}, broken).code:
            return
    elif run.step("facetwise_refiner", {**options, "resume": 1}, broken).code:
        run.fault("--resume 1 fails")
        return
    run.expect_same(place, broken, "resumed")


def _tiles_of(ended, pattern):
    found = re.search(pattern, ended.out)
    return found[1] if found else None


def _do_tiles(run, place, command, tiles, is_disturbed, share):
    """Jobs of tiles. Returns whether all are done."""
    for tile in tiles:
        options = {"plan_path": "plan", "tile": tile}
        if command == "facetwise_refiner":
            options["FacetwiseRefinement.backend"] = "cpu"
        if is_disturbed and run.chance(0.5):
            run.step(command, options, place, _kill(run, 0.2))
        damage_some(run, place, "plan", share)
        if run.step(command, options, place, draw_limits(run)
                    if share > 0 else None).code != 0:
            return False
    return True


def _chain(run, place, planning, refining, is_disturbed, share):
    """Plans, does and merges tiles. Returns whether it went to the end."""
    planned = run.step("mesh_planner", planning, place)
    last = _tiles_of(planned, r"seq 0 (\d+) ")
    if planned.code != 0 or last is None:
        return False
    tiles = list(range(int(last) + 1))
    if is_disturbed:
        run.rng.shuffle(tiles)
    if not _do_tiles(run, place, "delaunay_manifold_mesher", tiles, is_disturbed,
                     share):
        return False
    damage_some(run, place, "plan", share)
    merging = {"plan_path": "plan", "output_path": "merged.ply"}
    if run.step("mesh_merger", merging, place).code != 0 or refining is None:
        return False
    planned = run.step("facetwise_refiner", refining, place)
    if planned.code != 0:
        return False
    for colour in re.findall(r"echo ([\d ]+) \| xargs", planned.out):
        if not _do_tiles(run, place, "facetwise_refiner", colour.split(),
                         is_disturbed, share):
            return False
    damage_some(run, place, "plan", share)
    return run.step("mesh_merger", {"plan_path": "plan", "output_path": "refined.ply",
                                    "refined": 1}, place).code == 0


def _draw_chain(run, place):
    planning = COMMANDS["mesh_planner"](run)
    add_options(run, place, "mesh_planner", planning,
                keep=("output_path", "project_path", "workspace_path"))
    refining = None
    if run.chance(0.4):
        refining = {"plan_path": "plan", "input_path": "merged.ply",
                    "FacetwiseRefinement.levels": 1,
                    "FacetwiseRefinement.iterations": 1}
    return planning, refining


def tiles_with_damage(run):
    """A plan, whose files are damaged in some cases."""
    place = run.place()
    planning, refining = _draw_chain(run, place)
    make_hard(run, place, 0.3)
    damage_some(run, place, "ws", 0.1)
    share = run.rng.choice([0, 0.15, 0.3])
    run.keep_before()
    _chain(run, place, planning, refining, False, share)


def tiles_with_kills(run):
    """Jobs of tiles in any order, killed and repeated: the same bytes."""
    place = run.place("whole")
    planning, refining = _draw_chain(run, place)
    make_hard(run, place, 0.2)
    broken = run.folder / "broken"
    shutil.copytree(place, broken, symlinks=True)
    run.keep_before()
    is_done = _chain(run, place, planning, refining, False, 0)
    is_done_too = _chain(run, broken, planning, refining, True, 0)
    if is_done != is_done_too:
        run.fault("tiles that are killed and repeated end otherwise")
    for name in ("merged.ply", "merged.ply.vis", "refined.ply", "refined.ply.vis"):
        files = [at / name for at in (place, broken)]
        if len({p.read_bytes() if p.is_file() else b"" for p in files}) > 1:
            run.fault(f"tiles that are killed and repeated: {name} differs")


def _single(command):
    return lambda run: one_command(run, command)


# (weight, name, function)
SCENARIOS = [(26, "mesh", _single("delaunay_manifold_mesher")),
             (26, "refine", _single("facetwise_refiner")),
             (13, "evaluate", _single("mesh_evaluator")),
             (7, "view", _single("mesh_viewer")),
             (3, "plan", _single("mesh_planner")),
             (10, "threads", threads), (5, "resume", resume),
             (6, "tiles", tiles_with_damage), (4, "killed tiles", tiles_with_kills)]


def play(run):
    """Does a run."""
    weights = [weight for weight, *_ in SCENARIOS]
    _, run.scenario, function = run.rng.choices(SCENARIOS, weights)[0]
    function(run)
