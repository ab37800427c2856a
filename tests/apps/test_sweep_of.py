"""`sweep --of`: points are runs of the subcommand, nothing is lost, and parts merge to the whole."""

import random
import shutil
import signal
import subprocess
import sys
import time
import unittest

import h5py
import numpy as np

from program import PROGRAM, SLOWNESS, WHOLE, datasets, flags
from sweeps import SweepTest

GUIDE = {"field": "ultrasound", "index": 1.33, "sound_wavenumber": 3.4, "stage_box": [-5, -5, 0, 5, 5, 10],
         "mu_s": 0.2, "phase": "henyey_greenstein", "g": 0.8, "beam_light": [0, 0, 0, 0, 0, 1, 0.5, 1],
         "sensor": "area", "sensor_at": [0, 0, 10], "sensor_size": [1, 1], "pixels": [1, 1],
         "samples": 512, "method": "light"}
GRID = {**GUIDE, "of": "render", "vary": ["amplitude=0:0.004:3", "mu_s=0.1,0.3"], "threads": 2}
MANY = {**GRID, "samples": 2048, "vary": ["amplitude=0:0.004:6", "g=0:0.9:5"]}
SLOW = {**GRID, "vary": ["amplitude=0:0.004:3", "mu_s=0.1,0.3"], "samples": 100_000 if WHOLE else 15_000}
COSTS = ("wall_s", "cpu_s")


