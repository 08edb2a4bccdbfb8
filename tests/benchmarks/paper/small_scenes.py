"""Small scenes for the tests, laid out as DTU and EPFL are."""

import os
import pathlib
import struct
import tempfile
import unittest
import zlib

import numpy as np

from cameras import Camera

SIZE = (320, 240)  # width, height, px


class InFolder(unittest.TestCase):
    """Tests with a folder of their own."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)


def colmap_program():
    """The colmap to test with, or None."""
    default = (pathlib.Path(__file__).resolve().parents[3]
               / "build" / "release" / "bin" / "colmap")
    program = pathlib.Path(os.environ.get("COLMAP_EXT_COLMAP", default))
    return program if program.is_file() else None


def rotation_about(axis, angle):
    """Rotation [3, 3] by an angle in radians (Rodrigues)."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return (np.eye(3) + np.sin(angle) * cross
            + (1 - np.cos(angle)) * cross @ cross)


def random_camera(rng):
    intrinsics = np.array([[rng.uniform(200, 3000), 0, rng.uniform(100, 900)],
                           [0, rng.uniform(200, 3000), rng.uniform(100, 900)],
                           [0, 0, 1]])
    rotation = rotation_about(rng.normal(size=3), rng.uniform(-np.pi, np.pi))
    return Camera(intrinsics, rotation, rng.normal(size=3) * 100)


def cameras_above_plane(count=8):
    """Cameras that look down on the square [-1, 1]^2 of the plane z = 0 from
    a ring, each rolled further than the last, so that an offset common to all
    images is no motion of the scene."""
    intrinsics = np.array([[400, 0, 161.0], [0, 396, 118.5], [0, 0, 1]])
    cameras = []
    for i in range(count):
        angle = 2 * np.pi * i / count
        center = np.array([0.9 * np.cos(angle), 0.9 * np.sin(angle), 3.0])
        z = -center / np.linalg.norm(center)
        x = np.cross([0, 1, 0], z)
        x /= np.linalg.norm(x)
        rotation = (rotation_about([0, 0, 1], 2.1 * i)
                    @ np.array([x, np.cross(z, x), z]))
        cameras.append(Camera(intrinsics, rotation, -rotation @ center))
    return cameras


def texture(points):
    """Grey values [n] at points [n, 2] of the plane: smooth blobs."""
    rng = np.random.default_rng(7)
    values = np.full(len(points), 128.0)
    for _ in range(150):
        center, radius = rng.uniform(-1.5, 1.5, 2), rng.uniform(0.03, 0.12)
        squared = ((points - center) ** 2).sum(axis=1)
        values += rng.uniform(-110, 110) * np.exp(-squared / radius ** 2)
    return np.clip(values, 0, 255)


def render_plane(camera, pixel_center, size=SIZE):
    """The image [height, width], uint8, that a camera takes of the plane; its
    first pixel's centre is at (pixel_center, pixel_center)."""
    y, x = np.mgrid[:size[1], :size[0]] + pixel_center
    pixels = np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 3)
    rays = pixels @ np.linalg.inv(camera.intrinsics).T @ camera.rotation
    center = camera.center()
    points = center - rays * (center[2] / rays[:, 2:])
    grey = texture(points[:, :2]).round().astype(np.uint8)
    return grey.reshape(size[::-1])


def write_png(path, image):
    """Writes an image [height, width], uint8."""
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data
                + struct.pack(">I", zlib.crc32(kind + data)))
    height, width = image.shape
    rows = np.hstack([np.zeros((height, 1), np.uint8), image]).tobytes()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def blank(_):
    return np.zeros(SIZE[::-1], np.uint8)


def write_dtu(root, scan, render=blank):
    """Images, render(camera), and their matrices, without truth; returns the
    cameras, by position from 1."""
    cameras = cameras_above_plane()
    for i, camera in enumerate(cameras, start=1):
        write_png(root / "Rectified" / f"scan{scan}" /
                  f"rect_{i:03d}_3_r5000.png", render(camera))
        path = root / "Calibration" / "cal18" / f"pos_{i:03d}.txt"
        path.parent.mkdir(parents=True, exist_ok=True)
        np.savetxt(path, -1.7 * camera.projection(), fmt="%.17g")
    return cameras


def strecha_text(camera, size):
    """A .camera file."""
    def rows(matrix):
        return "".join(" ".join(f"{x:.17g}" for x in row) + " \n"
                       for row in matrix)
    return (rows(camera.intrinsics) + "0 0 0\n" + rows(camera.rotation.T)
            + rows([camera.center()]) + f"{size[0]} {size[1]}\n")


def write_epfl(folder, count=3):
    """Blank images and their .camera files; returns the cameras."""
    cameras = cameras_above_plane()[:count]
    for i, camera in enumerate(cameras):
        write_png(folder / "images" / f"{i:04d}.png", blank(camera))
        path = folder / "cameras" / f"{i:04d}.png.camera"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(strecha_text(camera, SIZE))
    return cameras


def write_fused(folder, num_images, points):
    """fused.ply and fused.ply.vis of points [n, 3] seen by all images."""
    folder.mkdir(parents=True, exist_ok=True)
    layout = np.dtype([(a, "<f4") for a in ("x", "y", "z", "nx", "ny", "nz")]
                      + [(c, "u1") for c in ("red", "green", "blue")])
    table = np.zeros(len(points), layout)
    for axis, column in zip("xyz", points.T):
        table[axis] = column
    table["nz"] = 1
    kinds = {"<f4": "float", "|u1": "uchar"}
    header = ["ply", "format binary_little_endian 1.0",
              f"element vertex {len(points)}",
              *(f"property {kinds[layout[n].str]} {n}" for n in layout.names),
              "end_header", ""]
    (folder / "fused.ply").write_bytes(
        "\n".join(header).encode() + table.tobytes())
    row = struct.pack(f"<{num_images + 1}I", num_images, *range(num_images))
    (folder / "fused.ply.vis").write_bytes(
        struct.pack("<Q", len(points)) + row * len(points))
