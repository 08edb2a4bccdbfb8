"""From a workspace with known cameras to its fused points, by COLMAP."""

from colmap_model import link, set_database_cameras

FUSED = ("fused.ply", "fused.ply.vis")


def is_fused(workspace):
    return all((workspace / name).exists() for name in FUSED)


def take_fused(workspace, folder):
    """Links the fused points that lie in another folder and, where it is
    there, their sparse/: fused.ply.vis counts the images in its order, else
    in the order of their names."""
    for name in FUSED:
        if not (folder / name).exists():
            raise FileNotFoundError(f"{folder} has no {name}.")
        link(folder / name, workspace / name)
    for path in sorted((folder / "sparse").glob("*")):
        link(path, workspace / "sparse" / path.name)


def triangulate(colmap, workspace, views):
    """Replaces the empty sparse/ points by triangulated features; the cameras
    stay as they are."""
    database = workspace / "database.db"
    database.unlink(missing_ok=True)
    logs = workspace / "logs"
    gpu = int(colmap.has_cuda)
    colmap.run("feature_extractor", {
        "database_path": database,
        "image_path": workspace / "images",
        "ImageReader.camera_model": "PINHOLE",
        "ImageReader.single_camera_per_image": 1,
        "SiftExtraction.use_gpu": gpu,
    }, logs / "feature_extractor.txt")
    set_database_cameras(database, views)
    colmap.run("exhaustive_matcher", {
        "database_path": database,
        "SiftMatching.use_gpu": gpu,
    }, logs / "exhaustive_matcher.txt")
    colmap.run("point_triangulator", {
        "database_path": database,
        "image_path": workspace / "images",
        "input_path": workspace / "sparse",
        "output_path": workspace / "sparse",
        "clear_points": 1,  # takes the database's image ids, too
    }, logs / "point_triangulator.txt")


def fuse(colmap, workspace):
    """Depth maps and their fusion, with COLMAP's defaults."""
    logs = workspace / "logs"
    colmap.run("patch_match_stereo", {
        "workspace_path": workspace,
        "PatchMatchStereo.geom_consistency": "true",
    }, logs / "patch_match_stereo.txt")
    colmap.run("stereo_fusion", {
        "workspace_path": workspace,
        "input_type": "geometric",
        "output_path": workspace / "fused.ply",
    }, logs / "stereo_fusion.txt")


def make_dense(colmap, workspace, views):
    """All of it, unless the fused points are there."""
    if is_fused(workspace):
        return
    if not colmap.has_cuda:
        raise FileNotFoundError(f"{workspace} has no fused.ply, and "
                                "patch_match_stereo needs CUDA.")
    triangulate(colmap, workspace, views)
    fuse(colmap, workspace)
