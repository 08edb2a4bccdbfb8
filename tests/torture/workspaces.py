"""The workspaces that runs begin with: small, of the scene maker."""

import random
import shutil
import struct
import subprocess
import zlib
from dataclasses import dataclass

import numpy as np


@dataclass
class Workspace:
    """A folder with a dense workspace, whose mesh is made.

    low, high: of the fused points. points: some of them, with the distances to
    their nearest neighbors: (place, distance). options: that its commands need.
    """

    path: object
    name: str
    images: list
    low: list
    high: list
    points: list
    options: dict


def _encode_mask(pixels):
    """A grey PNG of [H, W] uint8."""
    height, width = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(kind, body):
        return (struct.pack(">I", len(body)) + kind + body
                + struct.pack(">I", zlib.crc32(kind + body)))
    return (b"\x89PNG\r\n\x1a\n"
            + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def _write_masks(rng, workspace, width, height):
    """Half planes, of most images."""
    y, x = np.mgrid[:height, :width]
    for name in workspace.images:
        if rng.random() < 0.2:
            continue
        a, b = rng.uniform(-1, 1), rng.uniform(-1, 1)
        away = rng.uniform(-0.2, 0.5) * width
        keeps = a * (x - width / 2) + b * (y - height / 2) < away
        path = workspace.path / "masks" / (name + ".png")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(_encode_mask((255 * keeps).astype(np.uint8)))


def _draw_scene(rng):
    """Options of the scene maker."""
    width = rng.choice([64, 96, 128, 160])
    options = {"scene": rng.choice(["statue", "statue", "wall", "grid"]),
               "num_images": rng.choice([3, 4, 5, 6, 6]), "width": width,
               "height": round(width * rng.choice([0.6, 0.75, 1])),
               "seed": rng.randrange(1000), "cell_size": 2}
    for name, values in {
            "pose_noise": [0.3, 1, 5], "outliers": [0.05, 0.5], "noise": [1, 5],
            "dropout": [0.3, 0.9], "gloss": [1], "untextured": [1],
            "exposure_change": [0.3], "num_sparse_points": [0, 10],
            "min_num_pixels": [1, 5], "fattening": [5],
            "focal_factor": [0.9, 1.01], "feature_noise": [3]}.items():
        if rng.random() < 0.15:
            options[name] = rng.choice(values)
    return options


def _run(arguments):
    subprocess.run([str(word) for word in arguments], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def _describe(path, name):
    images = sorted(str(p.relative_to(path / "images"))
                    for p in (path / "images").rglob("*") if p.is_file())
    data = (path / "fused.ply").read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].split()
    count = int(header[header.index(b"vertex") + 1])
    rows = np.frombuffer(data[end:], "u1").reshape(count, -1)
    points = rows[:, :12].copy().view("<f4")
    some = []
    for place in points[np.linspace(0, count - 1, min(count, 400)).astype(int)]:
        distances = np.linalg.norm(points - place, axis=1)
        some.append((place.tolist(), float(distances[distances > 0].min())))
    some.sort(key=lambda point: -point[1])
    return Workspace(path, name, images, points.min(0).tolist(),
                     points.max(0).tolist(), some, {})


def _add_mesh(program, workspace):
    """The mesher's. Few images that see all points do not tell their order."""
    arguments = [program, "delaunay_manifold_mesher", "--workspace_path",
                 workspace.path]
    try:
        _run(arguments)
    except subprocess.CalledProcessError:
        workspace.options = {"image_order": "file"}
        _run([*arguments, "--image_order", "file"])


def make_workspace(tools, seed, index, path):
    """Makes the workspace of a seed and an index. Returns a Workspace."""
    rng = random.Random(f"workspace {seed} {index}")
    while True:
        options = _draw_scene(rng)
        arguments = [f"--{name}={value}" for name, value in options.items()]
        arguments = [part for text in arguments for part in text.split("=")]
        try:
            _run([tools.make_workspace, "--output_path", path,
                  "--write_depth_maps", 1, "--write_true_depth_maps", 1,
                  *arguments])
            workspace = _describe(path, f"{options['scene']}-{index}")
            _add_mesh(tools.program, workspace)
            break
        except (subprocess.CalledProcessError, ValueError):
            shutil.rmtree(path, ignore_errors=True)
    _write_masks(rng, workspace, options["width"], options["height"])
    return workspace


def take_workspace(tools, source, path):
    """A copy of a given workspace, such as a small real one."""
    shutil.copytree(source, path)
    workspace = _describe(path, source.name)
    _add_mesh(tools.program, workspace)
    if not (path / "truth").is_dir():
        (path / "truth").mkdir()
        shutil.copyfile(path / "meshed-delaunay-manifold.ply",
                        path / "truth" / "mesh.ply")
    return workspace
