"""PLY files of points and triangle meshes as NumPy arrays."""

import importlib
import os
from dataclasses import dataclass, field
from typing import IO, TYPE_CHECKING, Any, Optional

from .base_options import StrPath

if TYPE_CHECKING:
    from numpy.typing import NDArray

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}
_NAMES = {"i1": "char", "u1": "uchar", "i2": "short", "u2": "ushort", "i4": "int",
          "u4": "uint", "f4": "float", "f8": "double"}

# (name, type, type of the count or None) of each property of an element.
_Properties = list[tuple[str, str, Optional[str]]]


def _no_faces() -> "NDArray[Any]":
    import numpy as np  # pylint: disable=import-outside-toplevel

    return np.zeros((0, 3), np.int32)


@dataclass
class Ply:
    """Points, or a triangle mesh.

    vertices: [V, 3] float32, scene units.
    faces: [F, 3] int32, indices of vertices; [0, 3] for points.
    colors: [V, 3] uint8, red green blue; or None.
    normals: [V, 3] float32; or None.
    properties: other scalars of the vertices by name, [V]: "confidence", "label".
    """

    vertices: "NDArray[Any]"
    faces: "NDArray[Any]" = field(default_factory=_no_faces)
    colors: "Optional[NDArray[Any]]" = None
    normals: "Optional[NDArray[Any]]" = None
    properties: "dict[str, NDArray[Any]]" = field(default_factory=dict)

    def to_trimesh(self) -> Any:
        """A trimesh.Trimesh with the same vertices in the same order; properties are
        its vertex_attributes. Raises ImportError without trimesh."""
        return importlib.import_module("trimesh").Trimesh(
            self.vertices, self.faces, vertex_normals=self.normals,
            vertex_colors=self.colors, vertex_attributes=dict(self.properties),
            process=False)

    def to_open3d(self) -> Any:
        """An open3d.geometry.TriangleMesh, without the properties; colors are 0 ... 1.
        Raises ImportError without open3d."""
        open3d = importlib.import_module("open3d")
        vectors = open3d.utility.Vector3dVector
        mesh = open3d.geometry.TriangleMesh(
            vectors(self.vertices), open3d.utility.Vector3iVector(self.faces))
        if self.colors is not None:
            mesh.vertex_colors = vectors(self.colors / 255)
        if self.normals is not None:
            mesh.vertex_normals = vectors(self.normals)
        return mesh


def _read_header(file: IO[bytes], path: str
                 ) -> tuple[str, list[tuple[str, int, _Properties]]]:
    """(byte order, or "" for text; [(element, count, properties)])"""
    if file.readline().strip() != b"ply":
        raise ValueError(f"{path}: not a PLY file")
    order = None
    elements: list[tuple[str, int, _Properties]] = []
    while True:
        line = file.readline()
        words = line.decode("latin-1").split()
        if not line or (words and words[0] not in (
                "format", "comment", "obj_info", "element", "property", "end_header")):
            raise ValueError(f"{path}: not a PLY header")
        if not words:
            continue
        if words[0] == "end_header":
            break
        try:
            if words[0] == "format":
                order = {"ascii": "", "binary_little_endian": "<",
                         "binary_big_endian": ">"}[words[1]]
            elif words[0] == "element":
                elements.append((words[1], int(words[2]), []))
            elif words[0] == "property" and words[1] == "list":
                elements[-1][2].append((words[4], _TYPES[words[3]], _TYPES[words[2]]))
            elif words[0] == "property":
                elements[-1][2].append((words[2], _TYPES[words[1]], None))
        except (IndexError, KeyError, ValueError) as error:
            raise ValueError(f"{path}: not a PLY header: {' '.join(words)}") from error
    if order is None:
        raise ValueError(f"{path}: no format")
    return order, elements


def _record(properties: _Properties, order: str) -> list[tuple[Any, ...]]:
    """One element as a NumPy type; lists are triples."""
    fields: list[tuple[Any, ...]] = []
    for name, kind, count in properties:
        if count is not None:
            fields.append((f"{name} count", order + count))
        fields.append((name, order + kind, (3,)) if count else (name, order + kind))
    return fields


