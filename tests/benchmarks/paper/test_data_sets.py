"""Layouts of DTU and EPFL, masks, planes, truth."""

import importlib.util
import pathlib
import unittest

import numpy as np

import depth_maps
import dtu
import epfl
import small_scenes

HAS_SCIPY = importlib.util.find_spec("scipy") is not None


class Dtu(small_scenes.InFolder):
    def test_views_have_their_cameras(self):
        cameras = small_scenes.write_dtu(self.folder, 24)
        views = dtu.read_views(self.folder, 24)
        self.assertEqual(len(views), 8)
        for view, camera in zip(views, cameras):
            self.assertEqual(view.size, small_scenes.SIZE)
            np.testing.assert_allclose(view.camera.center(), camera.center(),
                                       atol=1e-9)
            np.testing.assert_allclose(
                view.camera.intrinsics[:2, 2],
                camera.intrinsics[:2, 2] + 0.5, atol=1e-9)
        shifted = dtu.read_views(self.folder, 24, pixel_center=1.0)[0]
        np.testing.assert_allclose(
            shifted.camera.intrinsics[:2, 2],
            cameras[0].intrinsics[:2, 2] - 0.5, atol=1e-9)

    def test_other_lights_and_scans_are_missing(self):
        small_scenes.write_dtu(self.folder, 24)
        with self.assertRaises(FileNotFoundError):
            dtu.read_views(self.folder, 24, light="max")
        with self.assertRaises(FileNotFoundError):
            dtu.read_views(self.folder, 4)

    def test_truth_has_three_digits(self):
        self.assertEqual(dtu.truth_path(pathlib.Path("."), 4).name,
                         "stl004_total.ply")


@unittest.skipUnless(HAS_SCIPY, "scipy.io, which reads .mat, is missing")
class DtuMasks(small_scenes.InFolder):
    def save(self, name, **variables):
        import scipy.io
        path = self.folder / name
        scipy.io.savemat(path, variables)
        return path

    def test_cells_are_those_of_the_evaluation_code(self):
        rng = np.random.default_rng(1)
        mask = rng.random((4, 5, 6)) < 0.5
        box = np.array([[-10.0, 3, 500], [22, 43, 548]])
        source = self.save("ObsMask4_10.mat", ObsMask=mask.astype(np.uint8),
                           BB=box, Res=np.array([[8.0]]), Margin=10.0)
        target = self.folder / "masks" / "mask.npy"
        *origin, resolution = dtu.convert_mask(source, target)
        stored = np.load(target)
        self.assertEqual(stored.dtype, np.uint8)
        self.assertEqual(stored.shape, (4, 5, 6))
        self.assertTrue(stored.flags["C_CONTIGUOUS"])
        np.testing.assert_array_equal(stored, mask)
        for point in rng.uniform([-14, -1, 496], [18, 38, 540], (200, 3)):
            theirs = tuple(np.round((point - box[0]) / 8).astype(int))
            ours = tuple(np.floor((point - origin) / resolution + 0.5)
                         .astype(int))
            self.assertEqual(ours, theirs)
            self.assertEqual(bool(stored[ours]), bool(mask[theirs]))

    def test_logical_and_double_masks(self):
        for kind in (bool, float):
            source = self.save("m.mat", ObsMask=np.eye(3)[..., None].astype(
                kind), BB=np.zeros((2, 3)), Res=1.0)
            dtu.convert_mask(source, self.folder / "m.npy")
            np.testing.assert_array_equal(np.load(self.folder / "m.npy"),
                                          np.eye(3)[..., None])

    def test_the_plane_is_a_column_or_a_row(self):
        for plane in ([[0.1], [0], [2], [-8]], [[0.1, 0, 2, -8]]):
            path = self.save("Plane4.mat", P=np.array(plane))
            self.assertEqual(dtu.read_plane(path), [0.1, 0, 2, -8])


class Epfl(small_scenes.InFolder):
    def scene(self):
        return self.folder / "fountain-P11"

    def test_finds_the_scene_and_its_views(self):
        cameras = small_scenes.write_epfl(self.scene())
        self.assertEqual(epfl.find_scene(self.folder, "fountain"),
                         self.scene())
        self.assertIsNone(epfl.find_scene(self.folder, "herzjesu"))
        views = epfl.read_views(self.scene())
        self.assertEqual([view.name for view in views],
                         ["0000.png", "0001.png", "0002.png"])
        for view, camera in zip(views, cameras):
            np.testing.assert_allclose(view.camera.projection(),
                                       camera.projection(), atol=1e-9)

    def test_an_image_of_another_size_is_refused(self):
        small_scenes.write_epfl(self.scene())
        small_scenes.write_png(self.scene() / "images" / "0001.png",
                               np.zeros((3, 4), np.uint8))
        with self.assertRaises(ValueError):
            epfl.read_views(self.scene())

    def test_depth_maps_are_converted_where_there_is_no_mesh(self):
        small_scenes.write_epfl(self.scene())
        views = epfl.read_views(self.scene())
        target = self.folder / "truth"
        with self.assertRaises(FileNotFoundError):
            epfl.find_truth(self.scene(), target, views, False)
        depths = np.full(small_scenes.SIZE[::-1], 3, np.float32)
        (self.scene() / "depth").mkdir()
        np.save(self.scene() / "depth" / "0001.npy", depths)
        self.assertEqual(epfl.find_truth(self.scene(), target, views, False),
                         target)
        self.assertEqual([path.name for path in target.iterdir()],
                         ["0001.png.bin"])
        np.testing.assert_array_equal(
            depth_maps.read_depths(target / "0001.png.bin"), depths)
        epfl.find_truth(self.scene(), target, views, True)
        self.assertTrue(
            (depth_maps.read_depths(target / "0001.png.bin") < 3).all())

    def test_the_scanned_mesh_comes_first(self):
        small_scenes.write_epfl(self.scene())
        mesh = self.scene() / "fountain_dense.ply"
        mesh.write_text("ply")
        self.assertEqual(epfl.find_truth(self.scene(), None, [], False), mesh)
        (self.scene() / "other.ply").write_text("ply")
        with self.assertRaises(ValueError):
            epfl.find_truth(self.scene(), None, [], False)


if __name__ == "__main__":
    unittest.main()
