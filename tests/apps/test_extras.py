"""Derivatives and delays stored with the covariance."""

import unittest

import h5py
import numpy as np

from program import BOX, SLAB, TILTS, ProgramTest, datasets
from refusing import RefusingTest

HG = {"width": 20, "depth": 10, "scatterer": "hg", "optical_depth": 2, "g": 0.5, "albedo": 0.9}
VIEWS = {"light_angles": [0, 0.3], "view_angles": [0.1, 0.5, 3.0]}
PAIRS = {"covariance": "pairs", "pairs": [0, 0.1, 0.04, 0.14, 0, 0.5, 0, 0.5]}
SMALL_TILTS = {**TILTS, "tilts": [0, 0.001, 0.003, 0.006]}
POINTS = {"domain": "slab", "width": None, "count": None, "density": 0.1, "method": "transport"}
LV = ("light_angle", "view_angle")
MATRIX = (*LV, "light_angle_2", "view_angle_2")
# request: shape of one parameter, and whether it is complex
REQUESTS = {
    "intensity": (VIEWS, {"gradient": (LV, False)}),
    "full": ({**VIEWS, "covariance": "full"}, {"gradient": (MATRIX, True)}),
    "pairs": (PAIRS, {"gradient": (("pair",), True)}),
    "memory_effect": (TILTS, {"gradient": (("tilt", "view_angle"), True),
                              "reference_intensity_gradient": (("view_angle",), False),
                              "tilted_intensity_gradient": (("tilt", "view_angle"), False),
                              "field_correlation_gradient": (("tilt",), False),
                              "memory_effect_range_gradient": ((), False)}),
}


