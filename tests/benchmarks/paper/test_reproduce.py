"""The whole run, with a stand-in for colmap that writes made-up figures; and,
where colmap is built, with colmap itself as far as it goes."""

import contextlib
import importlib.util
import io
import json
import sys
import unittest

import numpy as np

import reproduce
import settings
import small_scenes
from colmap_model import link
from colmap_tool import Colmap
from test_tables import rows_of

HAS_SCIPY = importlib.util.find_spec("scipy") is not None

# Lists its commands, writes its outputs, and appends each call to a file.
STAND_IN = '''#!{python}
import json, pathlib, sys
COMMANDS, FIGURES = {commands!r}, {figures!r}
command, options = sys.argv[1], sys.argv[2:]
if command == "help":
    print("COLMAP 0 (without CUDA)\\n\\nAvailable commands:")
    print("".join("  %s\\n" % name for name in COMMANDS))
else:
    options = dict(zip([o[2:] for o in options[::2]], options[1::2]))
    with open(__file__ + ".calls", "a") as calls:
        calls.write(json.dumps([command, options]) + "\\n")
    if "json_path" in options:
        pathlib.Path(options["json_path"]).write_text(json.dumps(FIGURES))
    else:
        pathlib.Path(options["output_path"]).write_text("ply")
        print("  of the cut      40\\n  after fixing   4")
'''
FIGURES = {
    "accuracy": {"mean": 0.4, "median": 0.2},
    "completeness": {"mean": 0.6, "median": 0.4},
    "average_score": 0.4,
    "depths": {"shares": [0.75, 0.95]},
}


