#!/usr/bin/env python3
"""Runs one file of tests; exits with 77, CTest's skip, where all are skipped
or numpy is missing."""

import importlib.util
import pathlib
import sys
import unittest

SKIPPED = 77


def main(path):
    if importlib.util.find_spec("numpy") is None:
        print("skipped: numpy is missing")
        return SKIPPED
    sys.path.insert(0, str(path.parent))
    suite = unittest.defaultTestLoader.loadTestsFromName(path.stem)
    result = unittest.TextTestRunner(sys.stdout, verbosity=2).run(suite)
    if not result.wasSuccessful() or result.testsRun == 0:
        return 1
    return SKIPPED if len(result.skipped) == result.testsRun else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
