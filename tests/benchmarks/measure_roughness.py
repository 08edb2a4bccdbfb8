#!/usr/bin/env python3
"""Measures how rough meshes are where the true surface is plane: the front of a
workspace of "make_workspace --scene wall --relief 0". Needs NumPy, SciPy and
PYTHONPATH=python.

  measure_roughness.py WORKSPACE MESH.ply ...

Prints quartiles of the heights' RMS within 10 px around points of the planes,
from the plane that fits them, in footprints of a pixel.
"""

import argparse
import pathlib

import numpy as np
from scipy.spatial import cKDTree

from colmap_ext import read_ply

RADIUS = 10  # px


def double_areas(mesh):
    """Normals [F, 3] of the faces, twice as long as their areas."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]].astype(float) for i in range(3))
    return np.cross(b - a, c - a)


def footprint(model, vertices):
    """Of a pixel on the surface, by the median distance of the cameras."""
    def rows(name):
        lines = (model / name).read_text().splitlines()
        return [line.split() for line in lines if not line.startswith("#")]

    centers = []
    for row in rows("images.txt")[::2]:
        w, x, y, z, *translation = map(float, row[1:8])
        rotation = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
        centers.append(-np.transpose(rotation) @ translation)
    distances = np.linalg.norm(
        vertices[::50, None] - np.array(centers)[None], axis=2)
    return np.median(distances) / float(rows("cameras.txt")[0][4])


def find_planes(truth, pixel):
    """Which vertices of the true surface [V] are on the plane y = 0, away from
    its ends."""
    areas = double_areas(truth)
    normals = np.zeros(truth.vertices.shape)
    for corner in range(3):
        np.add.at(normals, truth.faces[:, corner], areas)
    is_front = ((abs(truth.vertices[:, 1]) < 1e-4) &
                (normals[:, 1] < -0.9999 * np.linalg.norm(normals, axis=1)))
    ends = cKDTree(truth.vertices[~is_front])
    return is_front & (ends.query(truth.vertices)[0] > RADIUS * pixel)


def sample(mesh, pixel):
    """One random point for each square of a pixel's footprint."""
    random = np.random.default_rng(1)
    areas = np.linalg.norm(double_areas(mesh), axis=1) / 2
    faces = random.choice(len(areas), int(areas.sum() / pixel**2),
                          p=areas / areas.sum())
    weights = random.random((len(faces), 2))
    weights = np.where(weights.sum(axis=1, keepdims=True) > 1, 1 - weights,
                       weights)
    a, b, c = (mesh.vertices[mesh.faces[faces, i]] for i in range(3))
    return a + weights[:, :1] * (b - a) + weights[:, 1:] * (c - a)


def roughness(points, pixel):
    """[points], in footprints; every seventh point, where it has neighbors."""
    tree = cKDTree(points)
    results = []
    for center in points[::7]:
        near = points[tree.query_ball_point(center, RADIUS * pixel)]
        if len(near) >= 15:
            plane = np.c_[np.ones(len(near)), (near - center)[:, [0, 2]]]
            fit = np.linalg.lstsq(plane, near[:, 1], rcond=None)[0]
            rms = np.sqrt(np.mean((near[:, 1] - plane @ fit)**2))
            results.append(rms / pixel)
    return results


def quartiles(workspace, meshes):
    """[25th, 50th, 75th percentile] of the roughness of each mesh file."""
    truth = read_ply(workspace / "truth" / "mesh.ply")
    pixel = footprint(workspace / "truth", truth.vertices)
    is_plane = find_planes(truth, pixel)
    tree = cKDTree(truth.vertices)
    for path in meshes:
        points = sample(read_ply(path), pixel)
        distances, nearest = tree.query(points)
        points = points[is_plane[nearest] & (distances < 3 * pixel)]
        yield np.percentile(roughness(points, pixel), [25, 50, 75])


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("workspace", type=pathlib.Path)
    parser.add_argument("meshes", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    results = quartiles(options.workspace, options.meshes)
    for path, result in zip(options.meshes, results):
        print(path, *(f"{value:.4f}" for value in result))


if __name__ == "__main__":
    main()
