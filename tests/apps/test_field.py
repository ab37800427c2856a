"""Speckle fields: contents of the file, agreement with `covariance`, and rejected input."""

import signal
import unittest

import h5py
import numpy as np

from program import BOX, CYLINDERS, DATA, SLAB, WHOLE, ProgramTest, attributes, datasets

SENSORS = "x,z\n" + "".join(f"{0.5 * i},14\n" for i in range(10))
VIEWS = {"light_angles": [0, 0.03], "view_angles": [0.1, 0.13, 3.1]}
SINES = {"view_angles": [round(float(np.arcsin(0.02 * i)), 9) for i in range(12)]}
ESTIMATES = ["intensity", "contrast", "mean_contrast", "circularity", "histogram"]


class FieldTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("sensors.csv", SENSORS)

    def field(self, name="field.h5", **keys):
        self.output = self.call("field", **keys, out=name).stdout
        return datasets(self.folder / name)


class Contents(FieldTest):
    def check(self, axes, **keys):
        found = self.field(**keys)
        with h5py.File(self.folder / "field.h5") as file:
            field = file["field"]
            self.assertEqual(field.dtype, np.complex128)
            self.assertEqual(field.chunks is not None, field.nbytes > 4096)
            for axis, (name, extent) in enumerate(axes.items()):
                self.assertEqual(field.dims[axis][0], file[name])
                self.assertEqual(field.shape[axis], extent)
            for name in ESTIMATES:
                self.assertEqual(file[name].shape, file[name + "_error"].shape)
            self.assertEqual(file["contrast"].shape, field.shape[1:])
            self.assertEqual(file["intensity"].shape, field.shape[1:])
            for name in found:
                self.assertTrue(np.all(np.isfinite(found[name])), name)
            self.assertIn(field.attrs["method"], file.attrs["plan"])
            self.assertEqual(file.attrs["samples"], field.shape[0])
            self.assertGreater(file.attrs["k_mean_free_path"], 0)
        self.assertAlmostEqual(found["histogram"].sum(), found["field"].size)
        self.assertAlmostEqual(found["histogram_expected"].sum(), found["field"].size)
        return found

    def test_lights_and_views(self):
        for method in "paths", "covariance":
            found = self.check({"realization": 7, "light_angle": 2, "view_angle": 3}, **BOX,
                               **VIEWS, fields=7, method=method)
            self.assertEqual(found.keys() & {"tilt", "view_lag", "siegert"}, set())
            self.assertIn(f"fields {'by' if method == 'paths' else 'from the'} {method}",
                          self.output)

    def test_tilts(self):
        found = self.check({"realization": 4, "light_angle": 3, "view_angle": 12}, **BOX, **SINES,
                           light_angles=0.2, tilts=[-0.1, 0, 0.1], fields=4)
        np.testing.assert_allclose(found["light_angle"], [0.1, 0.2, 0.3])
        np.testing.assert_allclose(found["tilt"], [-0.1, 0, 0.1])
        q = 2 * np.pi * (np.sin([0.1, 0.2, 0.3]) - np.sin(0.2))
        np.testing.assert_allclose(found["tilt_q"], q, atol=1e-12)
        np.testing.assert_allclose(found["view_lag"], 0.02 * np.arange(12), atol=1e-7)
        self.assertAlmostEqual(found["siegert"][0], 1)

    def test_near_sensors(self):
        found = self.check({"realization": 4, "light_angle": 1, "sensor": 10}, **CYLINDERS,
                           near_sensors="sensors.csv", fields=4)
        np.testing.assert_allclose(found["view_lag"], 0.5 * np.arange(10))

    def test_without_light(self):
        found = self.field(width=20, depth=10, scatterer="hg", albedo=0, mean_free_path=3, fields=4)
        np.testing.assert_array_equal(found["field"], 0)
        for name, values in found.items():
            self.assertTrue(np.all(np.isfinite(values)), name)

    def test_the_shipped_scene(self):
        found = self.field(config=DATA / "scenes" / "speckle_field.toml", fields=4 if WHOLE else 2)
        self.assertEqual(found["field"].shape, (4 if WHOLE else 2, 101, 201))
        self.assertIn("view_lag", found)


