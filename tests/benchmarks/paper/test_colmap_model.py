"""Workspaces as they are written, without COLMAP."""

import pathlib
import sqlite3
import struct
import tempfile
import unittest

import numpy as np

import colmap_model
import dtu
import image_size
import small_scenes


class Workspace(small_scenes.InFolder):
    def views(self):
        self.cameras = small_scenes.write_dtu(self.folder / "dtu", 4)
        return dtu.read_views(self.folder / "dtu", 4)

    def test_has_known_cameras_links_and_lists(self):
        views = self.views()
        workspace = self.folder / "work"
        colmap_model.write_workspace(workspace, views)
        colmap_model.write_workspace(workspace, views)  # again, no complaint
        names = [f"rect_{i:03d}_3_r5000.png" for i in range(1, 9)]
        lines = (workspace / "sparse/images.txt").read_text().split("\n")[::2]
        self.assertEqual([line.split()[9] for line in lines if line], names)
        self.assertEqual([line.split()[0] for line in lines if line],
                         [str(i) for i in range(1, 9)])
        self.assertEqual((workspace / "sparse/points3D.txt").read_text(), "")
        self.assertEqual(
            (workspace / "stereo/fusion.cfg").read_text().split(), names)
        for name in names:
            link = workspace / "images" / name
            self.assertTrue(link.is_symlink())
            self.assertEqual(image_size.read_image_size(link),
                             small_scenes.SIZE)

    def test_text_keeps_every_digit(self):
        views = self.views()
        colmap_model.write_model(self.folder / "sparse", views)
        text = (self.folder / "sparse/images.txt").read_text().split("\n")[0]
        pose = [float(x) for x in text.split()[1:8]]
        np.testing.assert_array_equal(pose[4:], views[0].camera.translation)

    def test_equal_intrinsics_share_a_camera(self):
        views = self.views()
        for view in views:
            view.camera.intrinsics = self.cameras[0].intrinsics
        views[3].camera.intrinsics = views[3].camera.intrinsics + np.diag(
            [1, 0, 0])
        ids, distinct = colmap_model.distinct_cameras(views)
        self.assertEqual(ids, [1, 1, 1, 2, 1, 1, 1, 1])
        self.assertEqual(sorted(distinct), [1, 2])

    def test_database_takes_known_intrinsics(self):
        views = self.views()
        database = self.folder / "database.db"
        connection = sqlite3.connect(database)
        connection.execute(
            "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY, model"
            " INTEGER, width INTEGER, height INTEGER, params BLOB,"
            " prior_focal_length INTEGER)")
        connection.execute(
            "CREATE TABLE images (image_id INTEGER PRIMARY KEY, name TEXT,"
            " camera_id INTEGER)")
        for i, view in enumerate(views):
            connection.execute("INSERT INTO cameras VALUES (?,2,1,1,?,0)",
                               (20 - i, b""))
            connection.execute("INSERT INTO images VALUES (?,?,?)",
                               (i, view.name, 20 - i))
        connection.commit()
        colmap_model.set_database_cameras(database, views)
        model, width, height, params, prior = connection.execute(
            "SELECT model, width, height, params, prior_focal_length FROM"
            " cameras WHERE camera_id = 18").fetchone()
        self.assertEqual((model, width, height, prior), (1, 320, 240, 1))
        intrinsics = views[2].camera.intrinsics
        np.testing.assert_array_equal(
            struct.unpack("<4d", params),
            [*np.diag(intrinsics)[:2], *intrinsics[:2, 2]])
        connection.execute("DELETE FROM images WHERE image_id = 0")
        connection.commit()
        with self.assertRaises(ValueError):
            colmap_model.set_database_cameras(database, views)
        connection.close()


class ImageSizes(unittest.TestCase):
    def test_headers(self):
        jpeg = (b"\xff\xd8\xff\xe0" + struct.pack(">H", 16) + bytes(14)
                + b"\xff\xc4" + struct.pack(">H", 4) + bytes(2)
                + b"\xff\xc2" + struct.pack(">HBHH", 17, 8, 2048, 3072))
        ppm = b"P6\n# by hand\n640 480\n255\n" + bytes(20)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "image"
            for data, size in ((jpeg, (3072, 2048)), (ppm, (640, 480))):
                path.write_bytes(data)
                self.assertEqual(image_size.read_image_size(path), size)
            for data in (b"", b"GIF89a", jpeg[:25]):
                path.write_bytes(data)
                with self.assertRaises(ValueError):
                    image_size.read_image_size(path)


if __name__ == "__main__":
    unittest.main()
