"""The functions that run the program, by the built one."""

import importlib.util
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

import colmap_ext
import sphere_workspace
from colmap_ext import (DelaunayManifoldMeshingOptions, FacetwiseRefinementOptions,
                        MeshEvaluationOptions)

PROGRAM = os.environ.get("COLMAP_EXT")
MAKE_WORKSPACE = os.environ.get("COLMAP_EXT_MAKE_WORKSPACE")


def press_ctrl_c():
    os.kill(os.getpid(), signal.SIGINT)


def restore_ctrl_c(test):
    """A background job of a shell ignores it."""
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    test.addCleanup(signal.signal, signal.SIGINT, handler)


@unittest.skipUnless(PROGRAM, "no program in the environment's COLMAP_EXT")
class CommandsTest(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.workspace = self.folder / "a scène and more"
        self.mesh = self.folder / "m.ply"
        sphere_workspace.write(self.workspace)

    def make_mesh(self, **options):
        colmap_ext.delaunay_manifold_meshing(
            self.workspace, self.mesh, DelaunayManifoldMeshingOptions(**options))
        return self.mesh.read_bytes()

    def test_meshes_refines_and_evaluates(self):
        progress = []
        colmap_ext.delaunay_manifold_meshing(
            self.workspace, self.mesh,
            DelaunayManifoldMeshingOptions(max_proj_dist=5, half_pixel_correction="off"),
            progress=progress.append)
        self.assertIn("Walking rays", [shown.stage for shown in progress])
        refined = self.folder / "r.ply"
        progress.clear()
        colmap_ext.facetwise_refinement(
            self.workspace, self.mesh, refined,
            FacetwiseRefinementOptions(levels=1, iterations=1), progress=progress.append)
        self.assertTrue(os.path.exists(f"{refined}.vis"))
        self.assertIn(("full size", 1),
                      [(shown.stage, shown.iteration) for shown in progress])
        figures = colmap_ext.mesh_evaluation(
            refined, self.mesh, MeshEvaluationOptions(workspace_path=self.workspace,
                                                      depth_thresholds=[0.1, 0.2, 0.4]))
        self.assertTrue(figures["topology"]["is_manifold"])
        self.assertLess(figures["accuracy"]["mean"], 0.1)

    def test_figures_are_also_written_where_the_options_say(self):
        self.make_mesh()
        path = self.folder / "figures.json"
        figures = colmap_ext.mesh_evaluation(self.mesh, self.mesh,
                                             MeshEvaluationOptions(json_path=path,
                                                                   spacing=0.05))
        self.assertLess(figures["accuracy"]["mean"], 1e-6)
        self.assertTrue(path.exists())

    def test_options_do_what_they_say(self):
        coarse = self.make_mesh(max_proj_dist=20)
        self.assertGreater(len(self.make_mesh(max_proj_dist=0)), 1.2 * len(coarse))

    def test_options_have_priority_over_a_preset(self):
        high = self.make_mesh()
        self.assertNotEqual(self.make_mesh(quality="extreme"), high)
        self.assertEqual(self.make_mesh(quality="extreme", max_proj_dist=20), high)

    def test_errors_have_a_type_and_the_programs_line(self):
        mesh = colmap_ext.delaunay_manifold_meshing
        with self.assertRaises(colmap_ext.CommandError) as caught:
            mesh(self.folder / "none", self.mesh)
        self.assertIn("no such folder", caught.exception.line)
        self.assertEqual(caught.exception.exit_code, 1)
        self.assertIn("delaunay_manifold_mesher", caught.exception.arguments)
        with self.assertRaisesRegex(ValueError, "max_proj_dist is -1"):
            mesh(self.workspace, self.mesh, DelaunayManifoldMeshingOptions(max_proj_dist=-1))
        with self.assertRaises(colmap_ext.ProgramNotFoundError):
            mesh(self.workspace, self.mesh, program="/no/such/program")
        with self.assertRaises(colmap_ext.ProgramNotFoundError):
            mesh(self.workspace, self.mesh, program="/bin/true")
        self.assertTrue(issubclass(colmap_ext.StoppedError, colmap_ext.ColmapExtError))

    def test_a_callback_that_raises_ends_the_program(self):
        def stop(progress):
            raise KeyError(progress.stage)

        with self.assertRaises(KeyError):
            colmap_ext.delaunay_manifold_meshing(self.workspace, self.mesh, progress=stop)
        self.assertEqual([path.name for path in self.folder.iterdir()],
                         [self.workspace.name])

    def test_a_refinement_resumes_after_ctrl_c_with_the_same_result(self):
        restore_ctrl_c(self)
        self.make_mesh(max_proj_dist=0)
        stages = []

        def stop(progress):
            stages.append(progress.stage)
            if progress.stage == "1/2 size":
                press_ctrl_c()

        def refine(name, progress=False, **options):
            colmap_ext.facetwise_refinement(
                self.workspace, self.mesh, self.folder / name,
                FacetwiseRefinementOptions(max_face_area=1, **options), progress=progress)
            return [(self.folder / f"{name}{end}").read_bytes() for end in ("", ".vis")]

        undisturbed = refine("a.ply")
        with self.assertRaisesRegex(KeyboardInterrupt, "refined up to 1/4 size"):
            refine("b.ply", stop)
        self.assertEqual(stages[-1], "1/2 size")
        self.assertTrue((self.folder / "b.ply.resume").exists())
        self.assertFalse((self.folder / "b.ply").exists())
        stages.clear()
        self.assertEqual(refine("b.ply", lambda shown: stages.append(shown.stage), resume=True),
                         undisturbed)
        self.assertNotIn("1/4 size", stages)
        self.assertIn("1/2 size", stages)


@unittest.skipUnless(os.path.exists("/bin/sh"), "no shell")
class ExitCodesTest(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.program = pathlib.Path(folder.name) / "program"

    def run_program(self, lines, progress=False, **options):
        self.program.write_text(
            "#!/bin/sh\n[ \"$2\" = -h ] && echo '  --input_path' && echo '  --output_path'"
            " && exit 0\n" + lines)
        self.program.chmod(0o755)
        colmap_ext.delaunay_manifold_meshing(
            "anywhere", "m.ply", DelaunayManifoldMeshingOptions(**options),
            program=self.program, progress=progress)

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

    def test_options_that_the_program_does_not_have(self):
        with self.assertRaises(colmap_ext.OptionError) as caught:
            self.run_program("exit 0", min_confidence=0.2)
        self.assertIn("min_confidence", caught.exception.line)

    def test_ctrl_c_waits_and_another_one_is_passed_on(self):
        restore_ctrl_c(self)
        # The first signal is noted, the second one ends it before its 2 s are over.
        lines = (f"file={self.program}.ended\n"
                 "trap 'if [ $first ]; then echo 2 > $file; exit 130; fi; first=1' INT\n"
                 "echo 'Stage ... 0.1 s'\n"
                 "for i in $(seq 40); do sleep 0.05; done; echo 1 > $file\n")
        ended = pathlib.Path(f"{self.program}.ended")
        for num_presses in (1, 2):
            with self.subTest(num_presses):
                ended.unlink(missing_ok=True)

                def press(_, more=num_presses - 1):
                    for _ in range(more):
                        threading.Timer(0.5, press_ctrl_c).start()
                    press_ctrl_c()

                with self.assertRaises(KeyboardInterrupt):
                    self.run_program(lines, press)
                self.assertEqual(ended.read_text(), f"{num_presses}\n")


@unittest.skipUnless(PROGRAM and MAKE_WORKSPACE, "no programs in the environment")
@unittest.skipUnless(importlib.util.find_spec("numpy"), "no NumPy")
class ExampleTest(unittest.TestCase):

    def test_the_demo_runs(self):
        demo = pathlib.Path(__file__).resolve().parents[1] / "examples" / "demo.py"
        with tempfile.TemporaryDirectory() as folder:
            printed = subprocess.run(
                [sys.executable, demo], check=True, cwd=folder, stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL, encoding="utf-8").stdout
        self.assertEqual(printed.count("2-manifold: True"), 2, printed)


if __name__ == "__main__":
    unittest.main()