def _read_elements(file: IO[bytes], path: str, order: str, count: int,
                   properties: _Properties) -> "NDArray[Any]":
    import numpy as np  # pylint: disable=import-outside-toplevel

    if order == "":
        names = [f[0] for f in _record(properties, "=")]
        record = np.dtype(_record(properties, "="))
        rows = np.zeros(count, record)
        for i in range(count):
            words = iter(file.readline().split())
            try:
                rows[i] = tuple(
                    [float(next(words)) for _ in range(3)]
                    if record[name].shape else float(next(words)) for name in names)
            except (StopIteration, ValueError) as error:
                raise ValueError(f"{path}: truncated or damaged") from error
    else:
        record = np.dtype(_record(properties, order))
        data = file.read(count * record.itemsize)
        if len(data) < count * record.itemsize:
            raise ValueError(f"{path}: truncated, or with faces of other than "
                             "three corners")
        rows = np.frombuffer(data, record)
    for name, _, kind in properties:
        if kind is not None and not (rows[f"{name} count"] == 3).all():
            raise ValueError(f"{path}: faces of other than three corners")
    return rows


def read_ply(path: StrPath) -> Ply:
    """Reads a PLY file, text or binary, as a Ply.

    Elements other than vertex and face, and properties of faces, are left out.
    Raises ValueError if it is damaged or has faces of other than three corners,
    OSError if it cannot be read.
    """
    import numpy as np  # pylint: disable=import-outside-toplevel

    path = os.fspath(path)
    ply = None
    faces = _no_faces()
    with open(path, "rb") as file:
        order, elements = _read_header(file, path)
        for element, count, properties in elements:
            if element not in ("vertex", "face"):
                break  # They come first.
            rows = _read_elements(file, path, order, count, properties)
            if element == "vertex":
                ply = _make_points(rows, path)
            for name in ("vertex_index", "vertex_indices"):
                if element == "face" and name in (rows.dtype.names or ()):
                    faces = rows[name].astype(np.int32)
    if ply is None:
        raise ValueError(f"{path}: no vertices")
    if faces.size and (faces.min() < 0 or faces.max() >= len(ply.vertices)):
        raise ValueError(f"{path}: a face has a vertex that is not there")
    ply.faces = faces
    return ply


def _make_points(rows: "NDArray[Any]", path: str) -> Ply:
    import numpy as np  # pylint: disable=import-outside-toplevel

    columns = {name: rows[name] for name in rows.dtype.names or ()}

    def take(names: tuple[str, ...], kind: type) -> "Optional[NDArray[Any]]":
        if not all(name in columns for name in names):
            return None
        taken: "NDArray[Any]" = np.stack([columns.pop(name) for name in names], 1)
        return taken.astype(kind)

    vertices = take(("x", "y", "z"), np.float32)
    if vertices is None:
        raise ValueError(f"{path}: vertices without x, y, z")
    colors = take(("red", "green", "blue"), np.uint8)
    normals = take(("nx", "ny", "nz"), np.float32)
    return Ply(vertices, _no_faces(), colors, normals,
               {name: np.array(column) for name, column in columns.items()})


def write_ply(path: StrPath, ply: Ply) -> None:
    """Writes a Ply, binary little-endian, as COLMAP and most tools read it.

    Raises ValueError if its arrays do not fit together.
    """
    import numpy as np  # pylint: disable=import-outside-toplevel

    vertices = np.asarray(ply.vertices, np.float32).reshape(-1, 3)
    faces = np.asarray(ply.faces, np.int32).reshape(-1, 3)
    columns = dict(zip("xyz", vertices.T))
    for names, array, kind in ((("nx", "ny", "nz"), ply.normals, np.float32),
                               (("red", "green", "blue"), ply.colors, np.uint8)):
        if array is not None:
            columns.update(zip(names, np.asarray(array, kind).reshape(-1, 3).T))
    columns.update((name, np.asarray(column)) for name, column in ply.properties.items())
    if any(column.shape != (len(vertices),) for column in columns.values()):
        raise ValueError("normals, colors and properties are one for each vertex")
    kinds = {name: column.dtype.str[1:] for name, column in columns.items()}
    unknown = [name for name, kind in kinds.items() if kind not in _NAMES]
    if unknown:
        raise ValueError(f"{unknown[0]}: PLY has no type {columns[unknown[0]].dtype}")
    rows = np.zeros(len(vertices), [(name, "<" + kind) for name, kind in kinds.items()])
    for name, column in columns.items():
        rows[name] = column
    corners = np.zeros(len(faces), [("count", "u1"), ("corners", "<i4", (3,))])
    corners["count"] = 3
    corners["corners"] = faces
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}"]
    header += [f"property {_NAMES[kind]} {name}" for name, kind in kinds.items()]
    if len(faces):
        header += [f"element face {len(faces)}", "property list uchar int vertex_index"]
    with open(path, "wb") as file:
        file.write(("\n".join([*header, "end_header", ""])).encode("latin-1"))
        file.write(rows.tobytes() + corners.tobytes())
