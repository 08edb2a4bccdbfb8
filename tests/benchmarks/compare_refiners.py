#!/usr/bin/env python3
"""Compares the settings of facetwise_refiner on workspaces with a true mesh.

Each workspace (truth/mesh.ply beside the rest) is meshed once; the mesh is
refined with each setting, measured by mesh_evaluator, and tabled in Markdown.
`--fixed_point` also starts from the truth, as it is and moved by smooth waves
of one pixel. `--timed WORKSPACE` tables only what a workspace takes, and with
`--measure_photographs` what its photographs say of the meshes: the mesher's,
the refined one, and those in WORKSPACE/peers.
"""

import argparse
import csv
import math
import pathlib
import shutil
import struct
import sys
import tempfile

from compare_meshers import checked, evaluate, print_table

DEFAULT = "default"
PAPER = "1 pair (the paper's)"


def pairs(count, final):
    return ["pairs_per_face", str(count), "final_pairs_per_face", str(final)]


SETTINGS = {
    DEFAULT: [],
    PAPER: pairs(1, 1),
    "2 pairs": pairs(2, 2),
    "3 pairs": pairs(3, 3),
    "4 pairs": pairs(4, 4),
    "12 pairs": pairs(12, 12),
    "1 pair, then 8": pairs(1, 8),
    "2 pairs, then 12": pairs(2, 12),
    "classical": ["pair_selection", "classical"],
    "1 pair, energy -ZNCC (the paper's)":
        pairs(1, 1) + ["residual_floor", "1000"],
    "energy -ZNCC": ["residual_floor", "1000"],
    "no occlusion masks": ["occlusion_masking", "0"],
    "one level": ["levels", "1"],
    "half the smoothness": ["smoothness_weight", "0.5"],
    "twice the smoothness": ["smoothness_weight", "2"],
    "descent": ["solver", "descent", "iterations", "60"],
}
SHORT = [DEFAULT, PAPER, "4 pairs", "classical"]
PIXEL_WAVES = 8  # pixels of a wave, over 2 pi


def refiner_options(setting):
    """["a", "1"] -> ["--FacetwiseRefinement.a", "1"]"""
    return [f"--FacetwiseRefinement.{word}" if i % 2 == 0 else word
            for i, word in enumerate(setting)]


def refine(args, workspace, mesh, output, setting):
    """One run: CPU s, peak MB, s an iteration of the full size (the shortest
    and the mean), vertices."""
    steps_path = output.with_suffix(".csv")
    result = checked([args.colmap, "facetwise_refiner",
                      "--workspace_path", workspace,
                      "--input_path", mesh, "--output_path", output,
                      "--report_path", steps_path,
                      "--FacetwiseRefinement.backend", args.backend]
                     + refiner_options(setting))
    with open(steps_path, newline="") as file:
        steps = [row for row in csv.DictReader(file) if row["level"] == "0"]
    seconds = [float(row["seconds"]) for row in steps]
    # The least is that of an iteration by the few pairs, whose first step was
    # accepted and before which nothing had to be drawn again; the mean is of
    # all that happens between the first one's start and the last one's end.
    between = [b - a for a, b in zip(seconds, seconds[1:])]
    result["iteration"] = min(between) if between else math.nan
    num_iterations = int(steps[-1]["iteration"])
    result["mean"] = (sum(between) / num_iterations if num_iterations
                      else math.nan)
    result["vertices"] = steps[-1]["vertices"]
    return result


def row(name, result, figures):
    if result is None:
        return [name] + [f"{x:.3f}" for x in figures] + ["-"] * 5
    return ([name] + [f"{x:.3f}" for x in figures]
            + [f"{result['cpu']:.0f}", f"{result['iteration']:.2f}",
               f"{result['mean']:.2f}",
               f"{result['peak']:.0f}", result["vertices"]])


HEAD = ["", "mean acc.", "median acc.", "mean compl.", "median compl.",
        "CPU s", "s an iteration", "mean", "peak MB", "vertices"]


def copy_workspace(workspace, folder):
    """What the commands read, as links."""
    copy = folder / workspace.name
    copy.mkdir()
    for name in ("images", "sparse", "fused.ply", "fused.ply.vis", "truth",
                 "peers"):
        if (workspace / name).exists():
            (copy / name).symlink_to(workspace / name)
    return copy


def mesh_workspace(args, workspace, options=()):
    mesh = workspace / "meshed-delaunay-manifold.ply"
    checked([args.colmap, "delaunay_manifold_mesher", "--workspace_path",
             workspace, "--output_path", mesh, *options])
    return mesh


