"""place: files that it writes, read back by solve bit for bit, and rejected input."""

import unittest

import numpy as np

from program import ProgramTest, attributes, datasets

DISKS = {"width": 12, "depth": 8, "radii": 0.4, "packing_fraction": 0.4}
MIXED = {"width": 12, "depth": 8, "radii": [0.3, 0.6], "fractions": [3, 1], "count": 60}


class PlaceTest(ProgramTest):
    def place(self, out="placed.csv", **keys):
        """Returns the columns of the file that is written."""
        self.call("place", out=out, **keys)
        lines = [line for line in (self.folder / out).read_text().splitlines() if line[0] != "#"]
        self.assertEqual(np.genfromtxt(self.folder / out, delimiter=",", names=True).dtype.names, tuple(lines[0].split(",")))
        rows = np.array([[float(field) for field in line.split(",")] for line in lines[1:]])
        return dict(zip(lines[0].split(","), rows.T))

    def gaps(self, placed):
        x, z, radius = (placed[name] for name in ("x", "z", "radius"))
        gaps = np.hypot(x[:, None] - x, z[:, None] - z) - radius[:, None] - radius
        return gaps[np.triu_indices(len(x), 1)]


class Written(PlaceTest):
    def test_disks(self):
        for rule in ("hard_disk", "equilibrium"):
            placed = self.place(**DISKS, placement=rule, min_gap=0.01)
            self.assertEqual(list(placed), ["x", "z", "radius"])
            self.assertEqual(len(placed["x"]), 76)  # 0.4 x 96 / (pi 0.16) = 76.4
            self.assertGreaterEqual(self.gaps(placed).min(), 0.01)
            self.assertLessEqual(np.abs(placed["x"]).max(), 6)
            self.assertTrue(0 <= placed["z"].min() and placed["z"].max() <= 8)

    def test_the_smallest_gap_is_told(self):
        keys = {**DISKS, "placement": "equilibrium", "min_gap": 0.01}
        told = self.call("place", **keys, out="gap.csv").stdout.split("smallest gap ")[1]
        self.assertAlmostEqual(float(told.split(",")[0]), self.gaps(self.place(**keys)).min(), places=6)

    def test_gap_when_none_is_stated(self):
        placed = self.place(**{**DISKS, "packing_fraction": 0.65}, placement="equilibrium")
        self.assertGreaterEqual(self.gaps(placed).min(), 0.4e-3)

    def test_mixed_radii(self):
        for rule in ("hard_disk", "equilibrium"):
            placed = self.place(**MIXED, placement=rule)
            sizes, numbers = np.unique(placed["radius"], return_counts=True)
            self.assertEqual([*sizes, *numbers], [0.3, 0.6, 45, 15])
            self.assertGreater(self.gaps(placed).min(), 0)

    def test_points(self):
        placed = self.place(width=5, depth=4, count=17)
        self.assertEqual(list(placed), ["x", "z"])
        self.assertEqual(len(placed["x"]), 17)

    def test_says_how_it_was_made(self):
        self.place(**DISKS, placement="equilibrium", seed=3)
        head = (self.folder / "placed.csv").read_text().splitlines()[1:3]
        for word in ("# flatspeckle", "--seed 3", "--packing_fraction 0.4", "# equilibrium: 76",
                     "packing fraction 0.397", "min_gap 4e-04"):
            self.assertIn(word, "\n".join(head))

    def test_seed(self):
        for rule in ("hard_disk", "equilibrium"):
            a, b, c = (self.place(**DISKS, placement=rule, seed=seed)["x"] for seed in (1, 1, 2))
            np.testing.assert_array_equal(a, b)
            self.assertFalse(np.any(a == c))


class ReadBack(PlaceTest):
    def test_bit_for_bit(self):
        placed = self.place(**MIXED, min_gap=0.03)
        self.call("solve", placement="placed.csv", scatterer="soft", wavelength=4, out="a.h5")
        stored = datasets(self.folder / "a.h5")
        for name, values in placed.items():
            np.testing.assert_array_equal(stored[f"placement/{name}"], values)

    def test_solve_draws_the_same(self):
        box = {"width": 12, "depth": 8, "seed": 5, "count": 20}
        light = {"scatterer": "soft", "wavelength": 4}
        for rule in ("hard_disk", "equilibrium"):
            self.place(**box, radii=0.4, placement=rule)
            self.call("solve", placement="placed.csv", **light, out="read.h5")
            self.call("solve", placement=rule, **box, radius=0.4, **light, out="drawn.h5")
            read, drawn = (datasets(self.folder / name) for name in ("read.h5", "drawn.h5"))
            for name in read:
                np.testing.assert_array_equal(read[name], drawn[name], name)

    def test_ensembles_take_the_rule(self):
        scene = {"width": 5, "depth": 4, "scatterer": "tm", "radius": 0.3, "index": 1.2,
                 "count": 40, "min_gap": 0.02, "placement": "equilibrium", "wavelength": 4}
        self.call("covariance", **scene, method="wave", samples=4, out="wave.h5")
        self.assertIn("equilibrium placements", attributes(self.folder / "wave.h5")["plan"])
        self.call("validate", **scene, wave_samples=4, samples=2000, out="both.h5")


