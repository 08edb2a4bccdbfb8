#!/usr/bin/env python3
"""Shows what the constants of the refinement do: refines workspaces with a true
mesh with each constant halved and doubled, and tables the mean and the median
accuracy in 1e-3 units as Markdown.

The source tree is copied and built anew for each value (through ccache).
"""

import argparse
import pathlib
import re
import shutil
import sys
import tempfile

from compare_meshers import checked, evaluate, print_table
from compare_refiners import copy_workspace, mesh_workspace, refine

# File below src/, constant, values beside the one that it has.
CONSTANTS = [
    ("refine/level_refinement.cc", "kMinGain", ["1e-4", "4e-4"]),
    ("refine/level_refinement.cc", "kMaxDrift", ["0.05", "0.2"]),
    ("refine/level_refinement.cc", "kFirstWeight", ["10", "40"]),
    ("refine/level_refinement.cc", "kRelaxation", ["1", "2"]),
    ("refine/level_refinement.cc", "kFinalIterations", ["2", "8"]),
    ("refine/level_refinement.cc", "kBlindIterations", ["1", "4"]),
    ("refine/smoothness_model.cc", "kRedundancy", ["4", "16"]),
    ("refine/smoothness_model.cc", "kMaxChange", ["2", "8"]),
    ("refine/smoothness_model.cc", "kPrior", ["0.001", "0.004"]),
    ("refine/smoothness_model.cc", "kMinFactor", ["0.5", "1"]),
    ("refine/smoothness_model.cc", "kMaxFactor", ["128", "512"]),
    ("refine/smoothness_model.cc", "kRounds", ["5", "20"]),
    ("refine/smoothness_model.cc", "kEvidenceRounds", ["2", "8"]),
    ("refine/thin_plate.cc", "kMaxCurvature", ["0.125", "0.5"]),
    ("refine/thin_plate.cc", "kPrior", ["0.05", "0.2"]),
    ("refine/thin_plate.cc", "kMinEdge", ["0.25", "1"]),
    ("refine/vertex_motion.h", "kSolverTolerance", ["0.015", "0.06"]),
    ("photometry/window_correlation.cc", "kMaxSlope", ["2", "8"]),
    ("refine/facet_sizes.cc", "kUnseenFactor", ["2", "8"]),
    ("refine/facet_sizes.cc", "kMaxError", ["0.05F", "0.2F"]),
    ("refine/facet_sizes.cc", "kMaxGrowth", ["1.5", "6"]),
    ("remesh/isotropic_remeshing.h", "kGradation", ["0.15F", "0.6F"]),
    ("remesh/isotropic_remeshing.cc", "kShare", ["0.05F", "0.2F"]),
]


def build(folder):
    checked(["cmake", "--build", folder / "build", "--target", "colmap_ext"])


def prepare(args, folder):
    """A copy of the source tree, built."""
    source = pathlib.Path(__file__).resolve().parents[2]
    shutil.copytree(source, folder / "source",
                    ignore=shutil.ignore_patterns("build", ".git"))
    options = [f"-DCOLMAP_SOURCE_DIR={args.colmap_source}"]
    if not args.colmap_source:
        options = []
    checked(["cmake", "-S", folder / "source", "-B", folder / "build", "-G",
             "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCOLMAP_EXT_TESTS=OFF",
             "-DCOLMAP_EXT_PATCH_COLMAP=OFF"] + options)
    build(folder)


def figures(args, meshes, folder):
    """Mean and median accuracy on each workspace."""
    cells = []
    for workspace, mesh in meshes:
        output = folder / "refined.ply"
        refine(args, workspace, mesh, output, [])
        mean, median = evaluate(args, workspace, output)[:2]
        cells += [f"{mean:.3f}", f"{median:.3f}"]
    return cells


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--colmap_source", default="",
                        help="COLMAP's sources; else CMAKE_PREFIX_PATH")
    parser.add_argument("--only", default="", help="constants of this name")
    parser.add_argument("workspaces", nargs="+")
    args = parser.parse_args()
    args.backend = "cpu"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        prepare(args, folder)
        args.colmap = str(folder / "build" / "bin" / "colmap_ext")
        meshes = []
        for path in args.workspaces:
            workspace = copy_workspace(pathlib.Path(path).resolve(), folder)
            meshes.append((workspace, mesh_workspace(args, workspace)))
        rows = [["as it is", ""] + figures(args, meshes, folder)]
        for file, constant, values in CONSTANTS:
            path = folder / "source" / "src" / file
            if args.only not in constant:
                continue
            text = path.read_text()
            pattern = re.compile(rf"(\b{constant} = )([^;]+)(;)")
            if len(pattern.findall(text)) != 1:
                sys.exit(f"{file}: not one {constant}")
            for value in values:
                path.write_text(pattern.sub(rf"\g<1>{value}\g<3>", text))
                build(folder)
                was = pattern.search(text).group(2)
                rows.append([f"`{constant}` ({file})", f"{was} -> {value}"]
                            + figures(args, meshes, folder))
                print(rows[-1], file=sys.stderr, flush=True)
            path.write_text(text)
        head = ["", ""]
        for workspace, _ in meshes:
            head += [f"{workspace.name} mean", "median"]
        print_table("Constants of the refinement, accuracy, 1e-3 units", head,
                    rows)


if __name__ == "__main__":
    main()
