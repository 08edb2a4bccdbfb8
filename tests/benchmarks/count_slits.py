#!/usr/bin/env python3
"""Counts the slits of meshes: background pixels that lie between two pixels of
the mesh in the same row or column that are close to each other, in the cameras
of all images. Draws by mesh_viewer. Needs NumPy and Pillow (python3-pil).

  count_slits.py PROGRAM WORKSPACE MESH.ply ... [--sparse_path DIR]

PROGRAM is colmap_ext or colmap. Prints for each mesh the pixels of slits, of
the mesh, and the slits' share in 1e-6 of the mesh.
"""

import argparse
import pathlib
import subprocess
import tempfile

import numpy as np
from PIL import Image


def between(is_mesh, max_width):
    """Which pixels [height, width] have a mesh pixel on both sides in their
    row, fewer than max_width background pixels apart."""
    columns = np.arange(is_mesh.shape[1])
    far = 2 * is_mesh.shape[1] + max_width
    before = np.maximum.accumulate(np.where(is_mesh, columns, -far), axis=1)
    after = np.where(is_mesh, columns, far)[:, ::-1]
    after = np.minimum.accumulate(after, axis=1)[:, ::-1]
    return ~is_mesh & (after - before - 1 < max_width)


def find_slits(is_mesh, max_width):
    return between(is_mesh, max_width) | between(is_mesh.T, max_width).T


def draw(program, arguments, image_name, path):
    """Which pixels [height, width] show the mesh; white is the background."""
    subprocess.run([program, "mesh_viewer", *arguments, "--image_name",
                    image_name, "--mode", "normals", "--screenshot_path", path],
                   check=True, stdout=subprocess.DEVNULL)
    with Image.open(path) as picture:
        return (np.asarray(picture)[..., :3] != 255).any(axis=2)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("workspace", type=pathlib.Path)
    parser.add_argument("meshes", nargs="+", type=pathlib.Path)
    parser.add_argument("--sparse_path")
    parser.add_argument("--max_width", type=int, default=24, help="[px]")
    parser.add_argument("--every", type=int, default=1,
                        help="draw every so many-th image")
    options = parser.parse_args()
    images = options.workspace / "images"
    names = sorted(str(path.relative_to(images)) for path in images.rglob("*")
                   if path.is_file())[::options.every]
    for mesh in options.meshes:
        arguments = ["--workspace_path", options.workspace, "--mesh_path", mesh]
        if options.sparse_path:
            arguments += ["--sparse_path", options.sparse_path]
        num_slits = num_mesh = 0
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "view.png"
            for name in names:
                is_mesh = draw(options.program, arguments, name, path)
                num_slits += find_slits(is_mesh, options.max_width).sum()
                num_mesh += is_mesh.sum()
        print(f"{mesh}: {num_slits} px of slits, {num_mesh} px of the mesh, "
              f"{1e6 * num_slits / max(num_mesh, 1):.0f} ppm")


if __name__ == "__main__":
    main()
