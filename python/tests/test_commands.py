"""The functions that run the program, by the built one."""

import os
import pathlib
import tempfile
import unittest

import colmap_ext
import sphere_workspace

PROGRAM = os.environ.get("COLMAP_EXT")


@unittest.skipUnless(PROGRAM, "no program in the environment's COLMAP_EXT")
class CommandsTest(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.workspace = self.folder / "a scène and more"
        sphere_workspace.write(self.workspace)

    def test_meshes_refines_and_evaluates(self):
        stages = []
        mesh = colmap_ext.mesh(self.workspace, max_proj_dist=5, half_pixel_correction=False,
                               progress=lambda *stage: stages.append(stage))
        self.assertEqual(mesh, str(self.workspace / "meshed-delaunay-manifold.ply"))
        self.assertIn("Walking rays", [name for name, _ in stages])
        self.assertTrue(all(0 <= share <= 1 for _, share in stages))
        refined = colmap_ext.refine(self.workspace, levels=1, iterations=1,
                                    input_path=mesh, output_path=self.folder / "r.ply")
        self.assertTrue(os.path.exists(refined + ".vis"))
        figures = colmap_ext.evaluate(refined, mesh, workspace=self.workspace)
        self.assertTrue(figures["topology"]["is_manifold"])
        self.assertLess(figures["accuracy"]["mean"], 0.1)

    def test_options_do_what_they_say(self):
        coarse = colmap_ext.mesh(self.workspace, max_proj_dist=8)
        size = os.path.getsize(coarse)
        fine = colmap_ext.mesh(self.workspace, max_proj_dist=0, output_path=self.folder / "m.ply")
        self.assertGreater(os.path.getsize(fine), 1.2 * size)

    def test_errors_have_a_type_and_the_programs_line(self):
        with self.assertRaises(colmap_ext.CommandError) as caught:
            colmap_ext.mesh(self.folder / "none")
        self.assertIn("no such folder", caught.exception.line)
        self.assertEqual(caught.exception.exit_code, 1)
        self.assertIn("delaunay_manifold_mesher", caught.exception.arguments)
        with self.assertRaises(colmap_ext.CommandError) as caught:
            colmap_ext.mesh(self.workspace, max_proj_dist="many")
        self.assertIn("is 'many'; it has to be a", caught.exception.line)
        with self.assertRaises(colmap_ext.OptionError) as caught:
            colmap_ext.mesh(self.workspace, max_proj_dits=3)
        self.assertIn("max_proj_dist", caught.exception.line)
        with self.assertRaises(colmap_ext.ProgramNotFoundError):
            colmap_ext.mesh(self.workspace, program="/no/such/program")
        with self.assertRaises(colmap_ext.ProgramNotFoundError):
            colmap_ext.mesh(self.workspace, program="/bin/true")
        self.assertTrue(issubclass(colmap_ext.StoppedError, colmap_ext.ColmapExtError))

    def test_a_callback_that_raises_ends_the_program(self):
        def stop(stage, share):
            raise KeyError(stage)

        with self.assertRaises(KeyError):
            colmap_ext.mesh(self.workspace, progress=stop)
        self.assertEqual(
            [path.name for path in self.workspace.glob("*mesh*")], [])


@unittest.skipUnless(os.path.exists("/bin/sh"), "no shell")
class ExitCodesTest(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.program = pathlib.Path(folder.name) / "program"

    def run_program(self, lines):
        self.program.write_text(
            "#!/bin/sh\n[ \"$2\" = -h ] && echo '  --workspace_path' && exit 0\n" + lines)
        self.program.chmod(0o755)
        return colmap_ext.mesh("anywhere", program=self.program)

    def test_each_end_has_its_type(self):
        for lines, kind, text in (
                ("echo 'ERROR: a reason' >&2; exit 1", colmap_ext.CommandError, "a reason"),
                ("echo 'Interrupted: half done' >&2; exit 130", colmap_ext.StoppedError,
                 "half done"),
                ("kill -TERM $$", colmap_ext.StoppedError, "exit code -15"),
                ("echo 'terrible' >&2; kill -ABRT $$", colmap_ext.CrashError, "terrible"),
                ("exit 134", colmap_ext.CrashError, "exit code 134")):
            with self.subTest(lines), self.assertRaises(kind) as caught:
                self.run_program(lines)
            self.assertIn(text, caught.exception.line)

    def test_finds_the_path_in_what_is_printed(self):
        self.assertEqual(self.run_program("echo 'Wrote a and b and a and b.vis'"), "a and b")
        self.assertEqual(self.run_program(
            "echo 'Wrote a, b, a, b.vis and c, which belong together'"), "a, b")


if __name__ == "__main__":
    unittest.main()
