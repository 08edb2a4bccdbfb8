"""A tiny dense workspace: a colored sphere and a ring of cameras around it."""

import math
import pathlib
import struct

WIDTH, HEIGHT, FOCAL = 80, 60, 90.0
NUM_IMAGES, NUM_POINTS = 7, 1500


def _cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0]]


def _unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def _camera(index):
    """(centre, rows of the rotation)"""
    angle = 2 * math.pi * index / NUM_IMAGES
    center = [4 * math.cos(angle), 4 * math.sin(angle), 1]
    forward = _unit([-x for x in center])
    right = _unit(_cross(forward, [0, 0, 1]))
    return center, [right, _cross(forward, right), forward]


def _quaternion(r):
    """w, x, y, z of a rotation that is no half turn."""
    w = math.sqrt(max(0.0, 1 + r[0][0] + r[1][1] + r[2][2])) / 2
    x = math.copysign(math.sqrt(max(0.0, 1 + r[0][0] - r[1][1] - r[2][2])) / 2,
                      r[2][1] - r[1][2])
    y = math.copysign(math.sqrt(max(0.0, 1 - r[0][0] + r[1][1] - r[2][2])) / 2,
                      r[0][2] - r[2][0])
    z = math.copysign(math.sqrt(max(0.0, 1 - r[0][0] - r[1][1] + r[2][2])) / 2,
                      r[1][0] - r[0][1])
    return w, x, y, z


def _color(point):
    return [int(127.5 + 110 * math.sin(9 * x + i)) for i, x in enumerate(point)]


def _picture(index):
    center, rotation = _camera(index)
    pixels = bytearray()
    for row in range(HEIGHT):
        for col in range(WIDTH):
            in_camera = [(col + 0.5 - WIDTH / 2) / FOCAL,
                         (row + 0.5 - HEIGHT / 2) / FOCAL, 1]
            ray = _unit([sum(rotation[k][i] * in_camera[k] for k in range(3))
                         for i in range(3)])
            b = _dot(center, ray)
            discriminant = b * b - _dot(center, center) + 1
            hit = discriminant > 0
            depth = -b - math.sqrt(discriminant) if hit else 0
            pixels += bytes(_color([c + depth * r for c, r in zip(center, ray)])
                            if hit else [0, 0, 0])
    return b"P6\n%d %d\n255\n" % (WIDTH, HEIGHT) + bytes(pixels)


def _points():
    for i in range(NUM_POINTS):
        z = 1 - 2 * (i + 0.5) / NUM_POINTS
        angle = i * math.pi * (3 - math.sqrt(5))
        radius = math.sqrt(1 - z * z)
        point = [radius * math.cos(angle), radius * math.sin(angle), z]
        views = [k for k in range(NUM_IMAGES)
                 if _dot(point, _unit([c - p for c, p in zip(_camera(k)[0], point)])) > 0.2]
        if views:
            # A little rough, or no point would lie within others and be thinned.
            radius = 1 + 0.02 * (i * 7919 % 13 / 13 - 0.5)
            yield [radius * x for x in point], views


def write(folder):
    """Writes the workspace. Returns the number of its fused points."""
    folder = pathlib.Path(folder)
    (folder / "sparse").mkdir(parents=True)
    (folder / "images").mkdir()
    (folder / "sparse" / "cameras.bin").write_bytes(
        struct.pack("<QIiQQ4d", 1, 1, 1, WIDTH, HEIGHT, FOCAL, FOCAL, WIDTH / 2,
                    HEIGHT / 2))
    images = struct.pack("<Q", NUM_IMAGES)
    for i in range(NUM_IMAGES):
        center, rotation = _camera(i)
        images += struct.pack("<I7dI", i + 1, *_quaternion(rotation),
                              *[-_dot(row, center) for row in rotation], 1)
        images += b"%d.ppm\0" % i + struct.pack("<Q", 0)
        (folder / "images" / f"{i}.ppm").write_bytes(_picture(i))
    (folder / "sparse" / "images.bin").write_bytes(images)
    points = list(_points())
    sparse = [(i, p) for i, p in enumerate(points) if i % 10 == 0]
    (folder / "sparse" / "points3D.bin").write_bytes(
        struct.pack("<Q", len(sparse)) + b"".join(
            struct.pack("<Q3d3BdQ", i, *point, *_color(point), 0.5, len(views))
            + b"".join(struct.pack("<II", view + 1, 0) for view in views)
            for i, (point, views) in sparse))
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    header += [f"property uchar {name}" for name in ("red", "green", "blue")]
    (folder / "fused.ply").write_bytes(
        ("\n".join([*header, "end_header", ""])).encode() + b"".join(
            struct.pack("<6f3B", *point, *point, *_color(point)) for point, _ in points))
    (folder / "fused.ply.vis").write_bytes(
        struct.pack("<Q", len(points)) + b"".join(
            struct.pack(f"<I{len(views)}I", len(views), *views) for _, views in points))
    return len(points)
