"""Reading and writing of PLY and .vis."""

import pathlib
import sys
import tempfile
import types
import unittest
from unittest import mock

import colmap_ext
import sphere_workspace

try:
    import numpy as np
except ImportError:
    np = None
try:
    import open3d
except ImportError:
    open3d = None
try:
    import trimesh
except ImportError:
    trimesh = None


def colored_triangle():
    return colmap_ext.Ply(
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.5]], np.float32),
        np.array([[0, 1, 2]], np.int32),
        np.array([[1, 2, 3], [4, 5, 6], [7, 8, 255]], np.uint8),
        np.array([[0, 0, 1]] * 3, np.float32),
        {"confidence": np.array([0, 0.5, 1], np.float32)})


@unittest.skipIf(np is None, "no NumPy")
class FilesTest(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name) / "file"

    def test_a_mesh_is_read_as_written(self):
        ply = colored_triangle()
        ply.properties["label"] = np.array([-1, 2, 3], np.int32)
        colmap_ext.write_ply(self.path, ply)
        read = colmap_ext.read_ply(self.path)
        for name in ("vertices", "faces", "colors", "normals"):
            np.testing.assert_array_equal(getattr(read, name), getattr(ply, name))
        self.assertEqual(list(read.properties), ["confidence", "label"])
        np.testing.assert_array_equal(read.properties["label"], [-1, 2, 3])

    def test_points_are_written_without_faces(self):
        colmap_ext.write_ply(self.path, colmap_ext.Ply(np.eye(3)))
        self.assertNotIn(b"face", self.path.read_bytes())
        self.assertEqual(colmap_ext.read_ply(self.path).faces.shape, (0, 3))

    def test_text_and_big_endian_are_read(self):
        header = ("ply\nformat {} 1.0\ncomment x\nelement vertex 3\nproperty double x\n"
                  "property float y\nproperty short z\nelement face 1\n"
                  "property list uchar uint vertex_indices\nproperty uchar red\n"
                  "element other 1\nproperty int a\nend_header\n")
        rows = np.array([(0, 1, 2), (3, 4, 5), (6, 7, 8)],
                        [("x", ">f8"), ("y", ">f4"), ("z", ">i2")])
        face = np.array([(3, (2, 1, 0), 9)],
                        [("n", "u1"), ("v", ">u4", (3,)), ("red", "u1")])
        for text in (
                header.format("ascii").encode() + b"0 1 2\n3 4 5\n6 7 8\n3 2 1 0 9\n7\n",
                header.format("binary_big_endian").encode() + rows.tobytes()
                + face.tobytes() + b"\0\0\0\7"):
            self.path.write_bytes(text)
            ply = colmap_ext.read_ply(self.path)
            np.testing.assert_array_equal(ply.vertices, [[0, 1, 2], [3, 4, 5], [6, 7, 8]])
            np.testing.assert_array_equal(ply.faces, [[2, 1, 0]])

    def test_damaged_meshes_are_refused(self):
        ply = colmap_ext.Ply(np.zeros((3, 3)), np.array([[0, 1, 2]]))
        colmap_ext.write_ply(self.path, ply)
        data = self.path.read_bytes()
        for size in range(len(data)):
            self.path.write_bytes(data[:size])
            with self.subTest(size), self.assertRaises(ValueError):
                colmap_ext.read_ply(self.path)
        colmap_ext.write_ply(self.path, colmap_ext.Ply(np.zeros((3, 3)), [[0, 1, 3]]))
        with self.assertRaises(ValueError):
            colmap_ext.read_ply(self.path)
        with self.assertRaises(ValueError):
            colmap_ext.write_ply(self.path, colmap_ext.Ply(np.zeros((3, 3)),
                                                           properties={"a": np.zeros(2)}))

    def test_visibility_is_read_as_written(self):
        rows = [[0, 5, 2], [], [7], [1, 1]]
        colmap_ext.write_vis(self.path, rows)
        visibility = colmap_ext.read_vis(self.path)
        self.assertEqual([list(row) for row in visibility], rows)
        self.assertEqual(list(visibility[-1]), [1, 1])
        data = self.path.read_bytes()
        colmap_ext.write_vis(self.path, visibility)
        self.assertEqual(self.path.read_bytes(), data)
        for damaged in [data[:size] for size in range(len(data))] + [data + bytes(4)]:
            self.path.write_bytes(damaged)
            with self.subTest(len(damaged)), self.assertRaises(ValueError):
                colmap_ext.read_vis(self.path)

    def test_files_of_a_workspace_are_read(self):
        workspace = self.path
        num_points = sphere_workspace.write(workspace)
        ply = colmap_ext.read_ply(workspace / "fused.ply")
        self.assertEqual(ply.vertices.shape, (num_points, 3))
        np.testing.assert_allclose(np.linalg.norm(ply.vertices, axis=1), 1, atol=0.011)
        self.assertEqual(ply.faces.shape, (0, 3))
        self.assertEqual(len(colmap_ext.read_vis(workspace / "fused.ply.vis")), num_points)


