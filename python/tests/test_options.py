"""The option dataclasses, by the built program: docs/option_tables compares them with
its help, and these tests with what it refuses."""

import os
import pathlib
import subprocess
import unittest
from typing import get_type_hints

import colmap_ext
from colmap_ext.base_options import Range
from colmap_ext.program import make_arguments

PROGRAM = os.environ.get("COLMAP_EXT")

COMMANDS = {
    "delaunay_manifold_mesher": colmap_ext.DelaunayManifoldMeshingOptions,
    "facetwise_refiner": colmap_ext.FacetwiseRefinementOptions,
    "mesh_evaluator": colmap_ext.MeshEvaluationOptions,
}


def refusal_of(options):
    """What check() says that a value has to be; "" if it accepts all."""
    try:
        options.check()
    except ValueError as error:
        return str(error).partition("it has to be ")[2]
    return ""


class OptionsTest(unittest.TestCase):

    def test_defaults_are_accepted_and_not_passed_on(self):
        for kind in COMMANDS.values():
            with self.subTest(kind):
                self.assertEqual(refusal_of(kind()), "")
                self.assertEqual(kind().given(), {})

    @unittest.skipUnless(PROGRAM, "no program in the environment's COLMAP_EXT")
    def test_refuses_what_the_program_refuses_with_the_same_range(self):
        num_compared = 0
        for command, kind in COMMANDS.items():
            for name, hint in get_type_hints(kind).items():
                # A list is a value for all texts, but for no other option.
                refusal = refusal_of(kind(**{name: [[]]})).replace(", or None", "")
                if "a path" in refusal or refusal in ("a text", "numbers"):
                    continue
                with self.subTest(command=command, option=name):
                    said = subprocess.run(
                        make_arguments(PROGRAM, command, {name: "?"}), check=False,
                        stderr=subprocess.PIPE, encoding="utf-8").stderr.strip()
                    expected = refusal.replace("True or False", "0 or 1")
                    self.assertTrue(said.endswith(f"; it has to be {expected}"),
                                    f"{said}, {refusal}")
                    self.assertEqual(hint is bool, refusal == "True or False")
                num_compared += 1
        self.assertGreater(num_compared, 50)

    def test_ranges_have_ends(self):
        for numbers, inside, outside in (
                (Range(1, 8), (1, 8, 2.5), (0.999, 8.001, -1)),
                (Range(0, also=-1), (0, 1e30, -1), (-0.5, -2)),
                (Range(1e-6, 1, also=0), (1e-6, 0), (1e-7, 2))):
            for number in inside:
                self.assertIn(number, numbers)
            for number in outside:
                self.assertNotIn(number, numbers)

    def test_check_names_the_option_and_its_range(self):
        with self.assertRaises(ValueError) as caught:
            colmap_ext.FacetwiseRefinementOptions(levels=9).check()
        self.assertEqual(str(caught.exception), "FacetwiseRefinementOptions.levels is 9; "
                         "it has to be a whole number, 1 ... 8, or None")

    def test_values_have_the_type_of_their_option(self):
        refinement = colmap_ext.FacetwiseRefinementOptions
        evaluation = colmap_ext.MeshEvaluationOptions
        for options in (refinement(levels=2.5), refinement(levels=True),
                        refinement(levels="2"), refinement(smoothness_weight=float("nan")),
                        refinement(resume=1), refinement(solver="newton"),
                        refinement(min_confidence="none"), refinement(max_face_area=0),
                        refinement(region=[]), refinement(region=["a", "b"]),
                        refinement(mask_path=3), evaluation(depth_thresholds=(0.1, None)),
                        evaluation(image_name=pathlib.Path("a"))):
            self.assertNotEqual(refusal_of(options), "", options.given())
        for options in (refinement(min_confidence="auto"), refinement(min_confidence=1),
                        refinement(max_face_area=None), refinement(mask_path="a"),
                        refinement(region=(0, 0, 0, 1.5, 1, 1)), refinement(region="auto"),
                        refinement(mask_path=pathlib.Path("a")),
                        evaluation(depth_thresholds=[0.1])):
            self.assertEqual(refusal_of(options), "", options.given())

    def test_unknown_names_are_refused(self):
        with self.assertRaises(TypeError):
            colmap_ext.MeshEvaluationOptions(strid=3)
        options = colmap_ext.MeshEvaluationOptions()
        with self.assertRaises(AttributeError):
            options.strid = 3
        with self.assertRaises(AttributeError):
            options.mergedict({"strid": 3})

    def test_dictionaries_and_summary(self):
        options = colmap_ext.MeshEvaluationOptions()
        options.mergedict({"stride": 5, "drop_beyond": True})
        self.assertEqual(options.given(), {"stride": 5, "drop_beyond": True})
        self.assertEqual(colmap_ext.MeshEvaluationOptions(**options.todict()), options)
        lines = options.summary().splitlines()
        self.assertEqual(lines[0], "MeshEvaluationOptions:")
        self.assertIn("    stride = 5", lines)
        self.assertEqual(len(lines), 1 + len(options.todict()))


if __name__ == "__main__":
    unittest.main()
