"""Meshes, refines and evaluates COLMAP's dense workspaces by the program colmap_ext."""

from .commands import evaluate, mesh, refine
from .errors import (ColmapExtError, CommandError, CrashError, OptionError,
                     ProgramNotFoundError, StoppedError)
from .ply import Ply, read_ply, write_ply
from .visibility import Visibility, read_vis, write_vis

__version__ = "0.1.0"

__all__ = [
    "ColmapExtError", "CommandError", "CrashError", "OptionError", "Ply",
    "ProgramNotFoundError", "StoppedError", "Visibility", "evaluate", "mesh",
    "read_ply", "read_vis", "refine", "write_ply", "write_vis",
]
