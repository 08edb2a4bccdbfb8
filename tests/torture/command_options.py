"""Random options of the commands, with the files that they name."""

import numpy as np

from option_values import WILD, draw_value

MESH = "ws/meshed-delaunay-manifold.ply"

# Paths that are as they should be, of options by name.
PATHS = {
    "workspace_path": ["ws"], "fused_path": ["ws/fused.ply"],
    "sparse_path": ["ws/sparse"], "mask_path": ["ws/masks"],
    "input_path": ["ws", MESH, "ws/truth/mesh.ply", "ws/fused.ply"],
    "mesh_path": [MESH, "ws/truth/mesh.ply"],
    "truth_path": ["ws/truth/mesh.ply", "ws/truth/depth_maps", "ws/fused.ply",
                   "ws/stereo/depth_maps"],
    "output_path": ["out.ply"], "plan_path": ["plan"],
    "report_path": ["report.html", "report.csv"], "labels_path": ["labels.ply"],
    "json_path": ["figures.json"], "error_mesh_path": ["errors.ply"],
    "picture_path": ["picture.png"], "screenshot_path": ["shot.png"],
}
WRONG_PATHS = ["nowhere", "nowhere/at all/x.ply", "ws", "ws/fused.ply", ".", "",
               "ws/fused.ply/x", "/dev/null", "/dev/full", "/proc/x.ply",
               "ws/images", "a" * 300, MESH, "ws/sparse/images.bin", "x.txt",
               "out.ply.vis", "ws/fused.ply.vis", "ünï cödé.ply"]


def _box(run):
    """Six numbers, around the points or some of them."""
    rng, base = run.rng, run.base
    size = max(h - l for l, h in zip(base.low, base.high))
    half = [size * 10 ** rng.uniform(-3, 0.3) for _ in range(3)]
    if run.chance(0.6):
        half = [max(half)] * 3
    center = [rng.uniform(l, h) for l, h in zip(base.low, base.high)]
    if run.chance(0.6):  # holds one point or few, which lie far from others
        some = base.points[:20] if run.chance(0.7) else base.points
        center, distance = rng.choice(some)
        half = [distance * (1 / 1.3 if run.chance(0.5)
                            else rng.uniform(0.5, 3))] * 3
    corners = ([c - h for c, h in zip(center, half)]
               + [c + h for c, h in zip(center, half)])
    return [f"{number:.7g}" for number in corners]


def _rotation(rng):
    """[3, 3]"""
    matrix, _ = np.linalg.qr(
        np.array([rng.gauss(0, 1) for _ in range(9)]).reshape(3, 3))
    return matrix * np.sign(np.linalg.det(matrix))


def _write_numbers(run, place, name, numbers):
    if run.chance(0.1):
        numbers = list(numbers)
        numbers[run.rng.randrange(len(numbers))] = run.rng.choice(WILD)
    if run.chance(0.05):
        numbers = list(numbers)[:run.rng.randrange(len(numbers))]
    (place / name).write_text(" ".join(map(str, numbers)) + "\n", "utf-8")
    return name


def _region(run, place):
    if run.chance(0.25):
        return "auto"
    box = _box(run)
    if run.chance(0.5):
        return ",".join(box)
    if run.chance(0.4):
        return _write_numbers(run, place, "region.txt", box)
    low, high = np.array(box[:3], float), np.array(box[3:], float)
    numbers = [*_rotation(run.rng).ravel(), *(low + high) / 2, *(high - low) / 2]
    return _write_numbers(run, place, "region.txt", numbers)


def _transform(run, place):
    scale = 10 ** run.rng.uniform(-3, 3)
    if run.chance(0.1):
        scale = 10 ** run.rng.uniform(-200, 200)
    offset = [run.rng.choice([0, 1, 1e7]) for _ in range(3)]
    if run.chance(0.5):
        quaternion = [run.rng.gauss(0, 1) for _ in range(4)]
        numbers = [scale, *quaternion, *offset]
    else:
        matrix = np.eye(4)
        matrix[:3, :3] = scale * _rotation(run.rng)
        matrix[:3, 3] = offset
        numbers = matrix.ravel()
    return _write_numbers(run, place, "transform.txt", numbers)


def _array(run, place):
    shape = [run.rng.randrange(1, 9) for _ in range(3)]
    values = np.random.default_rng(run.rng.randrange(1000)).integers(0, 2, shape)
    np.save(place / "mask.npy", values.astype(run.rng.choice(
        [np.uint8, np.uint8, np.uint8, np.float64])))
    return "mask.npy"


