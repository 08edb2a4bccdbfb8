#!/usr/bin/env python3
"""Measures what the camera and its pose cost: accuracy on rendered images as they
are and as photographs, and with poses that are off. Prints Markdown tables. Needs
NumPy, SciPy and PYTHONPATH=python.

  measure_cameras.py --colmap colmap_ext --make_workspace make_workspace \\
      [--posed WORKSPACE]...

--posed  a workspace with truth/mesh.ply whose poses are disturbed, beside the
         rendered ones
"""

import argparse
import pathlib
import random
import shutil
import struct
import tempfile

import numpy as np

from colmap_ext import read_ply
from compare_meshers import checked, evaluate, print_table
from compare_refiners import mesh_workspace
from measure_growth import read_images, rotated
from measure_roughness import quartiles

# Name: options of make_workspace.
SCENES = {
    "statue": ["--scene", "statue", "--num_images", "18"],
    "wall": ["--scene", "wall", "--num_images", "18"],
    "grid": ["--scene", "grid", "--num_images", "12"],
    "plane": ["--scene", "wall", "--num_images", "18", "--relief", "0"],
}
POSED_SCENES = ("statue", "wall")
NOISE = (0.2, 0.5, 1)  # px


def accuracy(args, workspace, mesh):
    """Mean and median, 1e-3 units."""
    return ", ".join(f"{x:.3f}" for x in evaluate(args, workspace, mesh)[:2])


def refined(args, workspace, mesh, cameras="auto"):
    output = workspace / "refined.ply"
    checked([args.colmap, "facetwise_refiner", "--workspace_path", workspace,
             "--input_path", mesh, "--output_path", output,
             "--FacetwiseRefinement.backend", args.backend,
             "--FacetwiseRefinement.refine_cameras", cameras])
    return output


def make(args, folder, name, options=()):
    folder.mkdir(exist_ok=True)
    workspace = folder / name
    checked([args.make_workspace, "--output_path", workspace, *SCENES[name],
             *options])
    return workspace


def compare_cameras(args, folder):
    rows, rough = [], None
    for name in SCENES:
        plain, photo = (make(args, folder / camera, name, ["--camera", camera])
                        for camera in ("plain", "photo"))
        mesh = mesh_workspace(args, plain)
        meshes = [mesh, *(refined(args, each, mesh) for each in (plain, photo))]
        rows.append([name] + [accuracy(args, plain, each) for each in meshes])
        if name == "plane":
            rough = [f"{x[1]:.3f}" for x in quartiles(plain, meshes)]
    rows.append(["roughness of the plane, px"] + rough)
    print_table("images as cameras take them, 1e-3 units",
                ["", "mesher", "refined, `plain`", "refined, `photo`"], rows)


def disturb_poses(workspace, noise):
    """Moves the cameras of sparse/images.bin independently, by `noise` px in the
    images, root mean square."""
    draw = random.Random(1)
    points = read_ply(workspace / "fused.ply").vertices
    cameras = (workspace / "sparse" / "cameras.bin").read_bytes()
    focal_length = struct.unpack_from("<d", cameras, 8 + 24)[0]
    path = workspace / "sparse" / "images.bin"
    data = bytearray(path.read_bytes())
    for _, pose, _, _ in read_images(workspace):
        rotation = np.array([rotated(pose[:4], axis) for axis in np.eye(3)])
        depth = np.median((points @ rotation)[:, 2] + pose[6])
        size = noise / (2 * focal_length)
        turn = np.array([1, *(draw.gauss(0, size) / 2 for _ in range(3))])
        turn /= np.linalg.norm(turn)
        translation = (np.array(rotated(turn, pose[4:]))
                       + [depth * draw.gauss(0, size) for _ in range(3)])
        struct.pack_into("<7d", data, data.index(struct.pack("<7d", *pose)),
                         *multiply(turn, pose[:4]), *translation)
    path.write_bytes(data)


def multiply(a, b):
    """The product of two quaternions."""
    vector = (a[0] * np.array(b[1:]) + b[0] * np.array(a[1:])
              + np.cross(a[1:], b[1:]))
    return [a[0] * b[0] - np.dot(a[1:], b[1:]), *vector]


def compare_poses(args, folder):
    workspaces = [make(args, folder, name) for name in POSED_SCENES]
    for path in args.posed:
        workspaces.append(folder / path.name)
        shutil.copytree(path, workspaces[-1])
    rows = []
    for workspace in workspaces:
        for noise in NOISE:
            copy = folder / "disturbed"
            shutil.copytree(workspace, copy)
            disturb_poses(copy, noise)
            mesh = mesh_workspace(args, copy)
            rows.append([workspace.name, noise, accuracy(args, copy, mesh)] + [
                accuracy(args, copy, refined(args, copy, mesh, cameras))
                for cameras in ("none", "auto")])
            shutil.rmtree(copy)
    print_table("poses that are off, 1e-3 units",
                ["", "noise, px", "mesher", "`none`", "`auto`"], rows)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--colmap", required=True)
    parser.add_argument("--make_workspace", required=True)
    parser.add_argument("--backend", default="cpu", choices=["cpu", "gl"])
    parser.add_argument("--posed", type=pathlib.Path, action="append",
                        default=[])
    args = parser.parse_args()
    for compare in (compare_cameras, compare_poses):
        with tempfile.TemporaryDirectory() as folder:
            compare(args, pathlib.Path(folder))


if __name__ == "__main__":
    main()
