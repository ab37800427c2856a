"""Sweeps give the same numbers in one process, in shares and from a list."""

import time
import unittest

import h5py
import numpy as np

import journals
from program import DATA, SLAB, WHOLE, attributes, datasets
from sweeps import MANY, NEVER, SLOW, SWEEP, SweepTest, is_complete, names_of

BOTH = {"domain": "box", "width": 10, "depth": 10, "scatterer": "point", "density": [0.2, 0.4],
        "tilts": [0, 0.1], "method": "both", "samples": 6000, "wave_samples": 30, "threads": 2}
DISKS = {"domain": "box", "width": 10, "depth": 10, "scatterer": "tm", "tilts": [0, 0.1],
         "samples": 3000, "threads": 2}


def csv(keys, rows):
    return "".join(",".join(map(str, row)) + "\n" for row in (keys, *rows))


class Shares(SweepTest):
    def test_threads(self):
        for keys in (SWEEP, {**SWEEP, "samples": None, "target_error": 0.05}):
            for threads in (1, 4):
                self.call("sweep", **{**keys, "threads": threads}, out=f"{threads}.h5")
            self.assert_same_data("1.h5", "4.h5")

    def test_one_after_the_other(self):
        self.whole(SWEEP)
        for number in range(3):
            self.assertEqual(len(self.finished()), (0, 3, 6)[number])
            done = self.call("sweep", **SWEEP, shard=f"{number}/3", out="sweep.h5")
            self.assertFalse((self.folder / "sweep.h5").exists())
        self.assertIn("8 of 8", done.stdout)
        self.assertEqual(set(self.finished()), set(names_of(SWEEP)))
        self.call("merge", out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")
        self.check_attributes("sweep.h5", "whole.h5")

    def check_attributes(self, merged, whole):
        merged, whole = attributes(self.folder / merged), attributes(self.folder / whole)
        for key in ("identity", "seed", "samples", "plan", "complete", "converged", "version"):
            self.assertEqual(merged[key], whole[key], key)
        self.assertIn("merge", merged["command_line"])

    def test_began_when_the_first_share_did(self):
        self.call("sweep", **SWEEP, shard="1/2", out="sweep.h5")
        self.call("merge", "--partial", out="part.h5", shards="sweep.h5.shards", status=3)
        time.sleep(1.1)
        self.call("sweep", **SWEEP, shard="0/2", out="sweep.h5")
        self.call("merge", out="sweep.h5")
        part, whole = (attributes(self.folder / path)["started"] for path in ("part.h5", "sweep.h5"))
        self.assertEqual(part, whole)

    def test_at_the_same_time(self):
        self.whole(MANY)
        for out in (["sweep.h5"] * 3, ["a.h5", "b.h5", "c.h5"])[:2 if WHOLE else 1]:
            shares = [self.start("sweep", **MANY, shard=f"{number}/3", out=name)
                      for number, name in enumerate(out)]
            for share in shares:
                self.assertEqual(share.wait(timeout=60), 0, share.stderr.read())
            self.call("merge", shards=[f"{name}.shards" for name in sorted(set(out))],
                      out="merged.h5")
            self.assert_same_data("merged.h5", "whole.h5")

    def test_more_shares_than_points(self):
        self.call("sweep", **SWEEP, shard="9/10", out="sweep.h5")
        self.assertEqual(self.finished(), {})

    def test_shares_of_several_numbers(self):
        """Each point belongs to exactly one share."""
        for count in (1, 3, 8):
            names = []
            for number in range(count):
                out = f"{count}-{number}.h5"
                self.call("sweep", **{**SWEEP, "samples": 100}, shard=f"{number}/{count}", out=out)
                names += self.finished(out)
            self.assertEqual(sorted(names), sorted(names_of(SWEEP)))

    def test_whole_after_shares(self):
        """No merge is needed: the sweep itself uses the finished points."""
        self.whole(SWEEP)
        self.call("sweep", **SWEEP, shard="1/3", out="sweep.h5")
        self.call("sweep", "--resume", **SWEEP, out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")
        self.assertFalse(self.points().exists())

    def test_overlapping_folders(self):
        self.whole(SWEEP)
        self.call("sweep", **SWEEP, shard="0/1", out="a.h5")
        self.call("sweep", **SWEEP, shard="1/2", out="b.h5")
        self.call("merge", shards=["b.h5.shards", "a.h5.shards"], out="merged.h5")
        self.assert_same_data("merged.h5", "whole.h5")


class Lists(SweepTest):
    ROWS = [[2, 0.5, 0.9], [1, 0, 0.9], [2, 0, 1]]

    def listed(self, **changes):
        axes = {"optical_depth": None, "g": None, "albedo": None}
        return {**SWEEP, **axes, "points": "points.csv", **changes}

    def test_gives_the_numbers_of_the_grid(self):
        self.whole(SWEEP)
        self.write("points.csv", csv(["g", "albedo", "optical_depth"],
                                     [[g, albedo, depth] for depth, g, albedo in self.ROWS]))
        self.call("sweep", **self.listed(), out="list.h5")
        with h5py.File(self.folder / "list.h5") as file:
            rows = np.column_stack([file[key][()] for key in ("optical_depth", "g", "albedo")])
            np.testing.assert_array_equal(rows, self.ROWS)
            self.assertEqual(file["field_correlation"].dims[0][0].name, "/point")
        self.assert_points_equal("list.h5", "whole.h5")

    def test_one_value_beside_the_table(self):
        self.whole(SWEEP)
        self.write("points.csv", csv(["g", "optical_depth"], [[0.5, 2], [0, 1]]))
        self.call("sweep", **self.listed(albedo=0.9), out="list.h5")
        self.assert_points_equal("list.h5", "whole.h5")

    def test_goes_on_with_points_of_a_grid(self):
        """A list uses equal points of a grid."""
        self.call("sweep", **SWEEP, shard="0/1", out="sweep.h5")
        self.write("points.csv", csv(["optical_depth", "g", "albedo"], self.ROWS))
        before = self.finished()
        self.call("sweep", **self.listed(), shard="0/1", resume=True, out="sweep.h5")
        self.assertEqual(self.finished(), before)

    def test_in_shares(self):
        self.write("points.csv", csv(["optical_depth", "g", "albedo"], self.ROWS))
        self.call("sweep", **self.listed(), out="whole.h5")
        for number in (1, 0):
            self.call("sweep", **self.listed(), shard=f"{number}/2", out="sweep.h5")
        self.call("merge", out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_complex_index(self):
        self.write("points.csv", csv(["index", "index_imaginary", "radius", "density"],
                                     [[1.5, 0.1, 0.1, 0.3], [1.2, 0, 0.16, 0.2]]))
        self.call("sweep", **DISKS, points="points.csv", out="list.h5")
        list_ = datasets(self.folder / "list.h5")
        for name, values in (("index", [1.5, 1.2]), ("index_imaginary", [0.1, 0]),
                             ("radius", [0.1, 0.16]), ("density", [0.3, 0.2])):
            np.testing.assert_array_equal(list_[name], values)
        for i, (index, radius, density) in enumerate((("1.5+0.1i", 0.1, 0.3), ("1.2", 0.16, 0.2))):
            self.call("covariance", **DISKS, covariance="memory_effect", index=index,
                      radius=radius, density=density, out="point.h5")
            point = datasets(self.folder / "point.h5")
            np.testing.assert_array_equal(list_["field_correlation"][i],
                                          point["field_correlation"])

    def test_another_table_under_the_same_name(self):
        """A result of other points is not taken for the requested one."""
        self.write("points.csv", csv(["optical_depth", "g", "albedo"], self.ROWS))
        self.call("sweep", **self.listed(), out="sweep.h5")
        self.write("points.csv", csv(["optical_depth", "g", "albedo"], self.ROWS[:2]))
        self.call("sweep", **self.listed(), resume=True, out="sweep.h5", status=2)


class Axes(SweepTest):
    def check_axis(self, key, values, **keys):
        """Checks that each point of an axis equals covariance of that scene."""
        self.call("sweep", **keys, **{key: values}, out="sweep.h5")
        sweep = datasets(self.folder / "sweep.h5")
        for i, value in enumerate(values):
            self.call("covariance", **{"covariance": "memory_effect", **keys, key: value},
                      out="point.h5")
            point = datasets(self.folder / "point.h5")
            for name in ("field_correlation", "field_correlation_error"):
                at = sweep[name].reshape(len(values), -1)[i]
                np.testing.assert_array_equal(at, point[name], f"{key} = {value}")
        return sweep

    def test_radius(self):
        sweep = self.check_axis("radius", [0.1, 0.2], **DISKS, index="1.4", density=0.3)
        np.testing.assert_array_equal(sweep["radius"], [0.1, 0.2])

    def test_density(self):
        sweep = self.check_axis("density", [0.1, 0.3], **{**DISKS, "scatterer": "point"})
        np.testing.assert_array_equal(sweep["density"], [0.1, 0.3])

    def test_index(self):
        sweep = self.check_axis("index", ["1.3", "1.5+0.01i"], **DISKS, radius=0.1, density=0.3)
        np.testing.assert_array_equal(sweep["index"], [1.3, 1.5])
        np.testing.assert_array_equal(sweep["index_imaginary"].ravel(), [0, 0.01])

    def test_many_axes(self):
        self.call("sweep", **DISKS, radius=[0.1, 0.2], index=["1.3", "1.5"],
                  density=[0.1, 0.2, 0.3], out="sweep.h5")
        with h5py.File(self.folder / "sweep.h5") as file:
            curves = file["field_correlation"]
            scales = [axis[0].name for axis in curves.dims if len(axis)]
            self.assertEqual(scales[:3], ["/density", "/radius", "/index"])
            self.assertEqual(curves.shape[:3], (3, 2, 2))
            self.assertEqual(curves.size, 3 * 2 * 2 * 2)


class BothMethods(SweepTest):
    def test_the_same_as_each_alone(self):
        self.call("sweep", **BOTH, out="both.h5")
        both = datasets(self.folder / "both.h5")
        for method in ("mc", "wave"):
            self.call("sweep", **{**BOTH, "method": method}, out="one.h5")
            one = datasets(self.folder / "one.h5")
            for name in ("field_correlation", "field_correlation_error", "samples",
                         "memory_effect_range", "trace/relative_error", "trace/of_point"):
                np.testing.assert_array_equal(both[f"{method}/{name}"], one[name])
        error = np.hypot(*(both[f"{method}/field_correlation_error"] for method in ("mc", "wave")))
        difference = both["mc/field_correlation"] - both["wave/field_correlation"]
        np.testing.assert_allclose(both["deviation"][..., 1], difference[..., 1] / error[..., 1])
        np.testing.assert_array_equal(both["deviation"][..., 0], 0)

    def test_in_shares(self):
        self.call("sweep", **BOTH, out="whole.h5")
        for number in range(3):
            self.call("sweep", **BOTH, shard=f"{number}/3", out="sweep.h5")
        self.assertEqual(len(self.finished()), 4)
        self.call("merge", out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_a_point_with_one_method_missing(self):
        """Such a point counts as missing, by the name of the method."""
        self.call("sweep", **BOTH, shard="0/1", out="sweep.h5")
        journals.drop(self.journal(), "wave_density=0.2")
        done = self.call("merge", out="sweep.h5", status=2)
        self.assert_one_line(done.stderr, "1 of 4", "wave_density=0.2")
        self.call("merge", "--partial", out="sweep.h5", status=3)
        self.assertEqual(list(datasets(self.folder / "sweep.h5")["density"]), [0.4])
        journals.drop(self.journal(), "mc_density=0.4")
        (self.folder / "sweep.h5").unlink()
        done = self.call("merge", "--partial", out="sweep.h5", status=2)
        self.assert_one_line(done.stderr, "every method")


class Stops(SweepTest):
    def test_samples_before_the_target(self):
        keys = {**SWEEP, "target_error": NEVER}
        done = self.call("sweep", **keys, out="sweep.h5", status=3)
        self.assertIn("target error", done.stdout)
        self.assertFalse(self.points().exists())
        root = attributes(self.folder / "sweep.h5")
        self.assertEqual((root["complete"], root["converged"]), (1, 0))
        self.whole(SWEEP)
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_target(self):
        self.call("sweep", **{**SWEEP, "samples": None}, target_error=0.04, out="sweep.h5")
        sweep = datasets(self.folder / "sweep.h5")
        self.assertTrue((sweep["relative_error"] <= 0.04).all())
        self.assertEqual(attributes(self.folder / "sweep.h5")["converged"], 1)
        for i in range(8):
            errors = sweep["trace/relative_error"][sweep["trace/of_point"] == i]
            self.assertEqual(errors[-1], sweep["relative_error"].ravel()[i])

    def test_target_missed_in_a_share(self):
        """Each share is complete; the merged result reports the missed target."""
        keys = {**SWEEP, "target_error": NEVER}
        for number in (0, 1):
            self.call("sweep", **keys, shard=f"{number}/2", out="sweep.h5")
        self.call("merge", out="sweep.h5", status=3)
        self.assertTrue(is_complete(self.folder / "sweep.h5"))

    def test_seconds(self):
        self.whole(SLOW)
        done = self.call("sweep", **SLOW, seconds=0.1, out="sweep.h5", status=3)
        self.assertIn("--resume", done.stdout)
        self.assertTrue(self.unfinished())
        partial = 0
        deadline = time.monotonic() + 60
        while self.points().exists():
            self.assertLess(time.monotonic(), deadline)
            if (self.folder / "sweep.h5").exists():
                self.assertFalse(is_complete(self.folder / "sweep.h5"))
                self.assert_points_equal("sweep.h5", "whole.h5")
                partial += 1
            process = self.start("sweep", "--resume", **SLOW, seconds=0.1, out="sweep.h5")
            self.assertIn(process.wait(timeout=60), (0, 3))
        self.assertGreater(partial, 0)
        self.assertTrue(is_complete(self.folder / "sweep.h5"))
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_seconds_that_are_too_short_for_a_point(self):
        keys = {**SLOW, "samples": 10_000_000}
        self.call("sweep", **keys, seconds=0.01, out="sweep.h5", status=3)
        self.assertFalse((self.folder / "sweep.h5").exists())
        self.assertTrue(self.unfinished())

    def test_seconds_of_a_share(self):
        self.whole(SLOW)
        self.call("sweep", **SLOW, shard="0/2", seconds=0.05, out="sweep.h5", status=3)
        self.assertFalse((self.folder / "sweep.h5").exists())
        self.call("sweep", "--resume", **SLOW, out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")


class Resume(SweepTest):
    def test_of_a_complete_one(self):
        self.call("sweep", **SWEEP, out="sweep.h5")
        before = self.listing()
        for changes in ({}, {"threads": 1}, {"seconds": 9}):
            done = self.call("sweep", "--resume", **{**SWEEP, **changes}, out="sweep.h5")
            self.assertIn("complete", done.stdout)
            self.assertEqual(self.listing(), before)

    def test_of_another_one(self):
        self.call("sweep", **SWEEP, out="sweep.h5")
        self.call("covariance", **SLAB, samples=100, out="covariance.h5")
        (self.folder / "text.h5").write_text("not HDF5")
        before = self.listing()
        for changes in ({"seed": 2}, {"g": [0, 0.6]}, {"depth": 101}, {"samples": 4001},
                        {"method": "both"}, {"out": "covariance.h5"}, {"out": "text.h5"}):
            keys = {**SWEEP, "out": "sweep.h5", **changes}
            if "method" in changes:
                keys |= {"domain": "box", "width": 10, "scatterer": "point", "g": None,
                         "albedo": None}
            with self.subTest(changes=changes):
                done = self.call("sweep", "--resume", **keys, status=2)
                self.assert_one_line(done.stderr, keys["out"])
                self.assertEqual(self.listing(), before)
                self.assertFalse(self.points(keys["out"]).exists())

    def test_missing_where_points_lie(self):
        """A sweep without --resume changes nothing there."""
        self.call("sweep", **SWEEP, shard="0/2", out="sweep.h5")
        before = self.shards()
        for changes in ({}, {"shard": "0/2"}, {"seed": 2}):
            done = self.call("sweep", **SWEEP, **changes, out="sweep.h5", status=2)
            self.assert_one_line(done.stderr, "sweep.h5.shards", "--resume")
            self.assertEqual(self.shards(), before)
            self.assertEqual(self.listing(), {})

    def test_missing_where_unfinished_points_lie(self):
        self.interrupted(**{**SLOW, "samples": 5_000_000}, out="sweep.h5")
        before = self.shards()
        self.assertTrue(self.unfinished())
        self.call("sweep", **SLOW, out="sweep.h5", status=2)
        self.assertEqual(self.shards(), before)

    def test_missing_where_a_result_lies(self):
        """The older result is replaced."""
        self.call("sweep", **SWEEP, seed=2, out="sweep.h5")
        self.call("sweep", **SWEEP, out="sweep.h5")
        self.whole(SWEEP)
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_with_more_points(self):
        """A larger grid reuses the finished points."""
        self.call("sweep", **SWEEP, shard="0/1", out="sweep.h5")
        before = self.finished()
        keys = {**SWEEP, "g": [0, 0.3, 0.5]}
        self.call("sweep", **keys, shard="0/1", resume=True, out="sweep.h5")
        self.assertLess(before.items(), self.finished().items())
        self.call("merge", out="merged.h5", shards="sweep.h5.shards")
        self.call("sweep", **keys, out="whole.h5")
        self.assert_same_data("merged.h5", "whole.h5")

    def test_something_else_in_the_place_of_the_folder(self):
        self.write("sweep.h5.shards", "a file")
        done = self.call("sweep", **SWEEP, out="sweep.h5", status=4)
        self.assert_one_line(done.stderr, "sweep.h5.shards")
        self.assertEqual((self.folder / "sweep.h5.shards").read_text(), "a file")


class Ranges(SweepTest):
    def test_as_angles_and_on_how_many_tilts(self):
        keys = {**SWEEP, "light_angles": 0.3, "view_angles": 0.2, "tilts": [0, 0.001, 0.002, 0.02]}
        done = self.call("sweep", **keys, out="sweep.h5")
        with h5py.File(self.folder / "sweep.h5") as file:
            read = file["range_censored"][()] == 0
            self.assertTrue(read.any())
            turned = np.arcsin(np.sin(0.3) + file["memory_effect_range"][()] /
                               (2 * np.pi * keys["depth"]))
            np.testing.assert_allclose(file["memory_effect_angle"][()], turned - 0.3, rtol=1e-9)
            np.testing.assert_allclose(
                file["memory_effect_angle_error"][()],
                file["memory_effect_range_error"][()] / (2 * np.pi * keys["depth"]) /
                np.cos(turned), rtol=1e-9)
            below = file["tilt_q"][()][:, None, None, None] * keys["depth"] < (
                file["memory_effect_range"][()])
            np.testing.assert_array_equal(file["range_steps"][()], below.sum(0) - 1)
            few = int((read & (file["range_steps"][()] < 4)).sum())
        self.assertIn(f"note: {few} of 8 ranges", done.stderr)
        self.assertEqual(done.stdout.count(" *\n"), few)

    def test_a_dense_medium_is_told_of(self):
        done = self.call("sweep", **{**SWEEP, "depth": 1}, out="sweep.h5")
        self.assertIn("mean free path is only 3.14", done.stderr)


class Gallery(unittest.TestCase):
    """The sweep shipped in data/."""

    # q L at C_I = 1/2, optical depth 10: g, albedo, value, error; of an integral equation (g = 0,
    # albedo 1 and 0.99, rounded) and of an independent Monte Carlo program.
    KNOWN = ((0, 1, 1.3688, 3e-5), (0, 0.99, 1.4893, 3e-5), (0, 0.95, 1.833, 0.002),
             (0, 0.9, 2.156, 0.002), (0, 0.8, 2.700, 0.004), (0.5, 1, 1.294, 0.002),
             (0.8, 1, 1.383, 0.003), (0.9, 1, 2.587, 0.009), (0.9, 0.99, 2.825, 0.010),
             (0.95, 1, 7.89, 0.02))

    def setUp(self):
        self.file = h5py.File(DATA / "gallery.h5")
        self.addCleanup(self.file.close)

    def test_every_point_is_there_and_precise(self):
        self.assertEqual(self.file.attrs["complete"], 1)
        self.assertEqual(self.file["relative_error"].size, 448)
        self.assertLessEqual(self.file["relative_error"][()].max(), 1e-4)
        known = self.file["range_censored"][()] == 0
        ranges, errors = (self.file[name][()][known]
                          for name in ("memory_effect_range", "memory_effect_range_error"))
        self.assertLessEqual((errors / ranges).max(), 1e-4)

    def test_known_ranges(self):
        g, albedo = self.file["g"][()], self.file["albedo"][()]
        depth = list(self.file["optical_depth"]).index(10)
        for at_g, at_albedo, known, known_error in self.KNOWN:
            at = depth, list(g).index(at_g), list(albedo).index(at_albedo)
            error = np.hypot(self.file["memory_effect_range_error"][at], known_error)
            self.assertLess(abs(self.file["memory_effect_range"][at] - known), 4 * error, at)


class OtherSweeps(SweepTest):
    def test_points_of_another_sweep_are_told_of(self):
        self.all_points(SWEEP, "one.h5")
        self.all_points({**SWEEP, "g": [0.7]}, "other.h5")
        done = self.call("merge", out="m.h5", shards=["one.h5.shards", "other.h5.shards"])
        self.assertIn("other.h5.shards: 4 points of another sweep", done.stderr)

    def test_a_part_does_not_replace_a_whole(self):
        self.call("sweep", **SWEEP, out="m.h5")
        before = (self.folder / "m.h5").read_bytes()
        self.call("sweep", **SWEEP, shard="0/2", out="m2.h5")
        done = self.call("merge", "--partial", out="m.h5", shards="m2.h5.shards", status=2)
        self.assert_one_line(done.stderr, "complete")
        self.assertEqual((self.folder / "m.h5").read_bytes(), before)


if __name__ == "__main__":
    unittest.main()