class Reproduce(small_scenes.InFolder):
    def setUp(self):
        super().setUp()
        self.program = self.folder / "colmap"

    def make_stand_in(self, *commands):
        self.program.write_text(STAND_IN.format(
            python=sys.executable, commands=commands, figures=FIGURES))
        self.program.chmod(0o755)

    def calls(self):
        path = self.folder / "colmap.calls"
        if not path.exists():
            return []
        return [json.loads(line) for line in path.read_text().splitlines()]

    def make_dtu(self, scan, points):
        """A scan with its truth, points [n, 3], which are its fused ones."""
        import scipy.io
        root = self.folder / "dtu"
        small_scenes.write_dtu(root, scan)
        (root / "ObsMask").mkdir()
        scipy.io.savemat(root / "ObsMask" / f"ObsMask{scan}_10.mat", {
            "ObsMask": np.ones((4, 4, 3), np.uint8), "Res": 1.0,
            "BB": np.array([[-1.5, -1.5, -1], [1.5, 1.5, 1]])})
        scipy.io.savemat(root / "ObsMask" / f"Plane{scan}.mat",
                         {"P": np.array([[0.0], [0], [1], [5]])})
        small_scenes.write_fused(self.folder / "fused" / f"scan{scan}", 8,
                                 points)
        truth = root / "Points" / "stl" / f"stl{scan:03d}_total.ply"
        truth.parent.mkdir(parents=True)
        fused = self.folder / "fused" / f"scan{scan}" / "fused.ply"
        truth.write_bytes(fused.read_bytes())

    def run_tables(self, *arguments):
        """Standard output and standard error."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            reproduce.main([*arguments, "--work", str(self.folder / "work"),
                            "--colmap", str(self.program),
                            "--fused", str(self.folder / "fused")])
        return out.getvalue(), err.getvalue()

    def make_epfl(self):
        folder = self.folder / "epfl" / "fountain-P11"
        small_scenes.write_epfl(folder)
        (folder / "fountain_dense.ply").write_text("ply")
        small_scenes.write_fused(self.folder / "fused" / "fountain", 3,
                                 np.zeros((1, 3)))

    def run_dtu(self, *arguments):
        return self.run_tables("1", "2", "--dtu", str(self.folder / "dtu"),
                               "--scans", "4", "6", *arguments)

    @unittest.skipUnless(HAS_SCIPY, "scipy.io is missing")
    def test_all_commands_fill_all_columns(self):
        self.make_dtu(4, np.zeros((1, 3)))
        self.make_stand_in(settings.MESHER, "mesh_evaluator",
                           settings.REFINER)
        out, err = self.run_dtu()
        self.assertIn("scan6", err)  # is not there, and said so
        first, second = (rows_of(part) for part in out.split("### Table II:"))
        for title in settings.ABLATIONS.values():
            for setting in settings.MESHING:
                self.assertEqual(
                    first[f"ours, {setting}: {title}"],
                    ["0.4000", "0.2000", "0.6000", "0.4000", "0.4000", "1"])
        self.assertEqual(second["ours, paper: w/o fixing"][:2], ["40", "-"])
        self.assertEqual(second["ours, paper: % avoided"][0], "90.0")

    @unittest.skipUnless(HAS_SCIPY, "scipy.io is missing")
    def test_options_follow_setting_and_ablation(self):
        self.make_dtu(4, np.zeros((1, 3)))
        self.make_stand_in(settings.MESHER, "mesh_evaluator",
                           settings.REFINER)
        self.run_dtu("--settings", "paper")
        calls = self.calls()
        self.run_dtu("--settings", "paper")
        self.assertEqual(self.calls(), calls)  # nothing is computed twice
        meshing = [o for c, o in calls if c == settings.MESHER]
        self.assertEqual(len(meshing), 2)
        for options in meshing:
            for name, value in settings.PAPER_MESHING.items():
                self.assertEqual(options[name], str(value))
        fixing = "DelaunayManifoldMeshing.preemptive_fixing"
        self.assertEqual([o.get(fixing) for o in meshing], [None, "0"])
        refining = [o for c, o in calls if c == settings.REFINER]
        self.assertEqual(
            [o.get("FacetwiseRefinement.pair_selection") for o in refining],
            [None, "classical", None])
        for options in refining:
            self.assertIn("meshes", options["input_path"])
            self.assertIn("workspace_path", options)
        evaluation = [o for c, o in calls if c == "mesh_evaluator"][0]
        self.assertEqual(evaluation["observability_box"], "-1.5,-1.5,-1.0,1.0")
        self.assertEqual(evaluation["ground_plane"], "0.0,0.0,1.0,5.0")
        self.assertEqual(evaluation["MeshEvaluation.max_distance"], "20.0")

    @unittest.skipUnless(HAS_SCIPY, "scipy.io is missing")
    def test_without_the_refiner_only_the_initial_mesh_has_figures(self):
        self.make_dtu(4, np.zeros((1, 3)))
        self.make_stand_in(settings.MESHER, "mesh_evaluator")
        out, err = self.run_dtu("--settings", "default")
        self.assertIn(settings.REFINER, err)
        rows = rows_of(out.split("### Table II:")[0])
        self.assertEqual(rows["ours, default: initial mesh"][-1], "1")
        for ablation in ("no_fixing", "whole_mesh", "all"):
            self.assertEqual(
                rows[f"ours, default: {settings.ABLATIONS[ablation]}"],
                ["-"] * 5 + ["0"])

    @unittest.skipUnless(HAS_SCIPY, "scipy.io is missing")
    def test_an_evaluator_that_comes_later_fills_in(self):
        self.make_dtu(4, np.zeros((1, 3)))
        self.make_stand_in(settings.MESHER)
        title = "ours, paper: initial mesh"
        out = self.run_dtu()[0].split("### Table II:")[0]
        self.assertEqual(rows_of(out)[title], ["-"] * 5 + ["0"])
        self.make_stand_in(settings.MESHER, "mesh_evaluator")
        out = self.run_dtu()[0].split("### Table II:")[0]
        self.assertEqual(rows_of(out)[title][-1], "1")

    @unittest.skipUnless(HAS_SCIPY, "scipy.io is missing")
    def test_without_the_truth_table_2_is_filled_still(self):
        self.make_dtu(4, np.zeros((1, 3)))
        (self.folder / "dtu" / "ObsMask" / "Plane4.mat").unlink()
        self.make_stand_in(settings.MESHER, "mesh_evaluator")
        out, err = self.run_dtu("--settings", "paper")
        self.assertIn("Plane4.mat", err)
        first, second = (rows_of(part) for part in out.split("### Table II:"))
        self.assertEqual(first["ours, paper: initial mesh"], ["-"] * 5 + ["0"])
        self.assertEqual(second["ours, paper: fixing"][0], "4")

    def test_epfl(self):
        self.make_epfl()
        self.make_stand_in(settings.MESHER, "mesh_evaluator")
        out, err = self.run_tables("3", "--epfl", str(self.folder / "epfl"))
        self.assertIn("herzjesu", err)
        rows = rows_of(out)
        self.assertEqual(rows["ours, default: initial mesh"],
                         ["0.750", "0.950", "-", "-"])
        self.assertEqual(rows["ours, default: all"], ["-"] * 4)

    def test_without_points_nothing_is_made_up(self):
        small_scenes.write_dtu(self.folder / "dtu", 4)
        self.make_stand_in(settings.MESHER, "mesh_evaluator")
        out, err = self.run_dtu("--settings", "paper")
        self.assertIn("fused.ply", err)
        self.assertEqual(self.calls(), [])
        self.assertEqual(rows_of(out)["ours, paper: fixing"], ["-"] * 13)

    def test_missing_folders_are_asked_for(self):
        for arguments in (["1"], ["2"], ["3"], ["4"]):
            with self.assertRaises(SystemExit), \
                    contextlib.redirect_stderr(io.StringIO()):
                reproduce.main([*arguments, "--work", "w", "--colmap", "c"])

    @unittest.skipUnless(HAS_SCIPY, "scipy.io is missing")
    @unittest.skipUnless(small_scenes.colmap_program(), "colmap is not built")
    def test_with_colmap_itself(self):
        rng = np.random.default_rng(1)
        self.make_dtu(4, rng.uniform(-0.4, 0.4, (600, 3)) * [1, 1, 0.02])
        link(small_scenes.colmap_program(), self.program)
        out, _ = self.run_dtu()
        first, second = (rows_of(part) for part in out.split("### Table II:"))
        has_evaluator = "mesh_evaluator" in Colmap(self.program).commands
        for setting in settings.MESHING:
            row = first[f"ours, {setting}: initial mesh"]
            self.assertEqual(row[-1], str(int(has_evaluator)))
            self.assertEqual(row[0] == "-", not has_evaluator)
            self.assertTrue(second[f"ours, {setting}: w/o fixing"][0]
                            .isdigit())


if __name__ == "__main__":
    unittest.main()
