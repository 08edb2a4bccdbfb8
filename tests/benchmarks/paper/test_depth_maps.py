"""Depth maps in and out."""

import unittest

import numpy as np

import depth_maps
import small_scenes
from cameras import Camera


class DepthMaps(small_scenes.InFolder):
    def setUp(self):
        super().setUp()
        self.depths = np.random.default_rng(1).uniform(
            1, 9, (5, 7)).astype(np.float32)

    def write_pfm(self, name, kind, scale):
        path = self.folder / name
        path.write_bytes(f"Pf\n7 5\n{scale}\n".encode()
                         + self.depths[::-1].astype(kind).tobytes())
        return path

    def test_colmap_round_trip(self):
        path = self.folder / "maps" / "0000.jpg.bin"
        depth_maps.write_colmap_map(path, self.depths)
        self.assertEqual(path.read_bytes()[:6], b"7&5&1&")
        self.assertEqual(path.stat().st_size, 6 + 4 * 35)
        np.testing.assert_array_equal(
            depth_maps.read_colmap_map(path), self.depths)

    def test_all_forms_are_read_alike(self):
        np.save(self.folder / "c.npy", self.depths)
        depth_maps.write_colmap_map(self.folder / "d.bin", self.depths)
        for path in (self.write_pfm("a.pfm", "<f4", "-1.0"),
                     self.write_pfm("b.pfm", ">f4", "1.0"),
                     self.folder / "c.npy", self.folder / "d.bin"):
            np.testing.assert_array_equal(
                depth_maps.read_depths(path), self.depths)

    def test_what_is_no_depth_becomes_zero(self):
        self.depths[0, :4] = [np.nan, np.inf, -1, 0]
        np.save(self.folder / "a.npy", self.depths)
        depths = depth_maps.read_depths(self.folder / "a.npy")
        np.testing.assert_array_equal(depths[0, :4], 0)
        np.testing.assert_array_equal(depths[1:], self.depths[1:])

    def test_distances_along_rays_become_depths(self):
        camera = Camera(np.array([[5.0, 0, 3.2], [0, 6, 2.1], [0, 0, 1]]),
                        np.eye(3), np.zeros(3))
        distances = np.empty((5, 7))
        for y in range(5):
            for x in range(7):
                ray = np.array([(x + 0.5 - 3.2) / 5, (y + 0.5 - 2.1) / 6, 1])
                distances[y, x] = np.linalg.norm(self.depths[y, x] * ray)
        np.testing.assert_allclose(
            depth_maps.ray_to_z(distances, camera), self.depths, rtol=1e-12)

    def test_depths_of_a_plane(self):
        camera = small_scenes.cameras_above_plane()[0]
        height, width = small_scenes.SIZE[::-1]
        y, x = np.mgrid[:height, :width] + 0.5
        rays = (np.stack([x, y, np.ones_like(x)], -1)
                @ np.linalg.inv(camera.intrinsics).T)
        z = -camera.center()[2] / (rays @ camera.rotation)[..., 2]
        distances = z * np.linalg.norm(rays, axis=-1)
        np.testing.assert_allclose(
            depth_maps.ray_to_z(distances, camera), z, rtol=1e-12)

    def test_refuses_other_files(self):
        for name, data in (("a.pfm", b"PF\n7 5\n-1\n"), ("b.bin", b"7x5"),
                           ("c.tif", b"")):
            (self.folder / name).write_bytes(data)
            with self.assertRaises(ValueError):
                depth_maps.read_depths(self.folder / name)


if __name__ == "__main__":
    unittest.main()
