"""Pinhole cameras of DTU and of EPFL (Strecha) in COLMAP's conventions.

Frames: the world is the data set's (DTU: mm, EPFL: m); cameras look along +z,
x to the right, y down. Image coordinates are pixels.

Where the centre of the first pixel lies:

  COLMAP (0.5, 0.5).
  DTU    (0, 0). pos_NNN.txt come from Bouguet's Matlab toolbox (its files
         Calib_Results_*.mat lie beside them in cal18), which subtracts one
         from Matlab's coordinates "to bring the origin to (0,0)". That the
         images of Rectified were resampled by the same convention is likely,
         for the toolbox does it so, but documented nowhere.
  EPFL   (0.5, 0.5), by measurement, for no document says. COLMAP's features on
         fountain-P11, triangulated with the .camera files as they are, show an
         offset of 0.13 +- 0.21 px in x and -0.03 +- 0.15 px in y (14921
         tracks, jackknife over the images); (0, 0) predicts 0.5, (1, 1) -0.5.

Both can be overridden where workspaces are made (--pixel_center).
"""

import dataclasses
import re

import numpy as np

COLMAP_PIXEL_CENTER = 0.5
DTU_PIXEL_CENTER = 0.0
EPFL_PIXEL_CENTER = 0.5

# COLMAP's PINHOLE has no skew: what it may move a pixel at the image border.
MAX_SKEW_EFFECT = 0.1  # px


@dataclasses.dataclass
class Camera:
    """x ~ intrinsics (rotation X + translation), X in the world."""
    intrinsics: np.ndarray   # [3, 3], px, upper triangular, [2, 2] = 1
    rotation: np.ndarray     # [3, 3], cam_from_world
    translation: np.ndarray  # [3], cam_from_world, units of the world

    def center(self):
        """Projection centre, [3], in the world."""
        return -self.rotation.T @ self.translation

    def projection(self):
        """The matrix [3, 4] from the world to homogeneous pixels."""
        return self.intrinsics @ np.column_stack(
            [self.rotation, self.translation])

    def with_pixel_center(self, source, target=COLMAP_PIXEL_CENTER):
        """The camera with the first pixel's centre at (target, target), of
        one that has it at (source, source)."""
        intrinsics = self.intrinsics.copy()
        intrinsics[:2, 2] += target - source
        return dataclasses.replace(self, intrinsics=intrinsics)


def rq(matrix):
    """matrix [3, 3] = upper triangular [3, 3] times orthogonal [3, 3], the
    diagonal of the first positive."""
    flip = np.eye(3)[::-1]
    q, r = np.linalg.qr((flip @ matrix).T)
    upper, orthogonal = flip @ r.T @ flip, flip @ q.T
    signs = np.where(np.diag(upper) < 0, -1.0, 1.0)
    return upper * signs, signs[:, None] * orthogonal


def decompose_projection(projection):
    """The camera of a projection matrix [3, 4], known up to any factor.

    The sign of the factor is found by the determinant: with a positive focal
    length and a right-handed camera it has to be positive, and then points in
    front of the camera have positive depth.
    """
    projection = np.asarray(projection, dtype=float)
    if projection.shape != (3, 4) or not np.isfinite(projection).all():
        raise ValueError("A projection matrix has three rows of four numbers.")
    determinant = np.linalg.det(projection[:, :3])
    scale = np.linalg.norm(projection[2, :3])
    if abs(determinant) <= 1e-12 * np.abs(projection[:, :3]).max() ** 3:
        raise ValueError("The projection matrix is singular.")
    projection = projection * (np.sign(determinant) / scale)
    upper, rotation = rq(projection[:, :3])
    translation = np.linalg.solve(upper, projection[:, 3])
    return Camera(upper / upper[2, 2], rotation, translation)


def read_dtu_projection(path):
    """The camera of DTU's Calibration/cal18/pos_NNN.txt, as it is there."""
    return decompose_projection(np.loadtxt(path))


def read_strecha_camera(path):
    """The camera of EPFL's NNNN.*.camera, as it is there, and its image's
    width and height in px.

    Three rows of K, a row of zeros (radial distortion), three rows of R, the
    camera's centre C, the size of the image: x ~ K [R^T | -R^T C] X.
    """
    numbers = np.array(path.read_text().split(), dtype=float)
    if numbers.size != 26:
        raise ValueError(f"{path}: 26 numbers expected, {numbers.size} found.")
    if numbers[9:12].any():
        raise ValueError(f"{path}: the image is distorted.")
    rotation = numbers[12:21].reshape(3, 3).T
    camera = Camera(numbers[:9].reshape(3, 3), nearest_rotation(rotation),
                    np.zeros(3))
    camera.translation = -camera.rotation @ numbers[21:24]
    return camera, (int(numbers[24]), int(numbers[25]))


def nearest_rotation(matrix):
    """The rotation nearest to a matrix [3, 3] that was rounded in print."""
    u, singular_values, vt = np.linalg.svd(matrix)
    rotation = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    if np.abs(singular_values - 1).max() > 1e-3 or np.linalg.det(matrix) < 0:
        raise ValueError("Not a rotation matrix.")
    return rotation


def quaternion(rotation):
    """Unit quaternion (w, x, y, z), w >= 0, of a rotation [3, 3].

    The eigenvector of the largest eigenvalue of a symmetric matrix (Bar-Itzhack
    2000): no case distinction, stable for every angle.
    """
    r = rotation
    symmetric = np.array([
        [r[0, 0] + r[1, 1] + r[2, 2], 0, 0, 0],
        [r[2, 1] - r[1, 2], r[0, 0] - r[1, 1] - r[2, 2], 0, 0],
        [r[0, 2] - r[2, 0], r[0, 1] + r[1, 0],
         r[1, 1] - r[0, 0] - r[2, 2], 0],
        [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1],
         r[2, 2] - r[0, 0] - r[1, 1]],
    ])
    _, vectors = np.linalg.eigh(symmetric)  # reads the lower triangle
    vector = vectors[:, -1]
    return -vector if vector[0] < 0 else vector


def pinhole_parameters(camera, size):
    """fx, fy, cx, cy in px; refuses a skew that shows, which PINHOLE has not.
    size: width and height of the image in px."""
    (fx, skew, cx), (_, fy, cy) = camera.intrinsics[:2]
    if abs(skew) * size[1] / fy > MAX_SKEW_EFFECT:
        raise ValueError(f"A skew of {skew:.3g} cannot be kept.")
    return fx, fy, cx, cy


def image_number(name):
    """The first number in a file's name: 3 for rect_003_max.png."""
    match = re.search(r"\d+", name)
    if not match:
        raise ValueError(f"No number in the name of {name}.")
    return int(match.group())
