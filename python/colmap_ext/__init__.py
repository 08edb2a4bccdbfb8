"""Meshes, refines and evaluates COLMAP's dense workspaces by the program colmap_ext."""

import pathlib

from .commands import delaunay_manifold_meshing, facetwise_refinement, mesh_evaluation
from .errors import (ColmapExtError, CommandError, CrashError, OptionError,
                     ProgramNotFoundError, StoppedError)
from .options import (DelaunayManifoldMeshingOptions, FacetwiseRefinementOptions,
                      MeshEvaluationOptions)
from .ply import Ply, read_ply, write_ply
from .progress import Progress
from .visibility import Visibility, read_vis, write_vis

__version__ = (pathlib.Path(__file__).parent / "VERSION").read_text().strip()

__all__ = [
    "ColmapExtError", "CommandError", "CrashError", "DelaunayManifoldMeshingOptions",
    "FacetwiseRefinementOptions", "MeshEvaluationOptions", "OptionError", "Ply",
    "ProgramNotFoundError", "Progress", "StoppedError", "Visibility",
    "delaunay_manifold_meshing", "facetwise_refinement", "mesh_evaluation", "read_ply",
    "read_vis", "write_ply", "write_vis",
]
