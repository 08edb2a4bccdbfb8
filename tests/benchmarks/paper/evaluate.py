"""Figures of a mesh, by mesh_evaluator."""

import json

import dtu
import published

EVALUATOR = "mesh_evaluator"


def run_evaluator(colmap, options, output):
    """Runs mesh_evaluator; returns its JSON, which is left in output."""
    output.parent.mkdir(parents=True, exist_ok=True)
    output.unlink(missing_ok=True)
    colmap.run(EVALUATOR, {**options, "json_path": output},
               output.with_suffix(".txt"))
    return json.loads(output.read_text())


def numbers(values):
    """As mesh_evaluator's options take several numbers."""
    return ",".join(repr(float(value)) for value in values)


def unless_missing(figures):
    """The figures; None if there is one that mesh_evaluator could not tell."""
    return None if None in figures else figures


def dtu_metrics(colmap, mesh, root, scan, workspace):
    """The paper's five metrics in mm, by DTU's protocol: the whole surfaces,
    the mesh within the mask, the truth above the plane, at the protocol's
    spacing, distances beyond its maximum left out."""
    mask = workspace / "truth" / "observability.npy"
    box = dtu.convert_mask(root / "ObsMask" / f"ObsMask{scan}_10.mat", mask)
    plane = dtu.read_plane(root / "ObsMask" / f"Plane{scan}.mat")
    result = run_evaluator(colmap, {
        "mesh_path": mesh,
        "truth_path": dtu.truth_path(root, scan),
        "observability_mask": mask,
        "observability_box": numbers(box),
        "ground_plane": numbers(plane),
        "MeshEvaluation.spacing": dtu.POINT_SPACING,
        "MeshEvaluation.max_distance": dtu.MAX_DISTANCE,
        "MeshEvaluation.drop_beyond": 1,
    }, workspace / "evaluation" / f"{mesh.stem}.json")
    accuracy, completeness = result["accuracy"], result["completeness"]
    return unless_missing([
        accuracy["mean"], accuracy["median"], completeness["mean"],
        completeness["median"], result["average_score"]])


def epfl_shares(colmap, mesh, workspace, truth):
    """Shares of the true depths with an error below the paper's thresholds;
    truth: the scanned mesh or a folder of depth maps."""
    result = run_evaluator(colmap, {
        "mesh_path": mesh,
        "truth_path": truth,
        "workspace_path": workspace,
        "MeshEvaluation.depth_thresholds": numbers(published.EPFL_THRESHOLDS),
    }, workspace / "evaluation" / f"{mesh.stem}.json")
    return unless_missing(result["depths"]["shares"])
