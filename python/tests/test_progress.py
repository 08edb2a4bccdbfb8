"""What is read of the program's output, and how it is shown."""

import contextlib
import io
import sys
import types
import unittest
from unittest import mock

from colmap_ext.progress import Progress, parse_progress, show_progress


class ProgressTest(unittest.TestCase):

    def test_stages_and_iterations_are_read(self):
        for line, progress in (
                ("Walking rays ... 12.3 s\n", Progress("Walking rays", 1.0, 12.3)),
                ("Refining, level 2 ... 1 min 02 s   \n",
                 Progress("Refining, level 2", 1.0, 62.0)),
                ("Walking rays ... 40 %, 2.5 s left\n", Progress("Walking rays", 0.4)),
                ("Walking rays ... 0 %\n", Progress("Walking rays", 0.0)),
                ("full size, final, 6 pairs, iteration 12: energy -4.6e+05, ZNCC 0.9646, "
                 "step 0.030 px\n",
                 Progress("full size, final, 6 pairs", iteration=12, energy=-4.6e5,
                          zncc=0.9646, step=0.03))):
            self.assertEqual(parse_progress(line), progress)

    def test_other_lines_are_not(self):
        for line in ("", "Workspace\n", "  Walking rays            0.02 s\n",
                     "    ... and facing them                       100.00 %\n",
                     "  all                                           0.08 s\n",
                     "Wrote a ... b and c\n"):
            self.assertIsNone(parse_progress(line), line)

    def test_lines_are_printed_without_tqdm(self):
        printed = io.StringIO()
        with mock.patch.dict(sys.modules, {"tqdm.auto": None, "tqdm": None}):
            with contextlib.redirect_stdout(printed), show_progress(True) as show:
                show(Progress("Walking rays", 0.25))
                show(Progress("Walking rays", 1.0, 2.0))
                show(Progress("1/4 size", None, None, 3, -5.0, 0.9, 0.25))
        self.assertEqual(printed.getvalue(),
                         "Walking rays ... 25 %\nWalking rays ... 2.0 s\n"
                         "1/4 size, iteration 3: ZNCC 0.9000, step 0.250 px\n")

    def test_a_bar_of_tqdm_is_closed(self):
        shown = []

        class Bar(contextlib.AbstractContextManager):
            n = 0

            def __init__(self, total, bar_format):
                self.total = total
                bar_format.format(percentage=1.0, bar="", elapsed="", desc="")

            def set_description_str(self, text):
                shown.append((self.n / self.total, text))

            def __exit__(self, *error):
                shown.append("closed")

        module = types.ModuleType("tqdm.auto")
        module.tqdm = Bar
        with mock.patch.dict(sys.modules, {"tqdm.auto": module,
                                           "tqdm": types.ModuleType("tqdm")}):
            with self.assertRaises(KeyError), show_progress(True) as show:
                show(Progress("Walking rays", 0.25))
                show(Progress("Walking rays", 1.0, 2.0))
                show(Progress("1/4 size", None, None, 3, -5.0, 0.9, 0.25))
                raise KeyError
        self.assertEqual([share for share, _ in shown[:-1]], [0.25, 1, 0])
        self.assertIn("Walking rays", shown[0][1])
        self.assertEqual(shown[-1], "closed")

    def test_a_function_is_taken_as_it_is(self):
        with show_progress(print) as show:
            self.assertIs(show, print)
        with show_progress(False) as show:
            self.assertIsNone(show)


if __name__ == "__main__":
    unittest.main()
