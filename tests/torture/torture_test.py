"""What the runs look for is found."""

import pathlib
import random
import re
import struct
import tempfile
import unittest

try:
    import numpy as np
except ImportError:
    np = None

if np is not None:
    from damage import KINDS, damage
    from option_values import draw_value, read_options
    from outputs import Fault, check_output
    from processes import Limits, run_process
    from run import Run
    from torture import Tools, find_excessive
    from workspaces import Workspace

TETRAHEDRON = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


def ply_bytes(vertices, faces):
    header = ("ply\nformat binary_little_endian 1.0\n"
              f"element vertex {len(vertices)}\nproperty float x\n"
              f"property float y\nproperty float z\nelement face {len(faces)}\n"
              "property list uchar int vertex_index\nend_header\n")
    return (header.encode() + b"".join(struct.pack("<3f", *v) for v in vertices)
            + b"".join(struct.pack("<B3i", 3, *f) for f in faces))


class FolderTest(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


@unittest.skipIf(np is None, "no NumPy")
class OptionsTest(FolderTest):

    def test_values_are_drawn_from_what_the_help_lists(self):
        program = self.folder / "program"
        program.write_text("#!/bin/sh\ncat <<'END'\n"
                           "  --share (=0.2; 0 ... 1, or -1)\n      Of it\n"
                           "  --count (=5; 3 or more)\n      So many\n"
                           "  --kind (=a)\n      {a, b}: what\nEND\n", "utf-8")
        program.chmod(0o700)
        options = read_options(program, "x")
        self.assertEqual(set(options), {"share", "count", "kind"})
        rng = random.Random(1)

        def share_within(name, holds):
            drawn = [draw_value(rng, name, *options[name]) for _ in range(500)]
            return sum(bool(re.fullmatch(r"-?[\d.]+", text)
                            and holds(float(text))) for text in drawn) / 500
        for name, holds in {"share": lambda x: 0 <= x <= 1 or x == -1,
                            "count": lambda x: x >= 3}.items():
            self.assertGreater(share_within(name, holds), 0.8)
            self.assertGreater(share_within(name, lambda x: not holds(x)), 0.01)
        self.assertLessEqual({"a", "b"}, {draw_value(rng, "kind", *options["kind"])
                                          for _ in range(50)})


@unittest.skipIf(np is None, "no NumPy")
class OutputsTest(FolderTest):

    def check(self, data, name="mesh.ply"):
        (self.folder / name).write_bytes(data)
        check_output(self.folder / name, True)

    def expect_fault(self, data, text, name="mesh.ply"):
        with self.assertRaisesRegex(Fault, text):
            self.check(data, name)

    def test_closed_and_open_meshes_are_good(self):
        self.check(ply_bytes(CORNERS, TETRAHEDRON))
        self.check(ply_bytes(CORNERS, TETRAHEDRON[:3]))
        self.check(ply_bytes(CORNERS[:3], [[0, 1, 2]]))

    def test_a_wheel_is_one_fan_open_or_closed(self):
        for count in (3, 7, 64):
            rim = [[np.cos(i), np.sin(i), 0] for i in range(count)]
            wheel = [[0, 1 + i, 1 + (i + 1) % count] for i in range(count)]
            self.check(ply_bytes([[0, 0, 0], *rim], wheel))
            self.check(ply_bytes([[0, 0, 0], *rim], wheel[:-1]))

    def test_meshes_that_are_no_manifolds_are_found(self):
        twice = [[4 + i if i else 0 for i in face] for face in TETRAHEDRON]
        self.expect_fault(ply_bytes(2 * CORNERS, TETRAHEDRON + twice),
                          "1 vertices of several fans")
        self.expect_fault(ply_bytes(CORNERS + CORNERS[:1], TETRAHEDRON),
                          "without a face")
        turned = [TETRAHEDRON[0][::-1], *TETRAHEDRON[1:]]
        self.expect_fault(ply_bytes(CORNERS, turned), "same direction")
        self.expect_fault(ply_bytes(CORNERS, TETRAHEDRON + TETRAHEDRON[:1]),
                          "same direction")
        self.expect_fault(ply_bytes(CORNERS, [[0, 1, 1]]), "edge of none")
        self.expect_fault(ply_bytes(CORNERS, [[0, 1, 4]]), "out of range")
        self.expect_fault(ply_bytes(CORNERS, []), "without faces")

    def test_positions_that_are_not_finite_are_found(self):
        for number in (float("nan"), float("inf")):
            corners = [*CORNERS[:3], [0, 0, number]]
            self.expect_fault(ply_bytes(corners, TETRAHEDRON), "not finite")

    def test_files_that_are_not_whole_are_found(self):
        data = ply_bytes(CORNERS, TETRAHEDRON)
        for cut in range(len(data)):
            self.expect_fault(data[:cut], "")
        self.expect_fault(data + b"x", "after its end")
        (self.folder / "mesh.ply.vis").write_bytes(struct.pack("<Q3I", 4, 0, 0, 0))
        self.expect_fault(data, "vis cut off")
        self.expect_fault(b'{"a": NaN}', "NaN", "figures.json")
        self.expect_fault(b"<html>", "cut off", "page.html")
        self.expect_fault(b"1 2 3", "no region", "out.region.txt")


@unittest.skipIf(np is None, "no NumPy")
class RunTest(FolderTest):
    """A shell script stands for the program."""

    def run_program(self, script, options=None, limits=None):
        program = self.folder / "program"
        program.write_text("#!/bin/sh\n" + script + "\n")
        program.chmod(0o755)
        ws = self.folder / "base"
        ws.mkdir(exist_ok=True)
        (ws / "fused.ply").write_text("points")
        base = Workspace(ws, "base", [], [0] * 3, [1] * 3, [], {})
        at = self.folder / "run"
        at.mkdir(exist_ok=True)
        run = Run(Tools(program, program, {}, 5), 1, 2, [base], at)
        place = run.place(f"place{len(list(at.iterdir()))}")
        run.step("delaunay_manifold_mesher", options or {}, place, limits)
        return run.faults

    def test_proper_ends_are_no_faults(self):
        self.assertEqual(self.run_program("exit 0"), [])
        self.assertEqual(self.run_program("echo ERROR: no points >&2; exit 1"), [])

    def test_improper_ends_are_found(self):
        for script, fault in {
                "kill -SEGV $$": "SIGSEGV", "exit 134": "ended by 134",
                "exit 1": "0 lines", "echo no >&2; exit 1": "1 lines",
                "echo ERROR: a >&2; echo b >&2; exit 1": "2 lines",
                "echo ERROR: std::bad_alloc >&2; exit 1": "raw message",
                "echo ERROR: a >&2": "exit 0", "echo size nan": "prints"}.items():
            faults = self.run_program(script)
            self.assertEqual(len(faults), 1, script)
            self.assertIn(fault, faults[0])

    def test_files_that_are_lost_or_left_are_found(self):
        error = "; echo ERROR: a >&2; exit 1"
        for script, fault in {
                "rm ws/fused.ply" + error: "changes ws/fused.ply",
                "echo > ws/fused.ply": "changes ws/fused.ply",
                "echo > out.ply" + error: "writes out.ply",
                "echo > .out.ply.12.tmp0": "leaves .out.ply.12.tmp0",
                "echo > out.ply": "no PLY", "true": "is not there"}.items():
            faults = self.run_program(script, {"output_path": "out.ply"})
            self.assertTrue(any(fault in text for text in faults), (script, faults))

    def test_hanging_is_found(self):
        self.assertEqual(self.run_program("exec sleep 99", limits=Limits(0.02)),
                         ["hangs"])
        self.assertEqual(self.run_program("while true; do true; done",
                                          limits=Limits(1)), ["hangs"])

    def test_excess_is_found(self):
        def results(cpu, memory):
            return [{"base": "b", "faults": [], "ended": [("c", 0, cpu, memory, [])]}]
        for cpu, memory in ((1000, 50), (1, 5000)):
            all_results = [*results(cpu, memory)] + sum(
                (results(1, 50) for _ in range(20)), [])
            find_excessive(all_results)
            self.assertEqual([len(r["faults"]) for r in all_results],
                             [1] + 20 * [0])

    def test_a_limit_on_files_stands_for_a_full_disk(self):
        ended = run_process(["sh", "-c", "head -c 3000 /dev/zero > a"],
                            self.folder, Limits(5, file_bytes=1000))
        self.assertNotEqual(ended.code, 0)
        self.assertEqual((self.folder / "a").stat().st_size, 1000)


@unittest.skipIf(np is None, "no NumPy")
class DamageTest(FolderTest):

    def test_it_is_the_same_for_a_seed_and_changes_files(self):
        import random  # pylint: disable=import-outside-toplevel
        data = bytes(range(48, 58)) * 40
        changed = 0
        for seed in range(20 * len(KINDS)):
            ends = []
            for name in ("a", "b"):
                path = self.folder / str(seed) / name / "file"
                path.parent.mkdir(parents=True)
                path.write_bytes(data)
                damage(random.Random(seed), path, [])
                ends.append(path.read_bytes() if path.is_file() else None)
            self.assertEqual(ends[0], ends[1])
            changed += ends[0] != data
        self.assertGreater(changed, 10 * len(KINDS))


if __name__ == "__main__":
    unittest.main()