class Structure(PlaceTest):
    def test_points(self):
        self.place(width=12, depth=8, count=50, structure="s.h5", realizations=200)
        stored = datasets(self.folder / "s.h5")
        deviation = (stored["structure_factor"] - 1) / stored["structure_factor_error"]
        self.assertGreater(len(deviation), 40)
        self.assertLess(np.abs(deviation).max(), 4.5)
        self.assertNotIn("structure_factor_theory", stored)

    def test_equilibrium(self):
        self.place(**DISKS, placement="equilibrium", structure="s.h5", realizations=200)
        stored = datasets(self.folder / "s.h5")
        theory, error = stored["structure_factor_theory"], stored["structure_factor_error"]
        deviation = np.abs(stored["structure_factor"] - theory)
        self.assertTrue(np.all(deviation < 4 * error + 0.02 * theory))
        self.assertLess(theory.min(), 0.3)
        self.assertGreater(theory.max(), 1.4)
        self.assertAlmostEqual(attributes(self.folder / "s.h5")["packing_fraction"], 0.3979, 3)


class Correlated(PlaceTest):
    """Monte Carlo accepts measured and theoretical structure factors."""

    SCENE = {"width": 12, "depth": 8, "scatterer": "tm", "radius": 0.16, "index": 1.2, "count": 200,
             "view_angles": [0.5, 3.0], "samples": 4000}

    made = {}  # the structure factor, measured once for all tests

    def setUp(self):
        super().setUp()
        if not self.made:
            self.place(width=12, depth=8, radii=0.16, count=200, structure="s.h5", realizations=200)
            self.made["s.h5"] = (self.folder / "s.h5").read_bytes()
        (self.folder / "s.h5").write_bytes(self.made["s.h5"])

    def test_measured_and_theory_agree(self):
        for structure in ("none", "hard_disks", "s.h5"):
            self.call("covariance", **self.SCENE, structure=structure, out=f"{structure}.out.h5")
        none, theory, measured = (datasets(self.folder / f"{name}.out.h5")["intensity"][0]
                                  for name in ("none", "hard_disks", "s.h5"))
        np.testing.assert_allclose(measured, theory, rtol=0.06)
        self.assertGreater(none[0], 1.4 * theory[0])
        stored = attributes(self.folder / "s.h5.out.h5")
        self.assertIn("structure factor measured, s.h5", stored["plan"])
        self.assertIn('structure = "s.h5"', stored["config"])
        theory = attributes(self.folder / "hard_disks.out.h5")
        self.assertIn("structure factor of hard disks, packing fraction 0.167", theory["plan"])
        self.assertNotIn("structure factor", attributes(self.folder / "none.out.h5")["plan"])
        self.assertGreater(theory["k_mean_free_path"],
                           1.2 * attributes(self.folder / "none.out.h5")["k_mean_free_path"])

    def test_both_methods(self):
        scene = {**self.SCENE, "count": 40, "width": 6, "depth": 3}
        for structure, allowance in (("none", 0.179), ("hard_disks", 0.0321)):
            self.call("validate", **scene, structure=structure, wave_samples=20, out="both.h5")
            stored = attributes(self.folder / "both.h5")
            shift, depth, width = stored["k_shift"] / (2 * np.pi), scene["depth"], scene["width"]
            guided = 0.35 * min(1, 2 * np.pi * shift * depth) * min(1, np.sqrt(2 * shift) * depth / width)
            correlations = (stored["bias_allowance"] - 2 / stored["k_mean_free_path"] - 2 * shift
                            - guided)
            self.assertAlmostEqual(correlations, allowance, 3)

    def test_resumed_only_with_the_same(self):
        self.call("covariance", **{**self.SCENE, "samples": None}, structure="s.h5", out="r.h5",
                  target_error=1e-9, seconds=0.01, status=3)
        self.place(width=12, depth=8, radii=0.16, count=200, structure="s.h5", realizations=201)
        done = self.call("covariance", **{**self.SCENE, "samples": None}, structure="s.h5",
                         out="r.h5", target_error=1e-9, seconds=0.01, resume=True, status=2)
        self.assertIn("another run", done.stderr)

    def test_refused(self):
        self.place(out="p.csv", width=12, depth=8, count=200, structure="points.h5")
        self.write("text.h5", "no HDF5")
        self.call("covariance", **self.SCENE, out="result.h5")
        for changes, words in [
                ({"structure": "none.h5"}, ["none.h5"]),
                ({"structure": "text.h5"}, ["text.h5"]),
                ({"structure": "result.h5"}, ["structure = result.h5", "no dataset q"]),
                ({"structure": "points.h5"}, ["structure = points.h5", "contact distance"]),
                ({"structure": "s.h5", "count": 150}, ["structure = s.h5", "density"]),
                ({"structure": "s.h5", "radius": 0.14}, ["structure = s.h5", "contact distance"]),
                ({"structure": "s.h5", "min_gap": 0.03}, ["structure = s.h5", "contact distance"]),
                ({"structure": "hard_disks", "scatterer": "point", "radius": None, "index": None},
                 ["structure = hard_disks", "must be none"]),
                ({"structure": "hard_disks", "count": None, "optical_depth": 1},
                 ["optical_depth = 1", "another density"])]:
            with self.subTest(changes=changes):
                done = self.call("covariance", **{**self.SCENE, "out": "no.h5", **changes},
                                 status=2)
                self.assertRegex(done.stderr, r"^flatspeckle: [^\n]+\n$")
                for word in words:
                    self.assertIn(word, done.stderr)
                self.assertFalse((self.folder / "no.h5").exists())