def _project(run, place, command):
    """A project file with some options of the command, and others'."""
    lines = ["database_path=x.db", "[SiftExtraction]", "max_num_features=12"]
    section = None
    for name in sorted(run.rng.sample(sorted(run.tools.options[command]), 2)):
        head, _, tail = name.rpartition(".")
        if name.endswith("_path") or name in ("help", "version", "viewer"):
            continue
        if head and head != section:
            lines.append(f"[{head}]")
            section = head
        value = draw_value(run.rng, name, *run.tools.options[command][name])
        text = f"{tail}={value}"
        lines.insert(0, text) if not head else lines.append(text)
    (place / "project.ini").write_text("\n".join(lines) + "\n", "utf-8")
    return "project.ini"


def _value(run, place, command, name):
    """A value of an option."""
    special = {"region": _region, "transform_path": _transform,
               "observability_mask": _array}
    if name in PATHS or name in special or name == "project_path":
        if run.chance(0.1):
            return run.rng.choice(WRONG_PATHS + WILD)
        if name == "project_path":
            return _project(run, place, command)
        if name in special:
            return special[name](run, place)
        return run.rng.choice(PATHS[name])
    if name == "image_name":
        return run.rng.choice(run.base.images + ["none.png"])
    if name == "observability_box":
        size = max(h - l for l, h in zip(run.base.low, run.base.high))
        return ",".join(f"{x:.6g}" for x in [*run.base.low, size / 8])
    if name == "ground_plane":
        return ",".join(f"{run.rng.gauss(0, 1):.4g}" for _ in range(4))
    return draw_value(run.rng, name, *run.tools.options[command][name])


# Options that are drawn in other ways, or would open a window.
LEFT_OUT = {"help", "version", "viewer", "plan_path", "tile", "resume",
            "refined"}


# Options that need another one.
TOGETHER = {"observability_mask": "observability_box",
            "observability_box": "observability_mask",
            "mask_background": "mask_path", "image_name": "picture_path"}


def add_options(run, place, command, options, keep=()):
    """Options besides, at random, some of them instead of those given."""
    count = run.rng.choice([0, 0, 1, 1, 2, 3, 5, 8])
    names = [name for name in sorted(run.tools.options[command])
             if name not in LEFT_OUT and name not in keep]
    for name in run.rng.sample(names, min(count, len(names))):
        if name in ("output_path", "workspace_path", "mesh_path",
                    "screenshot_path", "truth_path",
                    "input_path") and run.chance(0.8):
            continue
        options[name] = _value(run, place, command, name)
    for name in ("region", "mask_path", "transform_path"):
        if (name in run.tools.options[command] and name not in keep
                and run.chance(0.15)):
            options[name] = _value(run, place, command, name)
    for name, other in TOGETHER.items():
        if name in options and other not in options and run.chance(0.9):
            options[other] = _value(run, place, command, other)
    if run.chance(0.02):
        options[run.rng.choice(["nosuch", "Section.nosuch", "log_level"])] = 1
    return options


def _mesher(run):
    if run.chance(0.15):
        return {"input_path": "ws", "output_path": "out.ply",
                "input_type": run.rng.choice(["dense", "sparse"])}
    return {"workspace_path": "ws", **run.base.options}


def _refiner(run):
    options = {"workspace_path": "ws", **run.base.options,
               "FacetwiseRefinement.backend": "cpu",
               "FacetwiseRefinement.levels": run.rng.choice([1, 2, 2]),
               "FacetwiseRefinement.iterations": run.rng.choice([1, 2])}
    if run.chance(0.3):
        options["input_path"] = run.rng.choice(PATHS["input_path"][1:])
        options["output_path"] = "out.ply"
    if run.chance(0.05):
        options["FacetwiseRefinement.backend"] = "gl"
    return options


def _evaluator(run):
    options = {"mesh_path": MESH, "truth_path": run.rng.choice(PATHS["truth_path"])}
    if run.chance(0.6):
        options["workspace_path"] = "ws"
    for name in ("json_path", "error_mesh_path", "picture_path"):
        if run.chance(0.3):
            options[name] = PATHS[name][0]
    return options


def _viewer(run):
    options = {"screenshot_path": "shot.png", "width": 100, **run.base.options}
    options.update(run.rng.choice([
        {"mesh_path": MESH}, {"mesh_path": "ws/fused.ply"},
        {"workspace_path": "ws"},
        {"workspace_path": "ws", "image_name": run.rng.choice(run.base.images)}]))
    return options


def _planner(run):
    return {"workspace_path": "ws", "output_path": "plan", **run.base.options,
            "num_tiles": run.rng.choice([1, 2, 2, 3, 4])}


COMMANDS = {"delaunay_manifold_mesher": _mesher, "facetwise_refiner": _refiner,
            "mesh_evaluator": _evaluator, "mesh_viewer": _viewer,
            "mesh_planner": _planner}
