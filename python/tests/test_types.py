"""The type hints, by mypy."""

import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest

import colmap_ext

PACKAGE = pathlib.Path(colmap_ext.__file__).parent
WRONG = """
import colmap_ext
options = colmap_ext.FacetwiseRefinementOptions(levels="2")
options.levles = 2
options.solver = "newton"
colmap_ext.facetwise_refinement("a", "b")
"""
RIGHT = """
import pathlib
import colmap_ext
options = colmap_ext.FacetwiseRefinementOptions(levels=2, region=[0, 0, 0, 1, 1, 1])
options.solver = "descent"
options.mask_path = pathlib.Path("masks")
colmap_ext.facetwise_refinement("a", "b", "c", options, progress=print)
print(colmap_ext.read_ply("c").faces.shape, len(colmap_ext.read_vis("c.vis")[0]))
"""


@unittest.skipUnless(importlib.util.find_spec("mypy"), "no mypy")
@unittest.skipUnless(importlib.util.find_spec("numpy"), "no NumPy")
class TypesTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)

    def run_mypy(self, *arguments):
        return subprocess.run(
            [sys.executable, "-m", "mypy", "--strict", "--no-error-summary",
             "--cache-dir", self.folder / "cache", *arguments], check=False,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8",
            cwd=PACKAGE.parent).stdout

    def test_package_and_example(self):
        self.assertEqual(self.run_mypy(PACKAGE, PACKAGE.parent / "examples"), "")

    def test_uses_of_the_package(self):
        script = self.folder / "script.py"
        script.write_text(RIGHT)
        self.assertEqual(self.run_mypy(script), "")
        script.write_text(WRONG)
        errors = self.run_mypy(script)
        for line in (3, 4, 5, 6):
            self.assertIn(f"script.py:{line}: error", errors)


if __name__ == "__main__":
    unittest.main()
