"""Writes COLMAP workspaces with known cameras."""

import dataclasses
import pathlib
import sqlite3
import struct

import numpy as np

from cameras import Camera, pinhole_parameters, quaternion

PINHOLE = 1  # COLMAP's number of the model with fx, fy, cx, cy


@dataclasses.dataclass
class View:
    """An image with its known camera, in COLMAP's conventions."""
    path: pathlib.Path  # of the image
    camera: Camera      # centre of the first pixel at (0.5, 0.5)
    size: tuple         # width, height of the image, px

    @property
    def name(self):
        return self.path.name


def number(value):
    """Decimal text that reads back as the same double."""
    return repr(float(value))


def distinct_cameras(views):
    """Camera ids from 1 of each view, and {id: (size, parameters)}: views of
    one size with the same intrinsics share a camera."""
    ids = {}
    camera_ids = [
        ids.setdefault((view.size, pinhole_parameters(view.camera, view.size)),
                       len(ids) + 1)
        for view in views]
    return camera_ids, {i: key for key, i in ids.items()}


def write_model(folder, views):
    """Writes cameras.txt, images.txt and an empty points3D.txt. Image ids
    count from 1 in the order of the names."""
    folder.mkdir(parents=True, exist_ok=True)
    views = sorted(views, key=lambda view: view.name)
    camera_ids, cameras = distinct_cameras(views)
    lines = [
        " ".join([str(i), "PINHOLE", *map(str, size), *map(number, params)])
        for i, (size, params) in cameras.items()]
    (folder / "cameras.txt").write_text("\n".join(lines) + "\n")
    lines = []
    for i, (view, camera_id) in enumerate(zip(views, camera_ids), start=1):
        pose = [*quaternion(view.camera.rotation), *view.camera.translation]
        lines += [" ".join([str(i), *map(number, pose), str(camera_id),
                            view.name]), ""]  # no observations
    (folder / "images.txt").write_text("\n".join(lines) + "\n")
    (folder / "points3D.txt").write_text("")


def link(target, path):
    """Makes path a symbolic link to target, whatever file was there."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    path.symlink_to(target.resolve())


def write_stereo_lists(workspace, views, num_sources=20):
    """What patch_match_stereo and stereo_fusion read besides the model:
    every image, with the num_sources best source images of COLMAP's choice."""
    stereo = workspace / "stereo"
    for folder in ("depth_maps", "normal_maps", "consistency_graphs"):
        (stereo / folder).mkdir(parents=True, exist_ok=True)
    names = sorted(view.name for view in views)
    (stereo / "patch-match.cfg").write_text(
        "".join(f"{name}\n__auto__, {num_sources}\n" for name in names))
    (stereo / "fusion.cfg").write_text("".join(f"{n}\n" for n in names))


def write_workspace(workspace, views):
    """Makes images/ (links), sparse/ (the known cameras) and stereo/."""
    for view in views:
        link(view.path, workspace / "images" / view.name)
    write_model(workspace / "sparse", views)
    write_stereo_lists(workspace, views)


def set_database_cameras(database, views):
    """Gives the images of a COLMAP database their known intrinsics, so that
    matches are verified by them; after feature_extractor, before a matcher."""
    connection = sqlite3.connect(database)
    with connection:
        for view in views:
            params = np.array(pinhole_parameters(view.camera, view.size))
            changed = connection.execute(
                "UPDATE cameras SET model = ?, width = ?, height = ?,"
                " params = ?, prior_focal_length = 1 WHERE camera_id ="
                " (SELECT camera_id FROM images WHERE name = ?)",
                (PINHOLE, *view.size, struct.pack("<4d", *params), view.name))
            if changed.rowcount != 1:
                raise ValueError(f"{database}: no image {view.name}.")
    connection.close()
