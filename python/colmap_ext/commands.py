"""The program's commands as functions."""

import dataclasses
import json
import os
import tempfile
from collections.abc import Mapping
from typing import Any, Optional, Union

from .base_options import BaseOptions, StrPath
from .options import (DelaunayManifoldMeshingOptions, FacetwiseRefinementOptions,
                      MeshEvaluationOptions)
from .program import find_program, make_arguments, run
from .progress import ProgressCallback, show_progress


def _run(command: str, paths: Mapping[str, StrPath], options: BaseOptions,
         program: Optional[StrPath], progress: Union[bool, ProgressCallback]) -> None:
    options.check()
    arguments = make_arguments(find_program(program), command,
                               {**paths, **options.given()})
    with show_progress(progress) as callback:
        run(arguments, callback)


def delaunay_manifold_meshing(
        input_path: StrPath, output_path: StrPath,
        options: DelaunayManifoldMeshingOptions = DelaunayManifoldMeshingOptions(), *,
        program: Optional[StrPath] = None,
        progress: Union[bool, ProgressCallback] = False) -> None:
    """Meshes a dense workspace (delaunay_manifold_mesher).

    input_path: the workspace, a folder with sparse/, fused.ply and fused.ply.vis; for
        input_type="sparse" the sparse model.
    output_path: the mesh to write, PLY, with its .vis.
    program: a path or a name; default: the environment's COLMAP_EXT, else colmap_ext
        or else colmap of the PATH.
    progress: a function that is called with each Progress; True shows a bar of tqdm,
        or prints lines without tqdm.
    Raises ValueError if an option is out of its range, and ColmapExtError. Ctrl-C, or
    an exception of progress, ends the program; existing files are unchanged.
    """
    _run("delaunay_manifold_mesher",
         {"input_path": input_path, "output_path": output_path}, options, program,
         progress)


def facetwise_refinement(
        workspace_path: StrPath, input_path: StrPath, output_path: StrPath,
        options: FacetwiseRefinementOptions = FacetwiseRefinementOptions(), *,
        program: Optional[StrPath] = None,
        progress: Union[bool, ProgressCallback] = False) -> None:
    """Refines a mesh by the images of its workspace (facetwise_refiner).

    workspace_path: a folder with images/ and sparse/.
    input_path: the mesh, PLY, with its .vis if there is one.
    output_path: the refined mesh to write, PLY, with its .vis.
    The rest is as that of delaunay_manifold_meshing(). After Ctrl-C the same call with
    resume=True continues from the last complete level, with the same result.
    """
    _run("facetwise_refiner",
         {"workspace_path": workspace_path, "input_path": input_path,
          "output_path": output_path}, options, program, progress)


def mesh_evaluation(
        mesh_path: StrPath, truth_path: StrPath,
        options: MeshEvaluationOptions = MeshEvaluationOptions(), *,
        program: Optional[StrPath] = None,
        progress: Union[bool, ProgressCallback] = False) -> dict[str, Any]:
    """Measures a mesh against ground truth (mesh_evaluator).

    mesh_path: the mesh, PLY.
    truth_path: a mesh or points, PLY, or a folder of COLMAP's depth maps.
    The rest is as that of delaunay_manifold_meshing().
    Returns the figures as the command's --json_path has them.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = options.json_path or os.path.join(folder, "figures.json")
        _run("mesh_evaluator", {"mesh_path": mesh_path, "truth_path": truth_path},
             dataclasses.replace(options, json_path=path), program, progress)
        with open(path, encoding="utf-8") as file:
            figures: dict[str, Any] = json.load(file)
            return figures