def read_floats_ply(path):
    """Header, vertices, the rest; float x, y, z alone."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode()
    lines = header.split("\n")
    count = next(int(line.split()[2]) for line in lines
                 if line.startswith("element vertex"))
    properties = []
    for line in lines:
        if line.startswith("element"):
            element = line.split()[1]
        elif line.startswith("property") and element == "vertex":
            properties.append(line.split()[1:])
    if [p[1] for p in properties] != ["x", "y", "z"] or any(
            p[0] not in ("float", "float32") for p in properties):
        sys.exit(f"{path}: vertices have to be float x, y, z alone")
    vertices = list(struct.iter_unpack("<fff", data[end:end + 12 * count]))
    return data[:end], vertices, data[end + 12 * count:]


def write_waves(source, target, pixel):
    """Moves a mesh by smooth waves of a pixel in every direction."""
    header, vertices, rest = read_floats_ply(source)
    length = PIXEL_WAVES * pixel
    with open(target, "wb") as file:
        file.write(header)
        for x, y, z in vertices:
            file.write(struct.pack("<fff",
                                   x + pixel * math.sin(y / length),
                                   y + pixel * math.sin(z / length),
                                   z + pixel * math.sin(x / length)))
        file.write(rest)


def compare(args, workspace, folder, settings):
    workspace = copy_workspace(workspace, folder)
    mesh = mesh_workspace(args, workspace)
    rows = [row("input", None, evaluate(args, workspace, mesh))]
    for name in settings:
        output = folder / "refined.ply"
        result = refine(args, workspace, mesh, output, SETTINGS[name])
        rows.append(row(name, result, evaluate(args, workspace, output)))
    if settings is not SHORT:
        paper = mesh_workspace(
            args, workspace,
            ["--DelaunayManifoldMeshing.preemptive_fixing", "0"])
        output = folder / "refined.ply"
        result = refine(args, workspace, paper, output, [])
        rows.append(row("default, mesh without preemptive fixing", result,
                        evaluate(args, workspace, output)))
    print_table(f"{workspace.name}: refinement, 1e-3 units", HEAD, rows)


def compare_fixed_point(args, workspace, folder):
    workspace = copy_workspace(workspace, folder)
    truth = folder / "truth.ply"
    shutil.copy(workspace / "truth" / "mesh.ply", truth)
    waves = folder / "waves.ply"
    write_waves(truth, waves, args.pixel)
    rows = []
    for start, mesh in (("the truth", truth), ("waves of one pixel", waves)):
        rows.append(row(start, None, evaluate(args, workspace, mesh)))
        for name in (DEFAULT, "classical"):
            output = folder / "refined.ply"
            result = refine(args, workspace, mesh, output, SETTINGS[name])
            rows.append(row(f"{start}, {name}", result,
                            evaluate(args, workspace, output)))
    print_table(f"{workspace.name}: started from the truth, 1e-3 units", HEAD,
                rows)


def time_workspace(args, workspace, folder):
    workspace = copy_workspace(workspace, folder)
    mesh = mesh_workspace(args, workspace)
    rows = []
    for name in (DEFAULT, PAPER):
        result = refine(args, workspace, mesh, folder / f"{name}.ply",
                        SETTINGS[name])
        rows.append([name, f"{result['wall']:.0f}", f"{result['cpu']:.0f}",
                     f"{result['peak']:.0f}", result["vertices"]])
    print_table(f"{workspace.name}: refinement",
                ["", "wall s", "CPU s", "peak MB", "vertices"], rows)
    if args.measure_photographs:
        meshes = {"`delaunay_manifold_mesher`": mesh,
                  "`facetwise_refiner`": folder / f"{DEFAULT}.ply"}
        for peer in sorted((workspace / "peers").glob("*.ply")):
            meshes[f"`{peer.stem}`"] = peer
        print(checked([args.measure_photographs, workspace]
                      + [f"{name}={path}" for name, path in meshes.items()]
                      )["output"], flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--colmap", required=True,
                        help="the patched colmap, or colmap_ext")
    parser.add_argument("--backend", default="cpu", choices=["cpu", "gl"])
    parser.add_argument("--all", action="append", default=[],
                        help="a workspace for all settings")
    parser.add_argument("--fixed_point", action="append", default=[],
                        help="a workspace to start from the truth")
    parser.add_argument("--pixel", type=float, default=2.75e-3,
                        help="of the waves, scene units")
    parser.add_argument("--timed", action="append", default=[],
                        help="a workspace without truth")
    parser.add_argument("--measure_photographs", metavar="PROGRAM")
    parser.add_argument("workspaces", nargs="*",
                        help="workspaces for the main settings")
    args = parser.parse_args()
    jobs = [(compare, path, list(SETTINGS)) for path in args.all]
    jobs += [(compare_fixed_point, path) for path in args.fixed_point]
    jobs += [(compare, path, SHORT) for path in args.workspaces]
    jobs += [(time_workspace, path) for path in args.timed]
    for job, path, *rest in jobs:
        with tempfile.TemporaryDirectory() as folder:
            job(args, pathlib.Path(path).resolve(), pathlib.Path(folder),
                *rest)


if __name__ == "__main__":
    main()
