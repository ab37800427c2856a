"""Bad input of `sweep` and `merge`: one line, status 2, nothing written."""

import unittest

from sweeps import SWEEP, SweepTest


class BadInput(SweepTest):
    def check(self, *words, **changes):
        keys = {**SWEEP, "out": "sweep.h5", **changes}
        before = self.listing()
        done = self.call("sweep", **keys, status=2)
        self.assert_one_line(done.stderr, *words)
        self.assertEqual(self.listing(), before)
        self.assertFalse(self.points().exists())

    def test_shard(self):
        for text in ("3/3", "1", "1/", "/3", "-1/3", "+1/3", "1/-3", "0/0", "1/3/5", "1 /3", "a/b",
                     "0.5/3", "0x1/3", "1/3 ", "0/99999999999999999999999"):
            self.check(f"shard = {text}", "i/n", shard=text)

    def test_shard_of_absurdly_many(self):
        self.call("sweep", **SWEEP, shard=f"5/{2**64 - 1}", out="sweep.h5")
        self.assertEqual(list(self.finished()), list(self.finished())[:1])

    def test_method(self):
        self.check("method = exact", "mc wave transport both auto", method="exact")
        self.check("slab", "box", method="wave")
        self.check("height is not given", domain="box", width=50, method="mc", dimension=3)

    def check_points(self, text, *words, **changes):
        self.write("points.csv", text)
        without = {key: None for key in ("optical_depth", "g", "albedo")}
        self.check(*words, **{**without, "points": "points.csv", **changes})

    def test_points(self):
        two = "optical_depth,g\n1,0\n2,0.5\n"
        self.check_points("optical_depth,colour\n1,2\n", "points.csv", "colour", "optical_depth")
        self.check_points("optical_depth,index_imaginary\n1,2\n", "index_imaginary", "index")
        self.check_points("optical_depth,depth\n1,2\n", "points.csv", "column depth")
        self.check_points("optical_depth,g\n1,0\n2,0.5\n1,0\n", "optical_depth=1_g=0", "twice")
        self.check_points("optical_depth,g\n1,0\n1.0,0e3\n", "optical_depth=1_g=0", "twice")
        self.check_points(two, "g = 0.5", "column", "both", g=0.5)
        self.check_points(two, "albedo = 0.9", "one value", albedo=[1, 0.9])
        self.check_points("optical_depth,g\n", "points.csv", "row")
        self.check_points("", "points.csv", "empty")
        self.check_points("optical_depth,g\n1\n", "points.csv", "line 2")
        self.check_points("optical_depth,g\n1,x\n", "points.csv", "line 2", "g")
        self.check_points("optical_depth,g\n1,0\n1,nan\n", "points.csv", "line 3", "finite")
        self.check_points("optical_depth,g\n1,0\n1,1\n", "points.csv, row 2", "g = 1")
        self.check_points("optical_depth,g\n1,0\n-1,0\n", "optical_depth = -1")
        self.check("none.csv", points="none.csv", optical_depth=None, g=None, albedo=None)

    def test_points_given_twice_on_a_grid(self):
        self.check("g=0.5", "twice", g=[0.5, 0, 0.5])
        disks = {"scatterer": "tm", "g": None, "albedo": None, "optical_depth": None,
                 "density": 0.1, "radius": 0.1}
        self.check("index=", "twice", **disks, index=["1.5", "1.50"])
        self.check("index=", "twice", **disks, index=["1.5+0.1i", "1.5+0.10i"])

    def test_a_point_that_makes_no_scene(self):
        """It is rejected before any other point begins."""
        disks = {"scatterer": "tm", "g": None, "albedo": None, "optical_depth": None}
        self.check("radius = -0.1", **disks, density=0.1, radius=[0.1, -0.1])
        self.check("index", "1.5+", **disks, density=0.1, radius=0.1, index=["1.5", "1.5+"])
        self.check("packing fraction", **disks, density=[0.1, 30], radius=0.1)
        self.check("does not scatter", **disks, density=0.1, radius=0.1, index=["1.5", "1"])

    def test_stops(self):
        self.check("samples = 0", samples=0)
        self.check("seconds = -1", seconds=-1)
        self.check("wave_samples = 0", domain="box", width=10, scatterer="point", g=None,
                   albedo=None, method="both", wave_samples=0)

    def test_views_on_both_sides(self):
        self.check("view_angles", "transmission", "reflection", view_angles=[0, 3])
        self.call("sweep", **SWEEP, view_angles=[2.9, 3], out="one_side.h5")

    def test_a_target_in_percent(self):
        self.check("target_error = 2", "(0, 1)", target_error=2)

    def test_merge(self):
        (self.folder / "empty").mkdir()
        (self.folder / "strange").mkdir()
        (self.folder / "strange" / "mc_g=0.h5").write_bytes(b"no HDF5")
        for keys, word in (({"out": None}, "out"), ({}, "m.h5.shards"),
                           ({"shards": "none"}, "none"), ({"shards": "empty"}, "empty"),
                           ({"shards": ["empty", "none"]}, "none"),
                           ({"shards": "strange"}, "strange"), ({"out": "no/m.h5"}, "no/m.h5"),
                           ({"seed": 2}, "seed")):
            done = self.call("merge", **{"out": "m.h5", **keys}, status=2)
            self.assert_one_line(done.stderr, word)
        self.assertEqual(self.listing(), {})


if __name__ == "__main__":
    unittest.main()