class Extras(ProgramTest):
    def check(self, file, name, axes, is_complex):
        values, error = file[name], file[name + "_error"]
        self.assertEqual(values.dtype, np.complex128 if is_complex else np.float64, name)
        self.assertEqual(values.shape, tuple(len(file[axis]) for axis in axes), name)
        self.assertEqual(error.shape, values.shape, name)
        self.assertTrue(np.all(np.isfinite(values[()])) and np.all(error[()] >= 0), name)
        for number, axis in enumerate(axes):
            self.assertEqual(values.dims[number][0].name, f"/{axis}", name)

    def test_gradient(self):
        for request, (keys, wanted) in REQUESTS.items():
            with self.subTest(request=request):
                done = self.call("covariance", **HG, **keys, gradient=True, samples=4000,
                                 out="result.h5")
                with h5py.File(self.folder / "result.h5") as file:
                    names = list(file["parameter"].attrs["names"])
                    self.assertEqual(names, ["mu_t", "g", "albedo", "optical_depth"])
                    for name, (axes, is_complex) in wanted.items():
                        self.check(file, name, ("parameter", *axes), is_complex)
                    gradient = file["gradient"][()]
                    np.testing.assert_allclose(gradient[3], gradient[0] / HG["depth"], rtol=1e-12)
                    self.assertIn("derivatives by mu_t g albedo optical_depth",
                                  file.attrs["plan"])
                for name in names:
                    self.assertIn(f"d/d {name}", done.stdout)

    def test_the_covariance_is_the_same_with_a_gradient(self):
        for name, keys in (("with", {"gradient": True}), ("without", {})):
            self.call("covariance", **HG, **VIEWS, **keys, samples=4000, out=f"{name}.h5")
        first, second = (datasets(self.folder / f"{name}.h5") for name in ("with", "without"))
        np.testing.assert_allclose(first["intensity"], second["intensity"], rtol=1e-12)

    def test_gradient_by_transport(self):
        for keys in (SMALL_TILTS, {"view_angles": [0.1, 3.2]}):
            with self.subTest(keys=keys):
                self.call("covariance", **SLAB, **keys, gradient=True, method="transport",
                          out="transport.h5")
                self.call("covariance", **SLAB, **keys, gradient=True, samples=40000, out="mc.h5")
                with h5py.File(self.folder / "transport.h5") as found, \
                        h5py.File(self.folder / "mc.h5") as expected:
                    self.assertEqual(*({name for name in file if not name.endswith("_rare") and name != "invariants"}
                                       for file in (found, expected)))  # few paths are not checked
                    for name in expected:
                        if not name.endswith("gradient"):
                            continue
                        difference = np.abs(found[name][()] - expected[name][()])
                        error = expected[name + "_error"][()]
                        self.assertTrue(np.all(difference <= 4 * error + 1e-9), name)

    def test_points_have_no_g(self):
        self.call("covariance", **BOX, **VIEWS, gradient=True, samples=4000, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            self.assertEqual(list(file["parameter"].attrs["names"]),
                             ["mu_t", "albedo", "optical_depth"])

    def test_delays(self):
        self.call("covariance", **HG, **VIEWS, delays=[0, 0.1, 1], samples=4000, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            for name in ("covariance", "field_correlation"):
                self.check(file, name, ("delay", *LV), False)
            np.testing.assert_allclose(file["field_correlation"][0], 1, rtol=1e-12)
            np.testing.assert_allclose(file["covariance"][0], file["intensity"], rtol=1e-12)
            self.assertTrue(np.all(np.diff(file["field_correlation"][()], axis=0) < 0))
            self.assertNotIn("diffusion_theory", file)
        self.call("covariance", **SLAB, delays=[0, 0.1], samples=4000, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            self.assertEqual(file["diffusion_theory"].shape, (2,))
            self.assertAlmostEqual(file["diffusion_theory"][0], 1)

    def test_delays_by_transport(self):
        delays = {"delays": [0, 0.01], "method": "transport"}
        self.call("covariance", **SLAB, **delays, out="transport.h5")
        self.call("covariance", **SLAB, delays=[0, 0.01], samples=20000, out="mc.h5")
        files = [h5py.File(self.folder / f"{name}.h5") for name in ("transport", "mc")]
        found, expected = (file["field_correlation"][()] for file in files)
        error = files[1]["field_correlation_error"][()]
        self.assertTrue(np.all(np.abs(found - expected) <= 4 * error + 1e-12))
        self.assertEqual(set(files[0]) - {"invariants"}, set(files[1]))  # few paths are not checked
        for file in files:
            file.close()
        self.call("covariance", **SLAB, **SMALL_TILTS, **delays, out="tilts.h5")
        with h5py.File(self.folder / "tilts.h5") as file:
            self.check(file, "delayed_covariance", ("delay", "tilt", "view_angle"), True)
            self.check(file, "delayed_correlation", ("delay", "tilt"), False)
            np.testing.assert_allclose(file["delayed_correlation"][0], file["field_correlation"])

    def test_frequency_shifts(self):
        shifts = {"frequency_shifts": [0, 1e-3, 0.01], "method": "transport"}
        self.call("covariance", **SLAB, **shifts, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            for name in ("frequency_covariance", "frequency_correlation"):
                self.check(file, name, ("frequency_shift", *LV), True)
            correlation = np.abs(file["frequency_correlation"][:, 0, 0])
            self.assertAlmostEqual(correlation[0], 1)
            self.assertTrue(np.all(np.diff(correlation) < 0))
        self.call("covariance", **SLAB, **SMALL_TILTS, **shifts, out="tilts.h5")
        with h5py.File(self.folder / "tilts.h5") as file:
            self.check(file, "frequency_tilt_covariance",
                       ("frequency_shift", "tilt", "view_angle"), True)
            np.testing.assert_allclose(file["frequency_tilt_correlation"][0],
                                       file["field_correlation"], rtol=1e-12)

    def test_hardly_any_scattering(self):
        """Results remain proportional to the albedo, at the same cost."""
        found = []
        for albedo in (1e-7, 1e-100):
            self.call("covariance", **{**SLAB, **SMALL_TILTS}, albedo=albedo, method="transport",
                      frequency_shifts=[0, 0.01], out="result.h5")
            with h5py.File(self.folder / "result.h5") as file:
                found.append(file["frequency_tilt_covariance"][()] / albedo)
        np.testing.assert_allclose(found[1], found[0], rtol=1e-5)

    def test_resumed(self):
        """Resuming gives the same numbers and rejects other extras."""
        for keys in ({"delays": [0.1, 1]}, {"gradient": True}):
            self.call("covariance", **HG, **VIEWS, **keys, samples=4000, out="whole.h5")
            self.call("covariance", **HG, **VIEWS, **keys, samples=2000, target_error=1e-9,
                      status=3, out="part.h5")
            self.call("covariance", **HG, **VIEWS, delays=[0.3], samples=4000, resume=True,
                      status=2, out="part.h5")
            self.call("covariance", **HG, **VIEWS, **keys, samples=4000, resume=True,
                      out="part.h5")
            self.assert_same_data("whole.h5", "part.h5")


class Refused(RefusingTest):
    def test_refused(self):
        for keys, words in (({"gradient": True, "delays": [0.1]}, ["gradient, delays"]),
                            ({"gradient": True, "method": "wave"}, ["gradient", "method = mc"]),
                            ({"delays": [0.1], "method": "wave"}, ["delays", "method = mc"]),
                            ({**POINTS, "frequency_shifts": [0.3]},
                             ["frequency_shifts = 0.3", "-0.1 to 0.1"]),
                            ({**POINTS, "frequency_shifts": [0.01], "delays": [0.1]},
                             ["frequency_shifts: give only one"]),
                            ({**POINTS, "frequency_shifts": [-0.1], "light_angles": [1.5],
                              "view_angles": [-1.5]}, ["frequency_shifts = -0.1", "horizon"]),
                            ({"delays": [-0.1]}, ["delays = -0.1", "must not be negative"]),
                            ({"delays": ["nan"]}, ["delays = nan", "must not be negative"]),
                            ({"delays": [0.1], **TILTS}, ["delays", "covariance = intensity"]),
                            ({**POINTS, "delays": [0.1], "covariance": "pairs",
                              "pairs": [0, 0.5, 0, 0.5]},
                             ["delays", "covariance = intensity or memory_effect"]),
                            ({"gradient": True, "count": 0}, ["gradient", "does not scatter"])):
            self.assert_refused_both_ways("covariance", BOX, keys, words)


if __name__ == "__main__":
    unittest.main()
