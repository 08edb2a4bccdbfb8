"""What is written, read back by COLMAP itself."""

import re
import struct
import subprocess
import unittest

import numpy as np

import colmap_model
import dense
import dtu
import meshes
import settings
import small_scenes
from cameras import quaternion
from colmap_tool import Colmap, CommandFailed

PROGRAM = small_scenes.colmap_program()


def read_binary_poses(path):
    """{name: (w, x, y, z, tx, ty, tz)} of COLMAP's images.bin."""
    data, at, poses = path.read_bytes(), 8, {}
    for _ in range(struct.unpack_from("<Q", data)[0]):
        pose = struct.unpack_from("<7d", data, at + 4)
        end = data.index(b"\0", at + 64)
        poses[data[at + 64:end].decode()] = pose
        at = end + 9 + 24 * struct.unpack_from("<Q", data, end + 1)[0]
    return poses


@unittest.skipUnless(PROGRAM, "colmap is not built")
class ReadByColmap(small_scenes.InFolder):
    def setUp(self):
        super().setUp()
        self.workspace = self.folder / "work"
        self.colmap = Colmap(PROGRAM)
        small_scenes.write_dtu(self.folder / "dtu", 4)

    def views(self, **options):
        return dtu.read_views(self.folder / "dtu", 4, **options)

    def call(self, command, **options):
        line = [PROGRAM, command]
        for name, value in options.items():
            line += [f"--{name}", str(value)]
        return subprocess.run(line, capture_output=True, text=True,
                              check=True).stdout

    def test_commands_are_found(self):
        self.assertIn("model_converter", self.colmap.commands)
        self.assertIn(settings.MESHER, self.colmap.commands)
        for option in (*settings.PAPER_MESHING, *settings.NO_FIXING):
            self.assertTrue(self.colmap.has_option(settings.MESHER, option),
                            option)
        self.assertFalse(self.colmap.has_option(settings.MESHER, "no_such"))
        for option in ("workspace_path", "input_path", "output_path",
                       *settings.WHOLE_MESH):
            self.assertTrue(self.colmap.has_option(settings.REFINER, option),
                            option)

    def test_model_is_the_same_after_conversion(self):
        views = self.views()
        colmap_model.write_workspace(self.workspace, views)
        binary = self.folder / "binary"
        binary.mkdir()
        self.call("model_converter", input_path=self.workspace / "sparse",
                  output_path=binary, output_type="BIN")
        poses = read_binary_poses(binary / "images.bin")
        self.assertEqual(sorted(poses), [view.name for view in views])
        for view in views:
            np.testing.assert_allclose(
                poses[view.name], [*quaternion(view.camera.rotation),
                                   *view.camera.translation], atol=1e-12)

    def test_model_is_analyzed(self):
        colmap_model.write_workspace(self.workspace, self.views())
        report = self.call("model_analyzer", path=self.workspace / "sparse")
        self.assertRegex(report, r"Registered images: 8\b")
        self.assertRegex(report, r"Points: 0\b")

    def triangulated(self, pixel_center):
        """Mean reprojection error, px, and heights of the points over the
        plane that the images show."""
        views = self.views(pixel_center=pixel_center)
        workspace = self.folder / f"work{pixel_center}"
        colmap_model.write_workspace(workspace, views)
        dense.triangulate(self.colmap, workspace, views)
        report = self.call("model_analyzer", path=workspace / "sparse")
        text = self.folder / f"text{pixel_center}"
        text.mkdir()
        self.call("model_converter", input_path=workspace / "sparse",
                  output_path=text, output_type="TXT")
        points = np.array([line.split()[1:4] for line in
                           (text / "points3D.txt").read_text().splitlines()
                           if not line.startswith("#")], dtype=float)
        return (float(re.search(r"reprojection error: ([\d.]+)px",
                                report).group(1)), points[:, 2])

    def test_features_agree_with_the_stated_pixel_centre_only(self):
        small_scenes.write_dtu(
            self.folder / "dtu", 4,
            lambda camera: small_scenes.render_plane(camera, 0.0))
        error, heights = self.triangulated(0.0)
        self.assertGreater(len(heights), 50)
        self.assertLess(error, 0.3)
        self.assertLess(np.median(np.abs(heights)), 2e-3)
        for wrong in (0.5, 1.0):
            self.assertGreater(self.triangulated(wrong)[0], 1.4 * error)

    def test_the_mesher_reports_what_table_2_takes(self):
        views = self.views()
        colmap_model.write_workspace(self.workspace, views)
        rng = np.random.default_rng(1)
        points = rng.uniform(-0.4, 0.4, (600, 3)) * [1, 1, 0.02]
        small_scenes.write_fused(self.folder / "fused", len(views), points)
        dense.take_fused(self.workspace, self.folder / "fused")
        self.assertTrue(dense.is_fused(self.workspace))
        dense.make_dense(self.colmap, self.workspace, views)  # nothing to do
        for setting in settings.MESHING:
            mesh, report = meshes.make_mesh(self.colmap, self.workspace,
                                            setting, "initial")
            self.assertTrue(mesh.exists())
            before, after = meshes.singular_vertices(report)
            self.assertLessEqual(after, before)
            again = meshes.make_mesh(self.colmap, self.workspace, setting,
                                     "initial")
            self.assertEqual(meshes.singular_vertices(again[1]),
                             (before, after))

    def test_failures_leave_a_log(self):
        log = self.folder / "logs" / "log.txt"
        with self.assertRaises(CommandFailed):
            self.colmap.run(settings.MESHER, {
                "input_path": self.folder / "nothing",
                "output_path": self.folder / "mesh.ply"}, log)
        self.assertIn(settings.MESHER, log.read_text())

    def test_without_cuda_no_points_are_made_up(self):
        if self.colmap.has_cuda:
            self.skipTest("this COLMAP has CUDA")
        with self.assertRaises(FileNotFoundError):
            dense.make_dense(self.colmap, self.workspace, [])


if __name__ == "__main__":
    unittest.main()
