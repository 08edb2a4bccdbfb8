"""Depth maps with the truth, from the forms they are passed round in, as
COLMAP's .bin: depth along the camera's z axis, 0 where there is none."""

import re

import numpy as np


def write_colmap_map(path, depths):
    """Writes depths [height, width] as COLMAP does: "width&height&1&", then
    float32, little-endian, row by row."""
    height, width = depths.shape
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "wb") as file:
        file.write(f"{width}&{height}&1&".encode())
        file.write(np.ascontiguousarray(depths, dtype="<f4").tobytes())


def read_colmap_map(path):
    """Depths [height, width]."""
    data = path.read_bytes()
    head = re.match(rb"(\d+)&(\d+)&1&", data)
    if not head:
        raise ValueError(f"{path} is no depth map of COLMAP's.")
    width, height = map(int, head.groups())
    depths = np.frombuffer(data, dtype="<f4", offset=head.end())
    return depths.reshape(height, width)


def read_pfm(path):
    """Depths [height, width] of a PFM of one channel, which is stored from
    the bottom row up."""
    data = path.read_bytes()
    head = re.match(rb"Pf\s+(\d+)\s+(\d+)\s+(\S+)\s", data)
    if not head:
        raise ValueError(f"{path} is no PFM of one channel.")
    width, height = int(head.group(1)), int(head.group(2))
    kind = "<f4" if float(head.group(3)) < 0 else ">f4"
    depths = np.frombuffer(data, dtype=kind, offset=head.end())
    return depths.reshape(height, width)[::-1]


def read_depths(path):
    """Depths [height, width] of a .bin (COLMAP), .pfm or .npy."""
    readers = {".bin": read_colmap_map, ".pfm": read_pfm, ".npy": np.load}
    if path.suffix not in readers:
        raise ValueError(f"{path}: depth maps are .bin, .pfm or .npy.")
    depths = np.array(readers[path.suffix](path), dtype=float)
    depths[~(np.isfinite(depths) & (depths > 0))] = 0
    return depths


def ray_to_z(depths, camera):
    """Depth along z from the distance along each pixel's ray; both
    [height, width]. camera: pixel centres at (x + 0.5, y + 0.5), and of the
    depth map's size."""
    height, width = depths.shape
    y, x = np.mgrid[:height, :width] + 0.5
    pixels = np.stack([x, y, np.ones_like(x)], axis=-1)
    rays = pixels @ np.linalg.inv(camera.intrinsics).T
    return depths / np.linalg.norm(rays, axis=-1)
