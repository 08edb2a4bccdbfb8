"""The meshes of an ablation: mesher, then refiner."""

import re

import settings


def counted(report, label):
    """The number in the line of a command's report that starts with a label,
    or None."""
    match = re.search(rf"^\s*{re.escape(label)}\s+(\d+)\s*$", report,
                      re.MULTILINE)
    return int(match.group(1)) if match else None


def singular_vertices(report):
    """Singular vertices (of the cut, after preemptive fixing) that the mesher
    reports; None where it does not say."""
    return counted(report, "of the cut"), counted(report, "after fixing")


def make_initial_mesh(colmap, workspace, meshing, name):
    """Runs the mesher with options, once; returns the mesh and the report."""
    mesh = workspace / "meshes" / f"{name}.ply"
    log = workspace / "logs" / f"{name}.txt"
    if mesh.exists() and log.exists():
        return mesh, log.read_text()
    mesh.parent.mkdir(parents=True, exist_ok=True)
    report = colmap.run(settings.MESHER, {
        "input_path": workspace, "output_path": mesh, **meshing}, log)
    return mesh, report


def refine(colmap, workspace, mesh, name, options):
    """Runs the refiner on a mesh; returns the refined one."""
    refined = workspace / "meshes" / f"{name}.ply"
    colmap.run(settings.REFINER, {
        "workspace_path": workspace, "input_path": mesh,
        "output_path": refined, **options,
    }, workspace / "logs" / f"{name}.txt")
    return refined


def can_make(colmap, ablation):
    """Whether this colmap has what an ablation needs."""
    if settings.MESHER not in colmap.commands:
        return False
    return ablation == "initial" or settings.REFINER in colmap.commands


def make_mesh(colmap, workspace, setting, ablation):
    """The mesh of an ablation and the report of its mesher."""
    meshing = dict(settings.MESHING[setting])
    if ablation == "no_fixing":
        meshing.update(settings.NO_FIXING)
    start = "no_fixing-start" if ablation == "no_fixing" else "initial"
    mesh, report = make_initial_mesh(
        colmap, workspace, meshing, f"{setting}-{start}")
    if ablation != "initial":
        options = settings.WHOLE_MESH if ablation == "whole_mesh" else {}
        mesh = refine(colmap, workspace, mesh, f"{setting}-{ablation}",
                      options)
    return mesh, report
