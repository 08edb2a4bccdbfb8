"""Points of PLY files: DTU's scans in, what is left of them out."""

import re

import numpy as np

SCALARS = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}
BYTE_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}


def read_ply_points(path):
    """Positions [n, 3] of the vertices, which have to come first."""
    data = path.read_bytes()
    end = re.search(rb"end_header\r?\n", data)
    if not data.startswith(b"ply") or not end:
        raise ValueError(f"{path} is no PLY.")
    lines = data[:end.start()].decode().splitlines()
    form = lines[1].split()[1]
    count, names, kinds = _vertex_layout(lines, path)
    if form == "ascii":
        rows = data[end.end():].split(maxsplit=count * len(names))
        table = np.array(rows[:count * len(names)], dtype=float)
        table = table.reshape(count, len(names))
        return table[:, [names.index(axis) for axis in "xyz"]]
    order = BYTE_ORDERS[form]
    layout = np.dtype([(n, order + k) for n, k in zip(names, kinds)])
    table = np.frombuffer(data, layout, count=count, offset=end.end())
    return np.column_stack([table[axis].astype(float) for axis in "xyz"])


def _vertex_layout(lines, path):
    """Number of vertices, names and numpy kinds of their properties."""
    elements = [i for i, line in enumerate(lines)
                if line.startswith("element")]
    first = lines[elements[0]].split() if elements else []
    if first[:2] != ["element", "vertex"]:
        raise ValueError(f"{path}: the vertices have to come first.")
    last = elements[1] if len(elements) > 1 else len(lines)
    words = [line.split() for line in lines[elements[0] + 1:last]
             if line.startswith("property")]
    if any(word[1] == "list" for word in words):
        raise ValueError(f"{path}: vertices with lists.")
    return (int(first[2]), [word[2] for word in words],
            [SCALARS[word[1]] for word in words])


def write_ply_points(path, points):
    """Writes positions [n, 3] as doubles."""
    header = "\n".join([
        "ply", "format binary_little_endian 1.0",
        f"element vertex {len(points)}",
        *(f"property double {axis}" for axis in "xyz"), "end_header", ""])
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "wb") as file:
        file.write(header.encode())
        file.write(np.ascontiguousarray(points, dtype="<f8").tobytes())
