"""Cameras of DTU and EPFL."""

import pathlib
import tempfile
import unittest

import numpy as np

import cameras
import small_scenes


def assert_same(camera, expected, tolerance=1e-12):
    for name in ("intrinsics", "rotation", "translation"):
        wanted = getattr(expected, name)
        np.testing.assert_allclose(
            getattr(camera, name), wanted, rtol=0,
            atol=tolerance * np.abs(wanted).max())


class Decomposition(unittest.TestCase):
    def test_round_trip_up_to_any_factor(self):
        rng = np.random.default_rng(1)
        for _ in range(300):
            camera = small_scenes.random_camera(rng)
            for factor in (1.0, -1.0, 3e-4, -2e5):
                found = cameras.decompose_projection(
                    factor * camera.projection())
                assert_same(found, camera)
                self.assertAlmostEqual(np.linalg.det(found.rotation), 1, 12)
                self.assertTrue((np.diag(found.intrinsics) > 0).all())

    def test_points_in_front_have_positive_depth(self):
        camera = small_scenes.random_camera(np.random.default_rng(2))
        found = cameras.decompose_projection(-camera.projection())
        point = camera.center() + 7 * camera.rotation[2]
        self.assertAlmostEqual(
            (found.rotation @ point + found.translation)[2], 7, 9)

    def test_a_skew_is_kept_and_refused_when_it_shows(self):
        camera = small_scenes.random_camera(np.random.default_rng(3))
        camera.intrinsics[0, 1] = 3.0
        found = cameras.decompose_projection(camera.projection())
        assert_same(found, camera)
        found.intrinsics[1, 1] = 1000
        with self.assertRaises(ValueError):
            cameras.pinhole_parameters(found, (1600, 1200))
        found.intrinsics[0, 1] = 0.01
        self.assertEqual(
            len(cameras.pinhole_parameters(found, (1600, 1200))), 4)

    def test_refuses_what_is_no_projection(self):
        for matrix in (np.zeros((3, 4)), np.ones((3, 4)), np.eye(4),
                       np.full((3, 4), np.nan)):
            with self.assertRaises(ValueError):
                cameras.decompose_projection(matrix)


class Quaternions(unittest.TestCase):
    def test_rotate_as_the_matrix(self):
        rng = np.random.default_rng(4)
        angles = [0, 1e-9, np.pi, np.pi - 1e-9, *rng.uniform(-3, 3, 200)]
        axes = [*np.eye(3), *rng.normal(size=(20, 3))]
        for angle in angles:
            for axis in axes:
                rotation = small_scenes.rotation_about(axis, angle)
                w, *v = cameras.quaternion(rotation)
                self.assertGreaterEqual(w, 0)
                self.assertAlmostEqual(w * w + np.dot(v, v), 1, 12)
                cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]],
                                  [-v[1], v[0], 0]])
                np.testing.assert_allclose(
                    np.eye(3) + 2 * w * cross + 2 * cross @ cross, rotation,
                    rtol=0, atol=1e-12)


class Strecha(unittest.TestCase):
    def read(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "0000.jpg.camera"
            path.write_text(text)
            return cameras.read_strecha_camera(path)

    def test_reads_rotation_transposed_and_centre(self):
        rng = np.random.default_rng(5)
        for _ in range(100):
            camera = small_scenes.random_camera(rng)
            found, size = self.read(
                small_scenes.strecha_text(camera, (3072, 2048)))
            assert_same(found, camera)
            self.assertEqual(size, (3072, 2048))

    def test_projects_by_the_formula_of_the_format(self):
        camera = small_scenes.random_camera(np.random.default_rng(6))
        text = small_scenes.strecha_text(camera, (3072, 2048))
        k, r, c = np.split(np.array(text.split(), float)[:24], [9, 21])
        k, r = k.reshape(3, 3), r[3:].reshape(3, 3)
        projection = k @ np.column_stack([r.T, -r.T @ c])
        np.testing.assert_allclose(
            self.read(text)[0].projection(), projection, rtol=0,
            atol=1e-12 * np.abs(projection).max())

    def test_rounded_rotations_become_rotations(self):
        camera = small_scenes.random_camera(np.random.default_rng(7))
        rounded = np.round(camera.rotation, 5)
        found = cameras.nearest_rotation(rounded)
        np.testing.assert_allclose(found @ found.T, np.eye(3), atol=1e-14)
        np.testing.assert_allclose(found, camera.rotation, atol=2e-5)
        with self.assertRaises(ValueError):
            cameras.nearest_rotation(-camera.rotation)

    def test_refuses_distortion_and_short_files(self):
        camera = small_scenes.random_camera(np.random.default_rng(8))
        text = small_scenes.strecha_text(camera, (3072, 2048))
        for wrong in (text.replace("0 0 0\n", "0.1 0 0\n"), text[:-10], ""):
            with self.assertRaises(ValueError):
                self.read(wrong)


class PixelCenters(unittest.TestCase):
    def test_the_first_pixel_is_at_a_half_in_colmap(self):
        camera = small_scenes.random_camera(np.random.default_rng(9))
        for center in (0.0, 0.5, 1.0):
            ray = np.linalg.inv(camera.intrinsics) @ [center, center, 1]
            x = camera.with_pixel_center(center).intrinsics @ ray
            np.testing.assert_allclose(x[:2] / x[2], 0.5, atol=1e-9)

    def test_stated_defaults(self):
        self.assertEqual(cameras.DTU_PIXEL_CENTER, 0.0)
        self.assertEqual(cameras.EPFL_PIXEL_CENTER, 0.5)


if __name__ == "__main__":
    unittest.main()
