"""Imports the package under test from this checkout, with a separate cache for each test."""

import os
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

WHOLE = "FLATSPECKLE_TEST_WHOLE" in os.environ  # by night: all tests at their full sizes
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))

import flatspeckle as fs

SLAB = {"domain": "slab", "depth": 1000, "scatterer": "hg", "g": 0.9, "optical_depth": 4}
CURVE = {**SLAB, "covariance": "memory_effect", "tilts": [0, 1e-4, 2e-4]}
BOX = {"width": 20, "depth": 10, "count": 31}
FEW = {"samples": 2000, "threads": 1}


class PackageTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        os.environ["FLATSPECKLE_CACHE"] = str(self.folder / "cache")

    def leave_figures_undrawn(self):
        """By day figures are made but not drawn, which takes most of the time: apps/plots draws one per script."""
        if not WHOLE:
            self.enterContext(mock.patch.object(fs.plots, "whole"))
