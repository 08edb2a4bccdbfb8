"""Whether files are what the commands promise: whole, finite, 2-manifold.

Nothing here is shared with the program that is tested.
"""

import json
import math
import struct
import zlib

import numpy as np

TYPES = {b"float": "<f4", b"double": "<f8", b"uchar": "u1", b"int": "<i4"}


class Fault(Exception):
    """What is wrong with a file."""


def expect(is_right, what):
    """Throws a Fault unless it is right."""
    if not is_right:
        raise Fault(what)


def read_mesh(path):
    """(vertices [V], faces [F, 3]) of a PLY as the commands write it: a
    structured array and corners."""
    data = path.read_bytes()
    end = data.find(b"end_header\n") + len(b"end_header\n")
    expect(data.startswith(b"ply\nformat binary_little_endian 1.0\n")
           and end > len(b"end_header\n"), "no PLY")
    elements = []
    for line in data[:end].splitlines():
        words = line.split()
        if words[0] == b"element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == b"property" and words[1] == b"list":
            elements[-1][2].extend([("count", "u1"), ("corners", "<i4", (3,))])
        elif words[0] == b"property":
            elements[-1][2].append((words[2].decode(), TYPES[words[1]]))
    expect([name for name, *_ in elements] == [b"vertex", b"face"], "elements")
    arrays = []
    for _, count, fields in elements:
        record = np.dtype(fields)
        expect(end + count * record.itemsize <= len(data), "a PLY cut off")
        arrays.append(np.frombuffer(data, record, count, end))
        end += count * record.itemsize
    expect(end == len(data), "a PLY with bytes after its end")
    vertices, faces = arrays
    expect((faces["count"] == 3).all(), "faces of other than three corners")
    return vertices, faces["corners"].astype(np.int64)


def _next_corners(faces, num_vertices):
    """[3 F]: the corner of the next face around the same vertex; -1: none.
    Corner 3 f + k is that of faces[f, k]."""
    starts = faces.ravel()
    ends = np.roll(faces, -1, 1).ravel()
    keys = starts * num_vertices + ends
    expect(len(np.unique(keys)) == len(keys),
           "two faces run an edge in the same direction")
    # Across the edge that ends in the corner: there it starts.
    before = np.roll(np.arange(len(keys)).reshape(-1, 3), 1, 1).ravel()
    order = np.argsort(keys)
    wanted = ends[before] * num_vertices + starts[before]
    places = np.minimum(np.searchsorted(keys[order], wanted), len(keys) - 1)
    return np.where(keys[order][places] == wanted, order[places], -1)


def _count_fans(faces, num_vertices):
    """[V]: into how many fans the faces around each vertex fall."""
    following = _next_corners(faces, num_vertices)
    corners = np.arange(len(following))
    ends = following < 0
    following = np.where(ends, corners, following)
    lowest = corners
    reaches = ends
    for _ in range(max(1, math.ceil(math.log2(len(corners)))) + 1):
        lowest = np.minimum(lowest, lowest[following])
        reaches = reaches | reaches[following]
        following = following[following]
    firsts = ends | (~reaches & (lowest == corners))
    return np.bincount(faces.ravel()[firsts], minlength=num_vertices)


def check_manifold(vertices, faces):
    """Throws a Fault unless it is a finite oriented 2-manifold."""
    count = len(vertices)
    expect(len(faces) > 0, "a mesh without faces")
    expect(faces.min() >= 0 and faces.max() < count, "a corner out of range")
    expect((faces != np.roll(faces, 1, 1)).all(), "a face with an edge of none")
    for name in vertices.dtype.names:
        expect(np.isfinite(vertices[name]).all(), f"{name} that is not finite")
    fans = _count_fans(faces, count)
    expect(fans.max() == 1, f"{(fans > 1).sum()} vertices of several fans")
    expect(fans.min() == 1, f"{(fans == 0).sum()} vertices without a face")
    if "confidence" in vertices.dtype.names:
        confidence = vertices["confidence"]
        expect(confidence.min() >= 0 and confidence.max() <= 1,
               "a confidence that is not of 0 ... 1")


def check_visibility(path, num_vertices):
    """Throws a Fault unless a .vis is whole, and has so many rows."""
    words = np.frombuffer(path.read_bytes()[8:], "<u4").tolist()
    count = struct.unpack("<Q", path.read_bytes()[:8])[0]
    expect(count == num_vertices, "a .vis of another number of vertices")
    at = 0
    for _ in range(count):
        expect(at < len(words), "a .vis cut off")
        at += 1 + words[at]
    expect(at == len(words), "a .vis of another length")


def _check_ply(path, is_manifold):
    vertices, faces = read_mesh(path)
    if is_manifold and "label" not in vertices.dtype.names:
        check_manifold(vertices, faces)
    visibility = path.with_name(path.name + ".vis")
    if is_manifold and visibility.is_file():
        check_visibility(visibility, len(vertices))


def _check_png(path):
    data = path.read_bytes()
    expect(data.startswith(b"\x89PNG\r\n\x1a\n"), "no PNG")
    at, pixels = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
        if kind == b"IDAT":
            pixels += body
        at += 12 + size
    channels = {0: 1, 2: 3, 6: 4}[color]
    expect(at == len(data) and kind == b"IEND" and depth == 8 and
           len(zlib.decompress(pixels)) == height * (1 + channels * width),
           "a PNG cut off")


def _refuse_constant(text):
    raise Fault(f"JSON with {text}")


def _check_json(path):
    json.loads(path.read_text("utf-8"), parse_constant=_refuse_constant)


def _check_region(path):
    numbers = [float(word) for line in path.read_text("utf-8").splitlines()
               for word in line.split("#")[0].split()]
    expect(len(numbers) == 15 and all(map(math.isfinite, numbers)), "no region")


def _check_page(path):
    expect(path.read_text("utf-8").rstrip().endswith("</html>"), "a page cut off")


def _check_table(path):
    rows = [row.split(",") for row in path.read_text("utf-8").splitlines()]
    expect(len({len(row) for row in rows}) <= 1, "a table of uneven rows")


def check_output(path, is_manifold, kind=None):
    """Checks a file that a command has written.

    is_manifold: whether meshes have to be. kind: ".ply"; None: as its name ends.
    Throws a Fault.
    """
    checks = {".ply": lambda p: _check_ply(p, is_manifold), ".png": _check_png,
              ".json": _check_json, ".html": _check_page, ".csv": _check_table}
    check = checks.get(kind or path.suffix)
    if path.name.endswith(".region.txt"):
        check = _check_region
    if check is None:
        return
    try:
        check(path)
    except Fault as fault:
        raise Fault(f"{path.name}: {fault}") from fault
    except Exception as error:
        raise Fault(f"{path.name}: damaged, {error!r}") from error