@unittest.skipIf(np is None, "no NumPy")
class OtherLibrariesTest(unittest.TestCase):

    def test_trimesh_is_given_the_arrays(self):
        ply = colored_triangle()
        module = types.SimpleNamespace(
            Trimesh=lambda vertices, faces, **others: (vertices, faces, others))
        with mock.patch.dict(sys.modules, {"trimesh": module}):
            vertices, faces, others = ply.to_trimesh()
        self.assertIs(vertices, ply.vertices)
        self.assertIs(faces, ply.faces)
        self.assertEqual(others, {
            "vertex_normals": ply.normals, "vertex_colors": ply.colors,
            "vertex_attributes": ply.properties, "process": False})

    @unittest.skipIf(trimesh is None, "no trimesh")
    def test_trimesh_keeps_them(self):
        ply = colored_triangle()
        mesh = ply.to_trimesh()
        np.testing.assert_array_equal(mesh.vertices, ply.vertices)
        np.testing.assert_array_equal(mesh.faces, ply.faces)
        np.testing.assert_array_equal(mesh.vertex_normals, ply.normals)
        np.testing.assert_array_equal(mesh.visual.vertex_colors[:, :3], ply.colors)
        np.testing.assert_array_equal(mesh.vertex_attributes["confidence"], [0, 0.5, 1])

    def check_open3d(self):
        ply = colored_triangle()
        mesh = ply.to_open3d()
        np.testing.assert_array_equal(mesh.vertices, ply.vertices)
        np.testing.assert_array_equal(mesh.triangles, ply.faces)
        np.testing.assert_array_equal(mesh.vertex_normals, ply.normals)
        np.testing.assert_array_equal(mesh.vertex_colors, ply.colors / 255)
        ply.colors = ply.normals = None
        self.assertEqual(len(ply.to_open3d().vertex_colors), 0)

    def test_open3d_is_given_the_arrays(self):
        module = types.SimpleNamespace(
            utility=types.SimpleNamespace(Vector3dVector=np.asarray,
                                          Vector3iVector=np.asarray),
            geometry=types.SimpleNamespace(
                TriangleMesh=lambda vertices, triangles: types.SimpleNamespace(
                    vertices=vertices, triangles=triangles, vertex_colors=())))
        with mock.patch.dict(sys.modules, {"open3d": module}):
            self.check_open3d()

    @unittest.skipIf(open3d is None, "no open3d")
    def test_open3d_keeps_them(self):
        self.check_open3d()

    def test_they_are_not_required(self):
        with mock.patch.dict(sys.modules, {"trimesh": None, "open3d": None}):
            for convert in (colored_triangle().to_trimesh, colored_triangle().to_open3d):
                with self.assertRaises(ImportError):
                    convert()


if __name__ == "__main__":
    unittest.main()