class Refused(PlaceTest):
    CASES = [
        ({"width": None}, ["width", "must be positive"]),
        ({"depth": "nan"}, ["depth = nan", "must be positive"]),
        ({"radii": [0.4, -1]}, ["radii = -1", "must be positive"]),
        ({"radii": None}, ["packing_fraction = 0.4", "count"]),
        ({"fractions": [1, 2]}, ["fractions: has 2 values", "one for each"]),
        ({"fractions": [0]}, ["fractions = 0", "must be positive"]),
        ({"count": 5}, ["count, packing_fraction", "one of them"]),
        ({"packing_fraction": None}, ["count is not given", "packing_fraction"]),
        ({"packing_fraction": None, "count": 0}, ["count = 0", "1 to"]),
        ({"packing_fraction": None, "count": 10**15}, ["count = 1000000000000000", "1 to"]),
        ({"packing_fraction": -0.1}, ["packing_fraction = -0.1", "must be positive"]),
        ({"packing_fraction": 0.6}, ["packing fraction", "0.5", "equilibrium"]),
        ({"packing_fraction": 0.72, "placement": "equilibrium"}, ["packing fraction", "0.69"]),
        ({"packing_fraction": 0.6, "min_gap": 0.1, "placement": "equilibrium"},
         ["packing fraction (with min_gap)", "0.69"]),
        ({"depth": 2, "placement": "equilibrium"}, ["depth = 2", "three times"]),
        ({"placement": "poisson"}, ["placement = poisson", "hard_disk or equilibrium"]),
        ({"placement": "grid"}, ["placement = grid", "poisson hard_disk equilibrium"]),
        ({"radii": None, "packing_fraction": None, "count": 5, "placement": "equilibrium"},
         ["placement = equilibrium", "poisson"]),
        ({"radii": None, "packing_fraction": None, "count": 5, "min_gap": 0.1},
         ["min_gap = 0.1", "disks"]),
        ({"min_gap": -1}, ["min_gap = -1", "must not be negative"]),
        ({"seed": -1}, ["seed = -1", "must not be negative"]),
        ({"out": None}, ["out", "not given"]),
        ({"out": "none/placed.csv"}, ["none"]),
        ({"realizations": 5}, ["realizations = 5", "--structure"]),
        ({"structure": "s.h5", "realizations": 1}, ["realizations = 1", "at least 2"]),
        ({"radius": 0.4}, ["radius", "unknown"]),
    ]

    def test_bad_input(self):
        for changes, words in self.CASES:
            with self.subTest(changes=changes):
                keys = {**DISKS, "out": "placed.csv", **changes}
                done = self.call("place", **keys, status=2)
                self.assertEqual(done.stdout, "")
                self.assertRegex(done.stderr, r"^flatspeckle: [^\n]+\n$")
                for word in words:
                    self.assertIn(word, done.stderr)
                self.assertEqual(self.listing(), {})


if __name__ == "__main__":
    unittest.main()
