"""The program on the built-in case's image, in a folder of its own; its path is the last word of the command line."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

BIOPSY = sys.argv.pop()
ENTRY, TARGET = (-4.396, 33.092, 51.854), (-6.737, 33.183, 50.982)  # R, A, S mm, in that image


def lps(point):
    return (-point[0], -point[1], point[2])


def text(point):
    return ",".join(map(str, point))


class SampleCase(unittest.TestCase):
    """The image is a DICOM series, gap/planning in the folder."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        result = cls.run_biopsy("plan", "gap", "--out", "gap")
        assert result.returncode == 0, result.stderr

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def run_biopsy(cls, *words):
        return subprocess.run([BIOPSY, *words], cwd=cls.folder, capture_output=True, text=True, timeout=300)
