"""The program's commands as functions."""

import json
import os
import re
import tempfile

from .program import find_program, make_arguments, run


def _run_writer(command, options, program, progress):
    """Runs a command that writes a mesh. Returns the mesh's path."""
    printed = run(make_arguments(find_program(program), command, options), progress)
    # "Wrote MESH and MESH.vis", or "Wrote MESH, MESH.vis and CAMERAS, which ...".
    return re.findall(r"^Wrote (.*)(?: and|,) \1\.vis(?: and .*)?$", printed,
                      re.MULTILINE)[-1]


def mesh(workspace, *, output_path=None, program=None, progress=None, **options):
    """Meshes a dense workspace (delaunay_manifold_mesher).

    workspace: the folder with sparse/, fused.ply and fused.ply.vis, or one that
        has it in dense/ or dense/0/; for input_type="sparse" the sparse model.
    output_path: of the mesh; default: meshed-delaunay-manifold.ply in there.
    options: those of the command, without their section: min_confidence=0.2.
    program, progress: see program.find_program() and program.run().
    Returns the path of the mesh, a str; its .vis has the same name.
    Raises ColmapExtError.
    """
    return _run_writer("delaunay_manifold_mesher",
                       {"workspace_path": os.fspath(workspace),
                        "output_path": output_path, **options}, program, progress)


def refine(workspace, *, input_path=None, output_path=None, program=None,
           progress=None, **options):
    """Refines a mesh by the images of its workspace (facetwise_refiner).

    workspace: as that of mesh(), with images/.
    input_path: the mesh; default: that of mesh().
    output_path: the refined one; default: meshed-refined.ply in the workspace;
        required with input_path.
    The rest is as that of mesh().
    """
    return _run_writer("facetwise_refiner",
                       {"workspace_path": os.fspath(workspace),
                        "input_path": input_path, "output_path": output_path,
                        **options}, program, progress)


def evaluate(mesh_path, truth_path, *, workspace=None, program=None, progress=None,
             **options):
    """Measures a mesh (mesh_evaluator).

    truth_path: a mesh or points, PLY, or a folder of COLMAP's depth maps.
    workspace: to count only what its images see.
    The rest is as that of mesh().
    Returns the figures as the command's --json_path has them, a dict.
    """
    with tempfile.TemporaryDirectory() as folder:
        json_path = os.path.join(folder, "figures.json")
        given = {"mesh_path": os.fspath(mesh_path), "truth_path": os.fspath(truth_path),
                 "workspace_path": workspace, "json_path": json_path, **options}
        run(make_arguments(find_program(program), "mesh_evaluator", given), progress)
        with open(given["json_path"], encoding="utf-8") as file:
            return json.load(file)
