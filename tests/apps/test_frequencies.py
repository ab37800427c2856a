"""Frequency correlations by Monte Carlo, exact placements and transport, and their comparison."""

import unittest

import h5py
import numpy as np

from program import BOX, SLAB, TILTS, ProgramTest
from refusing import RefusingTest

SHIFTS = {"frequency_shifts": [0, 1e-3, 0.02]}
POINTS = {"width": 20, "depth": 10, "density": 0.155}
VIEWS = {"light_angles": [0, 0.3], "view_angles": [0.5, 3.0]}
LV = ("light_angle", "view_angle")
SMALL_TILTS = {**TILTS, "tilts": [0, 0.001, 0.003]}


class Frequencies(ProgramTest):
    def check(self, file, name, axes, is_complex):
        values, error = file[name], file[name + "_error"]
        self.assertEqual(values.dtype, np.complex128 if is_complex else np.float64, name)
        self.assertEqual(values.shape, tuple(len(file[axis]) for axis in axes), name)
        self.assertTrue(np.all(np.isfinite(values[()])) and np.all(error[()] >= 0), name)
        for number, axis in enumerate(axes):
            self.assertEqual(values.dims[number][0].name, f"/{axis}", name)

    def test_in_a_box(self):
        for method, samples in (("mc", 20000), ("wave", 200)):
            with self.subTest(method=method):
                done = self.call("covariance", **POINTS, **VIEWS, **SHIFTS, method=method,
                                 samples=samples, out="result.h5")
                self.assertIn("shift", done.stdout)
                with h5py.File(self.folder / "result.h5") as file:
                    for name in ("frequency_covariance", "frequency_correlation"):
                        self.check(file, name, ("frequency_shift", *LV), True)
                    correlation = np.abs(file["frequency_correlation"][()])
                    np.testing.assert_allclose(correlation[0], 1, rtol=1e-9)
                    self.assertTrue(np.all(correlation[2] < 0.95))
                    np.testing.assert_allclose(file["frequency_covariance"][0].real,
                                               file["intensity"][()], rtol=1e-9)
                    self.assertNotIn("frequency_diffusion_theory", file)
                    self.assertIn("two frequencies", file.attrs["plan"])

    def test_tilts(self):
        for method, samples in (("mc", 4000), ("wave", 60)):
            self.call("covariance", **POINTS, **TILTS, **SHIFTS, method=method, samples=samples,
                      out="tilts.h5")
            with h5py.File(self.folder / "tilts.h5") as file:
                self.check(file, "frequency_tilt_covariance",
                           ("frequency_shift", "tilt", "view_angle"), True)
                self.check(file, "frequency_tilt_correlation", ("frequency_shift", "tilt"), False)
                np.testing.assert_allclose(file["frequency_tilt_correlation"][0],
                                           file["field_correlation"], rtol=1e-9)

    def test_theory_of_a_slab(self):
        for method in ({"method": "transport"}, {"method": "mc", "samples": 4000}):
            self.call("covariance", **SLAB, **SHIFTS, **method, out="slab.h5")
            with h5py.File(self.folder / "slab.h5") as file:
                theory = file["frequency_diffusion_theory"][()]
                self.assertEqual(theory.shape, (3,))
                self.assertAlmostEqual(theory[0], 1)
                self.assertTrue(np.all(np.diff(theory) < 0))

    def test_validate(self):
        shifts = {"frequency_shifts": [0, 1e-4, 5e-4]}
        for name, keys in (("wave", {**POINTS, **SHIFTS, "samples": 40000, "wave_samples": 400}),
                           ("transport", {**SLAB, **shifts, "samples": 20000}),
                           ("transport", {**SLAB, **SMALL_TILTS, **shifts, "samples": 20000})):
            with self.subTest(keys=keys):
                done = self.call("validate", **keys, out="both.h5")
                self.assertIn("correlations: ", done.stdout)
                tilt = "frequency_tilt_" if "tilts" in keys else "frequency_"
                with h5py.File(self.folder / "both.h5") as file:
                    found, expected = (file[f"{group}/{tilt}correlation"] for group in ("mc", name))
                    deviation = file[f"{tilt}deviation"]
                    self.assertEqual(found.shape, expected.shape)
                    self.assertEqual(deviation.shape, found.shape)
                    self.assertLess(deviation[()].max(), 5)
                    self.assertEqual(found.dims[0][0].name, "/frequency_shift")

    def test_resumed(self):
        for keys in ({"method": "mc", "samples": 8000}, {"method": "wave", "samples": 60}):
            keys = {**POINTS, **SHIFTS, **keys}
            self.call("covariance", **keys, out="whole.h5")
            self.call("covariance", **{**keys, "samples": keys["samples"] // 2}, target_error=1e-9,
                      status=3, out="part.h5")
            self.call("covariance", **{**keys, "frequency_shifts": [0.01]}, resume=True, status=2,
                      out="part.h5")
            self.call("covariance", **keys, resume=True, out="part.h5")
            self.assert_same_data("whole.h5", "part.h5")


class Refused(RefusingTest):
    def test_refused(self):
        for keys, words in (({"frequency_shifts": [0.3]}, ["frequency_shifts = 0.3", "-0.1 to 0.1"]),
                            ({"frequency_shifts": ["nan"]}, ["frequency_shifts"]),
                            ({"frequency_shifts": [0.01], "covariance": "full"},
                             ["frequency_shifts", "covariance = intensity or memory_effect"]),
                            ({"frequency_shifts": [0.01], "beam_waist": 2},
                             ["frequency_shifts", "plane waves"]),
                            ({"frequency_shifts": [-0.1], "light_angles": [1.5],
                              "view_angles": [-1.5]}, ["frequency_shifts = -0.1", "horizon"])):
            for method in ({}, {"method": "wave"}):
                self.assert_refused_both_ways("covariance", BOX, {**keys, **method}, words)
            self.assert_refused_both_ways("validate", BOX, keys, words)
        self.assert_refused_both_ways("covariance", BOX, {"frequency_shifts": [0.1], "delays": [1]},
                                      ["frequency_shifts: give only one"])


if __name__ == "__main__":
    unittest.main()
