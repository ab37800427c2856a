"""Sweeps for tests, and access to the contents of their folders of points."""

import itertools
import os
import signal
import time

import h5py
import numpy as np

import journals
from program import WHOLE, ProgramTest, datasets

# 2 x 2 x 2 points.
SWEEP = {"depth": 100, "optical_depth": [1, 2], "g": [0, 0.5], "albedo": [1, 0.9],
         "tilts": [0, 0.001, 0.01], "samples": 4000, "threads": 2}
# 40 points.
MANY = {**SWEEP, "optical_depth": [1, 2, 3, 4, 5], "g": [0, 0.3, 0.5, 0.7]}
# Each of its points takes a tenth of a second of one thread or more.
SLOW = {**SWEEP, "g": [0.5], "albedo": [1], "optical_depth": [1, 2, 3], "samples": 400_000 if WHOLE else 180_000}
NEVER = 1e-9  # a target error that is not reached


def names_of(grid, method="mc"):
    """Returns the names of the points of a grid, in the order of the result."""
    axes = [[f"{key}={value}" for value in grid[key]]
            for key in ("optical_depth", "g", "albedo") if key in grid]
    return ["_".join((method, *point)) for point in itertools.product(*axes)]


def cpu_seconds(process):
    """Returns the CPU seconds that the process has used so far."""
    with open(f"/proc/{process.pid}/stat") as stat:
        fields = stat.read().rpartition(") ")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class SweepTest(ProgramTest):
    wholes = {}  # results of whole()

    def whole(self, keys, out="whole.h5"):
        """Returns an undisturbed sweep, made once for all tests of a file."""
        name = repr(keys)
        if name not in self.wholes:
            self.call("sweep", **keys, out=out)
            self.wholes[name] = (self.folder / out).read_bytes()
        (self.folder / out).write_bytes(self.wholes[name])

    def points(self, out="sweep.h5", folder=None):
        """Returns the folder of a sweep's points."""
        return (folder or self.folder) / f"{out}.shards"

    def shards(self, out="sweep.h5", folder=None):
        """Returns its files by name, without those being written."""
        place = self.points(out, folder)
        return {path.name: path.read_bytes()
                for path in (sorted(place.iterdir()) if place.is_dir() else [])
                if not path.name.startswith(".")}

    def journal(self, number=0, of=1, out="sweep.h5"):
        """Returns the journal of the finished points of a share."""
        return self.points(out) / f"share-{number}-of-{of}.points"

    def finished(self, out="sweep.h5", folder=None):
        """Returns all finished points by name."""
        return journals.points_in(self.points(out, folder))

    def unfinished(self, out="sweep.h5"):
        """Returns the saved states of points in progress, by file name."""
        return {name: data for name, data in self.shards(out).items() if name.endswith(".part")}

    def all_points(self, keys, out="sweep.h5"):
        """Leaves every point finished in the folder, without a result."""
        self.call("sweep", **keys, shard="0/1", out=out)

    def interrupted(self, number=signal.SIGINT, cpu_s=0.1, **keys):
        """Signals a sweep after `cpu_s` of work, amid its points; it ends resumable."""
        process = self.start("sweep", **keys)
        self.wait_until_it_catches(process)
        began = cpu_seconds(process)
        self.wait_until(process, lambda: cpu_seconds(process) >= began + cpu_s)
        process.send_signal(number)
        status = process.wait(timeout=60)
        self.assertEqual(status, 75, process.stderr.read())

    def assert_points_equal(self, points, whole, prefix=""):
        """Checks that each point of a list is in the whole grid with the same numbers."""
        points, whole = (datasets(self.folder / path) for path in (points, whole))
        axes = ("optical_depth", "g", "albedo")
        for i in range(len(points["point"])):
            at = tuple(int(np.flatnonzero(whole[key] == points[key][i])[0]) for key in axes)
            flat = np.ravel_multi_index(at, [len(whole[key]) for key in axes])
            for name in ("field_correlation", "field_correlation_error", "memory_effect_range",
                         "memory_effect_range_error", "relative_error", "samples",
                         "range_censored"):
                np.testing.assert_array_equal(points[prefix + name][i], whole[prefix + name][at])
            for name in ("trace/samples", "trace/relative_error"):
                np.testing.assert_array_equal(
                    points[prefix + name][points[prefix + "trace/of_point"] == i],
                    whole[prefix + name][whole[prefix + "trace/of_point"] == flat])

    def assert_one_line(self, error, *words):
        """Checks that one line gives the reason for the end; warnings may precede it."""
        lines = [line for line in error.splitlines()
                 if not line.startswith(("warning: ", "note: ", "sweep: "))]
        self.assertEqual(len(lines), 1, error)
        self.assertTrue(lines[0].startswith("flatspeckle: "), lines[0])
        for word in words:
            self.assertIn(word, lines[0])


def is_complete(path):
    with h5py.File(path) as file:
        return bool(file.attrs["complete"])
