"""Choice of method = auto, and slabs by Monte Carlo and transport side by side."""

import unittest

import h5py
import numpy as np

from program import BOX, CYLINDERS, SLAB, ProgramTest

SWEEP = {"g": [0, 0.5], "optical_depth": 4, "depth": 50, "tilts": [0, 0.01, 0.02, 0.03, 0.05]}


class Method(ProgramTest):
    def attributes(self, subcommand, keys):
        self.call(subcommand, **keys, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            return dict(file.attrs)

    def test_auto(self):
        few = {"samples": 2000}
        for subcommand, keys, method in (("covariance", SLAB, "transport"),
                                         ("covariance", SLAB | {"target_error": 0.1}, "transport"),
                                         ("covariance", SLAB | few, "mc"),
                                         ("covariance", SLAB | few | {"gradient": True}, "mc"),
                                         ("covariance", BOX | few, "mc"),
                                         ("flux", SLAB, "transport"), ("flux", BOX | few, "mc"),
                                         ("sweep", SWEEP, "transport"), ("sweep", SWEEP | few, "mc")):
            with self.subTest(subcommand=subcommand, keys=keys):
                found = self.attributes(subcommand, keys)
                self.assertEqual(found["plan"].split(":")[0], method)
                self.assertIn(f'method = "{method}"', found["config"])
                self.assertEqual("errors" in found, method == "transport")

    def test_an_error_is_heeded(self):
        rough, fine = (self.attributes("flux", SLAB | {"target_error": error})["config"]
                       for error in (0.1, 1e-8))
        self.assertIn("tolerance = 1e-06", rough)
        self.assertIn("tolerance = 1e-08", fine)

    def test_options_of_monte_carlo_only(self):
        for subcommand, keys in (("covariance", SLAB), ("flux", SLAB), ("sweep", SWEEP)):
            for key in ("samples", "seconds"):
                done = self.call(subcommand, **keys, method="transport", out="x.h5", status=2,
                                 **{key: 10})
                self.assertIn(f"{key} = 10: is not used here", done.stderr)

    def test_validate_and_sweep_of_both(self):
        self.call("validate", **SLAB, view_angles=[0, 0.5, 3.1], samples=20000, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            self.assertEqual(file["transport/intensity"].shape, (1, 3))
            self.assertLess(np.max(file["deviation"][:]), 4)
            self.assertEqual(file.attrs["bias_allowance"], 1e-6)
            self.assertIn("numerical", file["transport"].attrs["errors"])
            error = file["transport/intensity_error"][:] / file["transport/intensity"][:]
            self.assertLess(np.max(error), 1e-5)
        self.call("sweep", **SWEEP, method="both", samples=20000, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            mc, transport = (file[f"{name}/field_correlation"][:] for name in ("mc", "transport"))
            self.assertLess(np.max(np.abs(mc - transport)), 0.05)

    def test_one_budget_of_time_for_both(self):
        keys = {**BOX, "width": 60, "depth": 30, "count": 300}
        done = self.call("validate", **keys, seconds=0.2, threads=1, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            taken = {name: file[f"{name}/trace/wall_s"][-1] for name in ("mc", "wave")}
        self.assertLess(taken["mc"], taken["wave"])
        self.assertIn("placements: the errors are rough", done.stderr)

    def test_the_allowance_is_what_there_is(self):
        """Resonant points allow for crossed paths only; their one view is forward, so no difference is stated."""
        parts = ("crossed paths", "refraction", "correlated positions")
        few = {"samples": 2000, "wave_samples": 4, "threads": 1}
        said = self.call("validate", **BOX, **few, out="x.h5").stdout
        self.assertEqual([words in said for words in parts], [True, False, False])
        self.assertIn("1 forward, 0 beyond", said)
        with h5py.File(self.folder / "x.h5") as file:
            self.assertEqual((list(file["forward"]), "rms_difference" in file), ([1], False))
        said = self.call("validate", **CYLINDERS, index=1.5, view_angles=1, **few, out="x.h5").stdout
        self.assertTrue(all(words in said for words in parts), said)
        with h5py.File(self.folder / "x.h5") as file:
            difference = abs(file["mc/intensity"][0, 0] - file["wave/intensity"][0, 0])
            self.assertAlmostEqual(file["rms_difference"][()], difference / file["wave/intensity"][0, 0], 12)

    def test_near_ends_beside_a_slab(self):
        (self.folder / "sensors.csv").write_text("x,z\n0,105\n")
        (self.folder / "inside.csv").write_text("x,z\n0,20\n")
        beam, sensors = {"beam_waist": 10}, {"near_sensors": "sensors.csv"}
        moved = {"covariance": "translation", "shifts": [0, 5]}
        (self.folder / "before.csv").write_text("x,z\n0,-5\n")
        for keys in (beam, beam | moved, sensors, {"near_sources": "before.csv"}):
            with self.subTest(keys=keys):
                self.assertIn("near endpoints", self.attributes("covariance", SLAB | keys)["plan"])
        for keys, words in ((beam | {"samples": 400}, "require method = transport"),
                            (beam | sensors, "far views"), (beam | {"gradient": True}, "gradient"),
                            ({"near_sensors": "inside.csv"}, "outside of the slab"),
                            ({"near_sources": "inside.csv"}, "must be below 0"),
                            (beam | {"dimension": 3}, "dimension")):
            with self.subTest(keys=keys):
                done = self.call("covariance", **SLAB | keys, out="y.h5", status=2)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