class Statistics(FieldTest):
    def test_covariance(self):
        """The covariance of 1e4 fields, by day 4000, is within 4 standard errors of `covariance`."""
        fields = 10_000 if WHOLE else 4000
        self.call("covariance", **BOX, **VIEWS, covariance="full", samples=40 * fields, seed=5,
                  out="full.h5")
        full = datasets(self.folder / "full.h5")
        n = full["covariance"].shape[0] * full["covariance"].shape[1]
        expected, spread = (full["covariance" + end].reshape(n, n) for end in ("", "_error"))
        for method in "paths", "covariance":
            with self.subTest(method=method):
                found = self.field(**BOX, **VIEWS, fields=fields, method=method)
                u = found["field"].reshape(-1, n)
                products = u[:, :, None] * u[:, None, :].conj()
                mean = products.mean(axis=0)
                error = np.sqrt(np.mean(np.abs(products - mean)**2, axis=0) / len(u))
                drawn_from = 0.01 * np.sqrt(np.outer(*2 * [mean.diagonal().real]))
                if method == "paths":
                    drawn_from = 0
                deviation = np.abs(mean - expected) / np.sqrt(error**2 + spread**2 + drawn_from**2)
                self.assertLess(deviation.max(), 4)
                pseudo = u[:, :, None] * u[:, None, :]
                error = np.sqrt(np.mean(np.abs(pseudo)**2, axis=0) / len(u))
                self.assertLess((np.abs(pseudo.mean(axis=0)) / error).max(), 4)
                self.assertLess(abs(found["mean_contrast"] - 1), 4 * found["mean_contrast_error"])
                self.assertLess(found["mean_contrast_error"], 0.01)
                self.assertLess(abs(found["circularity"]), 4 * found["circularity_error"])

    def test_siegert(self):
        found = self.field(**BOX, **SINES, fields=2000)
        error = np.hypot(found["intensity_autocorrelation_error"], found["siegert_error"])
        deviation = found["intensity_autocorrelation"] - found["siegert"]
        self.assertLess(np.max(np.abs(deviation) / error), 4)
        self.assertLess(found["intensity_autocorrelation_error"].max(), 0.15)

    def test_the_memory_effect_shears(self):
        """Fields under tilted light correlate in the matched view, and hardly in the same one."""
        box = {"width": 200, "depth": 4, "scatterer": "hg", "mean_free_path": 4}
        tilt, view = float(np.arcsin(0.02)), float(np.arcsin(0.3))
        matched = float(np.arcsin(0.32))
        found = self.field(**box, tilts=[0, tilt], view_angles=[view, matched], fields=4000)
        u = found["field"] / np.sqrt(found["intensity"])
        self.assertGreater(abs(np.mean(u[:, 0, 0] * u[:, 1, 1].conj())), 0.8)
        self.assertLess(abs(np.mean(u[:, 0, 0] * u[:, 1, 0].conj())), 0.1)


class Reproducibility(FieldTest):
    def test_threads(self):
        for method in "paths", "covariance":
            for threads in 1, 3:
                self.field(f"{threads}.h5", **BOX, **SINES, fields=50, method=method,
                           threads=threads)
            self.assert_same_data("1.h5", "3.h5")

    def test_a_field_is_its_number_s(self):
        """More fields do not change the first ones."""
        for method in "paths", "covariance":
            keys = {**BOX, **VIEWS, "method": method,
                    "paths_per_field": 50 if method == "paths" else None}
            few, many = (self.field(**keys, fields=fields)["field"] for fields in (5, 40))
            np.testing.assert_array_equal(few, many[:5])
            other = self.field(**keys, fields=5, seed=2)["field"]
            self.assertTrue(np.all(few != other))
            self.assertEqual(len(np.unique(many)), many.size)

    def test_the_stored_configuration_draws_the_same(self):
        self.field(**BOX, **SINES, tilts=[0, 0.05], fields=5, target_error=0.02)
        self.write("again.toml", attributes(self.folder / "field.h5")["config"])
        self.call("field", config="again.toml", out="again.h5")
        self.assert_same_data("field.h5", "again.h5")


class BadInput(FieldTest):
    def test_one_line_and_no_file(self):
        before = self.listing()
        cases = [
            ({"fields": 1}, ["fields = 1", "at least 2"]),
            ({"fields": 10**12}, ["fields = 1000000000000", "GB"]),
            ({"paths_per_field": 0}, ["paths_per_field = 0", "positive"]),
            ({"target_error": 0}, ["target_error = 0", "(0, 1)"]),
            ({"method": "wave"}, ["method = wave", "auto paths covariance"]),
            ({"tilts": [0, 0.1], "light_angles": [0, 1]}, ["tilts", "light_angles"]),
            ({"tilts": ["nan"]}, ["tilts"]),
            ({"reversed_paths": "perhaps"}, ["reversed_paths = perhaps"]),
            ({"near_sensors": "sensors.csv", "view_angles": 0.1}, ["near_sensors"]),
            ({"covariance": "full"}, ["covariance", "unknown"]),
            ({"out": None}, ["out is not given"]),
        ]
        for keys, words in cases:
            with self.subTest(keys=keys):
                done = self.call("field", **{**BOX, "out": "field.h5", **keys}, status=2)
                self.assertRegex(done.stderr, r"\Aflatspeckle: .+\n\Z")
                for word in words:
                    self.assertIn(word, done.stderr)
        done = self.call("field", **SLAB, out="field.h5", status=2)
        self.assertIn("domain = slab", done.stderr)
        self.assertEqual(self.listing(), before)

    def test_interrupted(self):
        before = self.listing()
        process = self.start("field", **BOX, **VIEWS, fields=1_000_000, method="paths",
                             out="field.h5")
        self.wait_until_it_catches(process, signal.SIGINT)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), 130)
        self.assertEqual(self.listing(), before)


if __name__ == "__main__":
    unittest.main()