class SweepOf(SweepTest):
    def assert_same(self, a, b):
        a, b = (datasets(self.folder / path) for path in (a, b))
        self.assertEqual(a.keys(), b.keys())
        for name, values in a.items():
            np.testing.assert_array_equal(values, b[name], name)

    def test_points_are_runs_of_their_own(self):
        self.call("sweep", **GRID, out="sweep.h5")
        swept = datasets(self.folder / "sweep.h5")
        np.testing.assert_array_equal(swept["amplitude"], [0, 0.002, 0.004])
        np.testing.assert_array_equal(swept["mu_s"], [0.1, 0.3])
        self.assertFalse(self.points().exists())
        for i, amplitude in enumerate(swept["amplitude"]):
            for j, mu_s in enumerate(swept["mu_s"]):
                point = {**GUIDE, "amplitude": amplitude, "mu_s": mu_s}
                self.call("render", **point, out="one.h5")
                one = datasets(self.folder / "one.h5", ("wall_s", "cpu_s", "state", "trace", "transport",
                                                        "trials"))
                for name, values in one.items():
                    found = swept[name] if name in ("row", "column") else swept[name][i, j]
                    np.testing.assert_array_equal(found, values, name)

    def test_another_seed(self):
        self.call("sweep", **GRID, seed=5, out="sweep.h5")
        found = datasets(self.folder / "sweep.h5")["total"][0, 1]
        self.call("render", **{**GUIDE, "amplitude": 0, "mu_s": 0.3}, seed=5, out="one.h5")
        self.assertEqual(found, datasets(self.folder / "one.h5")["total"])
        self.call("render", **{**GUIDE, "amplitude": 0, "mu_s": 0.3}, out="one.h5")
        self.assertNotEqual(found, datasets(self.folder / "one.h5")["total"])

    def test_other_subcommands(self):
        """Their points equal separate runs too: by batches, by transport or in one step."""
        box = {"domain": "box", "width": 10, "depth": 6, "scatterer": "hg", "optical_depth": 1, "albedo": 1}
        slab = {"domain": "slab", "depth": 50, "scatterer": "hg", "albedo": 0.9, "optical_depth": 2}
        cylinders = {"width": 8, "depth": 6, "count": 4, "scatterer": "tm", "radius": 0.16, "index": 1.3}
        for of, keys, vary, values in (
                ("trace", {"field": "parabolic", "index": 1.5, "origin": [0, 0, 0], "ray_count": 3, "beam_radius": 0.2,
                           "stop_plane": [0, 0, 3, 0, 0, 1], "max_length": 9}, "alpha", (0.1, 0.2)),
                ("covariance", {**box, "view_angles": [0.3, 0.5], "samples": 2000}, "g", (0, 0.5)),
                ("covariance", {**slab, "view_angles": 0.3, "covariance": "memory_effect", "tilts": [0, 0.01]},
                 "g", (0, 0.5)),
                ("flux", {**slab, "light_angles": 0}, "g", (0, 0.5)),
                ("field", {**box, "g": 0, "view_angles": [0.1, 0.2], "fields": 4, "paths_per_field": 100,
                           "method": "paths"}, "optical_depth", (0.5, 1)),
                ("solve", {**cylinders, "view_angles": [0.1, 0.2]}, "radius", (0.1, 0.2))):
            with self.subTest(of=of, keys=keys):
                self.call("sweep", of=of, vary=f"{vary}={values[0]},{values[1]}", threads=2, **keys, out="sweep.h5")
                swept = datasets(self.folder / "sweep.h5")
                for number, value in enumerate(values):
                    self.call(of, **{**keys, vary: value, "out": "one.h5"})
                    one = datasets(self.folder / "one.h5", ("wall_s", "cpu_s", "state", "trace"))
                    self.assertTrue(one)
                    for name, expected in one.items():
                        found = swept[name] if name not in swept or swept[name].shape == expected.shape else swept[name][number]
                        np.testing.assert_array_equal(found, expected, f"{of} {name}")
                for path in ("sweep.h5", "one.h5"):
                    (self.folder / path).unlink()

    def test_axes(self):
        self.whole(GRID, "sweep.h5")
        with h5py.File(self.folder / "sweep.h5") as file:
            self.assertEqual([axis[0].name for axis in file["image"].dims],
                             ["/amplitude", "/mu_s", "/row", "/column"])
            self.assertEqual(file["sound_wavenumber" if "sound_wavenumber" in file else "mu_s"]
                             .attrs["units"], "1/length")
            self.assertEqual(list(file.attrs["swept"]), ["amplitude", "mu_s"])
            self.assertEqual(file.attrs["of"], "render")
            self.assertEqual(file.attrs["complete"], 1)

    def test_ranges(self):
        vary = ["amplitude=1e-4:1e-2:3:log"]
        self.call("sweep", **{**GRID, "vary": vary, "samples": 64}, out="log.h5")
        np.testing.assert_allclose(datasets(self.folder / "log.h5")["amplitude"], [1e-4, 1e-3, 1e-2])

    def test_table_and_components(self):
        self.write("points.csv", "amplitude,sensor_size.0,sensor_size.1\n0,1,2\n0.002,0.5,0.5\n")
        table = {**GRID, "vary": None, "points": "points.csv"}
        self.call("sweep", **table, out="list.h5")
        swept = datasets(self.folder / "list.h5")
        np.testing.assert_array_equal(swept["sensor_size_1"], [2, 0.5])
        for i in range(2):
            point = {**GUIDE, "amplitude": swept["amplitude"][i],
                     "sensor_size": [swept["sensor_size_0"][i], swept["sensor_size_1"][i]]}
            self.call("render", **point, out="one.h5")
            self.assertEqual(datasets(self.folder / "one.h5")["total"], swept["total"][i])
        self.call("sweep", **{**GRID, "vary": ["sensor_size.all=0.5,1"]}, amplitude=0.002, out="all.h5")
        self.assertEqual(datasets(self.folder / "all.h5")["total"][0], swept["total"][1])

    def test_scales_that_differ(self):
        """Pixel positions depend on the size of the sensor, so these axes are plain indices."""
        keys = {**GRID, "vary": ["sensor_size.0=1,2"], "amplitude": 0.001, "pixels": [2, 1]}
        self.call("sweep", **keys, out="sweep.h5")
        swept = datasets(self.folder / "sweep.h5")
        np.testing.assert_array_equal(swept["column"], [0, 1])
        np.testing.assert_array_equal(swept["column_of_point"], [[-0.25, 0.25], [-0.5, 0.5]])
        np.testing.assert_array_equal(swept["row"], [0])

    def test_placements(self):
        """A swept key and a group of the results have the same name."""
        for name, z in ("a.csv", 1), ("b.csv", 1.1):
            self.write(name, f"x,z\n1,{z}\n2,3\n")
        keys = {"of": "solve", "scatterer": "point", "phase_shift": 0.9, "light_angles": 0, "view_angles": [0.1, 0.2], "threads": 1}
        self.call("sweep", **keys, vary="placement=a.csv,b.csv", out="both.h5")
        both = datasets(self.folder / "both.h5")
        self.assertEqual(list(both["swept_placement_word"]), [b"a.csv", b"b.csv"])
        np.testing.assert_array_equal(both["placement/z"], [[1, 3], [1.1, 3]])

    def test_words(self):
        keys = {**GRID, "vary": ["method=light,path"], "amplitude": 0.001, "method": None}
        told = self.call("sweep", **keys, out="sweep.h5").stderr
        self.assertRegex(told, r"note: left out, .*: .*\benergy/emitted\b")
        with h5py.File(self.folder / "sweep.h5") as file:
            self.assertEqual(list(file["method_word"].asstr()), ["light", "path"])
            self.assertIn("energy/emitted", file.attrs["left_out"])  # only of light paths
            self.assertEqual(file["total"].shape, (2,))
        self.call("sweep", **{**keys, "vary": ["method=light,path", "g=0,0.5"]}, out="part.h5", shard="0/2")
        self.call("merge", out="part.h5", partial=True, status=3)
        with h5py.File(self.folder / "part.h5") as file:
            self.assertEqual(sorted(zip(file["method_word"].asstr(), file["g"])), [("light", 0), ("path", 0)])

    def test_threads(self):
        self.call("sweep", **{**GRID, "threads": 1}, out="one.h5")
        self.whole(GRID, "two.h5")
        self.assert_same("one.h5", "two.h5")

    def test_interruption(self):
        self.whole(SLOW)
        self.interrupted(**SLOW, out="sweep.h5")
        self.call("sweep", **SLOW, out="sweep.h5", resume=True)
        self.assert_same("sweep.h5", "whole.h5")
        self.assertFalse(self.points().exists())

    def test_what_is_made_at_once_is_interrupted(self):
        """An interrupt at any moment, also between the two batches of a point, keeps all results."""
        rays = {"of": "trace", "field": "parabolic", "index": 1.5, "connect": [0, 0, 0, 0.3, 0, 3], "max_length": 5,
                "trials": 200, "vary": ["alpha=0.4:0.6:20"], "threads": 1}
        self.whole(rays)
        moments = random.Random(1)
        for _ in range(20 if WHOLE else 6):
            process = self.start("sweep", **rays, out="sweep.h5")
            self.wait_until_it_catches(process)
            time.sleep(moments.uniform(0, 0.1))
            process.send_signal(signal.SIGINT)
            status = process.wait(timeout=60)
            self.assertIn(status, (0, 75))
            if status == 75:
                self.call("sweep", "--resume", **rays, out="sweep.h5")
            self.assert_same("sweep.h5", "whole.h5")
            self.assertFalse(self.points().exists())

    def test_points_of_a_result_that_has_points(self):
        """Covers points of an image's object and points in a part of a sweep."""
        image = {"of": "image", "domain": "box", "width": 100, "depth": 10, "scatterer": "hg", "g": 0.8,
                 "object_x": [0, 15, 40], "object_depth": -2000, "camera": [-0.3, 0.3], "pixels": 128,
                 "prediction_paths": 200, "paths_per_field": 200, "repeats": 1}
        self.call("sweep", **image, vary="optical_depth=1,2,3,4", shard="0/2", out="part.h5")
        self.call("merge", partial=True, out="part.h5", status=3)
        found = datasets(self.folder / "part.h5")
        np.testing.assert_array_equal(found["swept_point"], [0, 1])
        np.testing.assert_array_equal(found["point"], [0, 1, 2])
        self.assertEqual(found["contrast"].shape, (2, 1))
        self.assertEqual(found["optical_depth"].shape, (2,))

    def test_a_damaged_result_is_no_end(self):
        """A complete sweep with one changed byte is rejected by --resume, or made again."""
        self.whole(GRID, "sweep.h5")
        data = bytearray((self.folder / "sweep.h5").read_bytes())
        data[len(data) // 2] ^= 1
        (self.folder / "sweep.h5").write_bytes(data)
        self.check("damaged", out="sweep.h5", resume=True)
        self.call("sweep", **GRID, out="sweep.h5", shard="0/1")
        self.call("sweep", **GRID, out="sweep.h5", resume=True)
        self.whole(GRID)
        self.assert_same("sweep.h5", "whole.h5")

    def test_shares_and_merge(self):
        self.whole(MANY)
        for i in range(3):
            self.call("sweep", **MANY, out="sweep.h5", shard=f"{i}/3")
            if i < 2:
                self.assertIn("missing", self.call("merge", out="sweep.h5", status=2).stderr)
        self.call("merge", out="sweep.h5")
        self.assert_same("sweep.h5", "whole.h5")

    def test_part_as_a_list(self):
        self.whole(MANY)
        self.call("sweep", **MANY, out="sweep.h5", shard="1/3")
        self.call("merge", out="sweep.h5", partial=True, status=3)
        part, whole = (datasets(self.folder / path) for path in ("sweep.h5", "whole.h5"))
        self.assertEqual(len(part["point"]), 10)
        for i in range(10):
            at = (int(np.flatnonzero(whole["amplitude"] == part["amplitude"][i])[0]),
                  int(np.flatnonzero(whole["g"] == part["g"][i])[0]))
            self.assertEqual(part["total"][i], whole["total"][at])

    def test_finished_points_are_known(self):
        """Finished points are recognised by their names alone."""
        self.write("points.csv", "amplitude,sensor_size.0\n0.002,2\n0,1\n0.002,1\n")
        for points in ({"vary": ["amplitude=1e-4:1e-2:4:log", "method=path,light"], "method": None},
                       {"vary": ["sensor_size.0=2:1:3", "g=0.5,0:0.3:4"], "amplitude": 0.001}, {"vary": None, "points": "points.csv"}):
            with self.subTest(points=points):
                keys = {**GRID, "samples": 64, **points, "out": "sweep.h5", "shard": "0/1"}
                self.call("sweep", **keys)
                before = self.shards()
                self.call("sweep", **keys, resume=True)
                self.assertEqual(self.shards(), before)
                shutil.rmtree(self.points())

    @unittest.skipIf(SLOWNESS > 1, "a sanitizer keeps what was freed")
    def test_memory(self):
        """Memory does not grow with the number of points, whose values take 440 bytes each."""
        few, many = 4000, 16000
        rays = {"of": "trace", "field": "ultrasound", "index": 1.33, "sound_wavenumber": 3.5, "light": "line",
                "ray_count": 2, "beam_radius": 0.25, "stop_plane": [0, 0, 0.1, 0, 0, 1], "max_length": 1, "step": 0.05,
                "threads": 1}
        peaks = [self.peak_memory("sweep", **rays, vary=f"amplitude=1e-3:2e-3:{points}", out=f"{points}.h5")
                 for points in (few, many)]
        self.assertLess(peaks[1] - peaks[0], 440 * (many - few) / 2)
        amplitudes = datasets(self.folder / f"{many}.h5")["amplitude"]
        np.testing.assert_allclose(amplitudes, np.linspace(1e-3, 2e-3, many), rtol=1e-15)

    def peak_memory(self, *words, **keys):
        """Returns bytes, measured as the child of a small process, whose memory counts until the program begins."""
        tell = ("import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, capture_output=True); "
                "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)")
        done = subprocess.run([sys.executable, "-S", "-c", tell, PROGRAM, *words, *flags(keys)], cwd=self.folder,
                              capture_output=True, text=True, check=True)
        return int(done.stdout) * 1024

    def test_config_makes_it_again(self):
        self.whole(GRID, "sweep.h5")
        with h5py.File(self.folder / "sweep.h5") as file:
            self.write("again.toml", file.attrs["config"])
        self.call("sweep", config="again.toml", out="again.h5")
        self.assert_same("again.h5", "sweep.h5")

    def check(self, *words, status=2, **changes):
        keys = {**GRID, "out": "sweep.h5", **changes}
        before = self.listing()
        done = self.call("sweep", **keys, status=status)
        self.assert_one_line(done.stderr, *words)
        self.assertEqual(self.listing(), before)

    def test_refused(self):
        self.check("of = place", "render", of="place")
        self.check("vary is not given", vary=None)
        for text, *words in (
                ["amplitude", "key=values"], ["=1,2", "key=values"], ["colour=1,2", "colour is not a key"],
                ["amplitude=", "number"], ["amplitude=1,x", "number"], ["amplitude=1,,2", "number"],
                ["method=", "at least one value"], ["method=light,fast", "method = fast"],
                ["amplitude=1:2", "first:last:count"], ["amplitude=1:2:3:lin", "first:last:count"],
                ["amplitude=0:1:3:log", "first:last"], ["amplitude=0:1:1", "2 to 1000000"],
                ["amplitude=0:1:1e9", "2 to 1000000"], ["amplitude=0:inf:3", "first:last"],
                ["amplitude=0.1,0.10", "twice"], ["samples=10,20", "does not change the result"],
                ["out=1,2", "does not change the result"], ["density=1,2", "file"],
                ["sensor_size=1,2", "2 numbers"], ["sensor_size.2=1,2", "below 2"],
                ["sensor_size.x=1,2", ".all"], ["mu_s=-1,1", "mu_s = -1"],
                ["alpha=1,2", "alpha = 2", "parabolic"]):
            with self.subTest(text=text):
                self.check(*words, vary=[text], amplitude=None if "amplitude" in text else 0.001)
        self.check("varied twice", vary=["g=0,0.5", "g=0.1,0.2"])
        self.check("at most 1000000", vary=["g=0:0.9:2000", "amplitude=0:0.1:2000"])
        self.check("alpha = 2", alpha=2)
        self.check("sensor_colour", "unknown key", sensor_colour=2)
        self.check("point sensor_at.2=20", "stage", vary=["sensor_at.2=10,20"], amplitude=0)
        self.check("shard = 3/3", shard="3/3")
        self.check("vary = ", "sweeps of another subcommand", of=None, **dict.fromkeys(
            key for key in GUIDE if key not in ("g", "samples")), depth=10, optical_depth=1, tilts=[0, 0.1])

    def test_a_point_without_a_result_is_named(self):
        """Some rays end within a lens or before it."""
        lens = {"of": "trace", "field": "homogeneous", "lens": [0, 0, 0, 12.5, 60, 0, 5, 1.5168, 0, 0, 0], "light": "disk",
                "ray_count": 20, "origin": [0, 0, -20], "beam_radius": 5, "stop_plane": [0, 0, 50, 0, 0, 1],
                "image_plane": [0, 0, 100, 0, 0, 1], "vary": ["max_length=19,20.1"], "out": "lens.h5"}
        failed = self.call("sweep", **lens, status=2)
        self.assert_one_line(failed.stderr, "point max_length=20.1", "different indices")

    def test_refused_tables(self):
        for text, *words in (["amplitude\n", "row"], ["colour\n1\n", "colour"],
                             ["amplitude\n0\n0.0\n", "twice"], ["method\n1\n", "key with numbers"]):
            self.write("points.csv", text)
            self.check(*words, vary=None, points="points.csv")
            self.check("give only one", points="points.csv")

    def test_refuses_what_is_of_another_sweep(self):
        self.call("sweep", **GRID, out="sweep.h5", shard="0/1")
        before = self.shards()
        self.check("earlier sweep", "--resume", out="sweep.h5", shard="0/1")
        self.check("another sweep", "g = 0.8", out="sweep.h5", g=0.5, resume=True)
        self.assertEqual({name: data for name, data in self.shards().items()}, before)
        self.call("sweep", **GRID, out="done.h5")
        self.check("another run", out="done.h5", mu_a=0.1, resume=True)


if __name__ == "__main__":
    unittest.main()
