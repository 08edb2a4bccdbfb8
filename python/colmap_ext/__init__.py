"""Meshes, refines and evaluates COLMAP's dense workspaces by the program colmap_ext."""

import pathlib

from .commands import evaluate, mesh, refine
from .errors import (ColmapExtError, CommandError, CrashError, OptionError,
                     ProgramNotFoundError, StoppedError)
from .ply import Ply, read_ply, write_ply
from .visibility import Visibility, read_vis, write_vis

__version__ = (pathlib.Path(__file__).parent / "VERSION").read_text().strip()

__all__ = [
    "ColmapExtError", "CommandError", "CrashError", "OptionError", "Ply",
    "ProgramNotFoundError", "StoppedError", "Visibility", "evaluate", "mesh",
    "read_ply", "read_vis", "refine", "write_ply", "write_vis",
]
