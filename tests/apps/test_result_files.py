"""Contents of result files: shapes, types, scales, errors, provenance."""

import unittest

import h5py
import numpy as np

from program import BOX, CYLINDERS, SLAB, TILTS, ProgramTest, attributes, datasets

PROVENANCE = {"program": str, "version": str, "git_commit": str, "command_line": str, "config": str,
              "seed": np.integer, "plan": str, "machine": str, "threads": np.integer,
              "started": str, "wall_s": float, "cpu_s": float, "samples": float,
              "converged": np.integer}
BULK = ["g", "albedo", "k_mean_free_path"]
MEDIUM = [*BULK, "sigma_s", "sigma_e", "density", "packing_fraction"]
SCALES = {"light_angle": "rad", "view_angle": "rad", "tilt": "rad", "sensor": "1", "pair": "1",
          "g": "1", "albedo": "1", "optical_depth": "1"}
TRACE = ["trace/wall_s", "trace/cpu_s", "trace/samples", "trace/relative_error"]

LIGHTS = {"light_angles": [0, 0.3]}
VIEWS = {"view_angles": [0.1, 0.5, 3.0]}
PAIRS = {"covariance": "pairs", "pairs": [0, 0.1, 0.04, 0.14, 0, 0.5, 0, 0.5]}
SENSORS = {"near_sensors": "sensors.csv"}
LV, LS = ("light_angle", "view_angle"), ("light_angle", "sensor")
MATRIX = (*LV, "light_angle_2", "view_angle_2")
REAL, COMPLEX = np.float64, np.complex128

# request: its keys, and its estimates with type and axes
REQUESTS = {
    "intensity": ({**LIGHTS, **VIEWS}, {"intensity": (REAL, LV), "mean_field": (COMPLEX, LV)}),
    "near": ({**LIGHTS, **SENSORS}, {"intensity": (REAL, LS)}),
    "full": ({**LIGHTS, **VIEWS, "covariance": "full"},
             {"covariance": (COMPLEX, MATRIX), "mean_field": (COMPLEX, LV)}),
    "pairs": (PAIRS, {"covariance": (COMPLEX, ("pair",))}),
    "memory_effect": (TILTS, {"covariance": (COMPLEX, ("tilt", "view_angle")),
                              "reference_intensity": (REAL, ("view_angle",)),
                              "tilted_intensity": (REAL, ("tilt", "view_angle")),
                              "field_correlation": (REAL, ("tilt",)),
                              "memory_effect_range": (REAL, ()),
                              "mean_field": (COMPLEX, LV)}),
}
EXTENTS = {"light_angle": 2, "view_angle": 3, "sensor": 2, "pair": 2, "tilt": 3}
SWEEP = {"depth": 100, "optical_depth": [1, 2], "g": [0, 0.5, -0.2], "albedo": [1, 0.9],
         "tilts": [0, 0.001, 0.002, 0.003], "samples": 4000}


class ResultTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("sensors.csv", "# behind the box\nx, z\n0, 15\n2.5, 12\n")

    def open(self, name="result.h5"):
        file = h5py.File(self.folder / name)
        self.addCleanup(file.close)
        return file

    def check_finite(self, file):
        def check(name, item):
            values = [(key, value) for key, value in item.attrs.items() if key not in
                      ("REFERENCE_LIST", "DIMENSION_LIST", "DIMENSION_LABELS")]
            if isinstance(item, h5py.Dataset):
                values.append(("values", item[()]))
            for key, value in values:
                if np.asarray(value).dtype.kind in "fc":
                    self.assertTrue(np.all(np.isfinite(value)), f"{name}: {key}")
        check("/", file)
        file.visititems(check)

    def check_scales(self, file):
        for name, units in SCALES.items():
            if name in file:
                self.assertEqual(file[name].attrs["CLASS"], b"DIMENSION_SCALE", name)
                self.assertEqual(file[name].dtype, REAL)
                self.assertEqual(file[name].attrs["units"], units)
                self.assertTrue(file[name].attrs["long_name"])

    def check_provenance(self, file, medium, command):
        for key, kind in PROVENANCE.items():
            self.assertIsInstance(file.attrs[key], kind, key)
        for key in medium:
            self.assertIsInstance(file.attrs[key], float, key)
        self.assertEqual(file.attrs["program"], "flatspeckle")
        self.assertIn(command, file.attrs["command_line"])
        self.assertRegex(file.attrs["started"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertEqual(file.attrs["converged"], 1)

    def check_estimate(self, file, name, kind, axes, extents=EXTENTS):
        values, error = file[name], file[name + "_error"]
        self.assertEqual(values.dtype, kind, name)
        self.assertEqual(error.dtype, REAL, name)
        self.assertEqual(values.shape, tuple(extents[axis] for axis in axes), name)
        self.assertEqual(error.shape, values.shape, name)
        self.assertTrue(np.all(error[()] >= 0), name)
        for data in (values, error):
            self.assertTrue(data.attrs["long_name"])
            for place, axis in enumerate(axes):
                self.assertEqual(data.dims[place].label, axis)
                self.assertEqual(data.dims[place][0].name, "/" + axis)

    def check_trace(self, file, group=""):
        columns = [file[group + name][()] for name in TRACE]
        self.assertGreater(len(columns[0]), 1)
        for column in columns:
            self.assertEqual(column.shape, columns[0].shape)
        for rising in columns[:3]:
            self.assertTrue(np.all(np.diff(rising) >= 0))
        self.assertTrue(np.all(columns[3] > 0))

    def check_again(self, subcommand):
        """Checks that the stored configuration gives the same data."""
        with h5py.File(self.folder / "result.h5") as file:
            self.write("again.toml", file.attrs["config"])
        self.call(subcommand, config="again.toml", out="again.h5")
        self.assert_same_data("result.h5", "again.h5")
        self.assertEqual(attributes(self.folder / "again.h5")["config"],
                         attributes(self.folder / "result.h5")["config"])


class Covariance(ResultTest):
    def check_request(self, name, scene, samples, medium=MEDIUM, **more):
        keys, estimates = REQUESTS[name]
        self.call("covariance", **{**scene, **keys, "samples": samples, **more}, out="result.h5")
        file = self.open()
        extents = {**EXTENTS, **{name: len(file[name]) for name in MATRIX if name in file}}
        for estimate, (kind, axes) in estimates.items():
            self.check_estimate(file, estimate, kind, axes, extents)
        self.check_scales(file)
        self.check_provenance(file, medium, "covariance")
        self.check_trace(file)
        self.check_finite(file)
        self.assertGreaterEqual(file.attrs["samples"], samples)
        self.assertIn("state/run", file)
        self.check_again("covariance")
        return file

    def test_mc(self):
        for name in REQUESTS:
            with self.subTest(request=name):
                self.check_request(name, BOX, 4000)

    def test_wave(self):
        for name in REQUESTS:
            with self.subTest(request=name):
                self.check_request(name, BOX, 12, method="wave")
        self.check_request("intensity", CYLINDERS, 12, method="wave")

    def test_slab(self):
        """A slab of bulk has no data of single scatterers and no mean field."""
        self.call("covariance", **SLAB, **TILTS, samples=4000, out="result.h5")
        file = self.open()
        for name in ("covariance", "field_correlation"):
            self.assertIn(name, file)
        self.check_provenance(file, BULK, "covariance")
        self.check_scales(file)
        self.check_finite(file)
        self.check_again("covariance")

    def test_full_is_hermitian_and_its_diagonal_is_the_intensity(self):
        file = self.check_request("full", BOX, 4000)
        matrix = file["covariance"][()].reshape(6, 6)
        np.testing.assert_array_equal(matrix, matrix.conj().T)
        error = file["covariance_error"][()].reshape(6, 6)
        self.check_request("intensity", BOX, 4000)
        file = self.open()  # other paths: single scattering in closed form
        combined = np.hypot(np.diag(error), file["intensity_error"][()].ravel())
        difference = np.diag(matrix).real - file["intensity"][()].ravel()
        self.assertTrue(np.all(np.abs(difference) < 4 * combined), difference / combined)

    def test_memory_effect_agrees_with_pairs(self):
        """Uses a tilt of 0.04 of light 0, viewed at sin v = sin 0.1 + sin 0.04."""
        matched = np.arcsin(np.sin(0.1) + np.sin(0.04))
        self.call("covariance", **BOX, **TILTS, samples=4000, out="tilts.h5")
        self.call("covariance", **BOX, covariance="pairs", samples=4000, out="pairs.h5",
                  pairs=[0, 0.1, 0.04, repr(matched)])
        tilts, pairs = datasets(self.folder / "tilts.h5"), datasets(self.folder / "pairs.h5")
        error = np.hypot(tilts["covariance_error"][1, 0], pairs["covariance_error"][0])
        self.assertLess(abs(tilts["covariance"][1, 0] - pairs["covariance"][0]), 4 * error)
        self.assertLess(error, 0.1)

    def test_axes_are_those_of_the_request(self):
        self.check_request("memory_effect", BOX, 4000)
        file = self.open()
        np.testing.assert_array_equal(file["tilt"][()], TILTS["tilts"])
        np.testing.assert_array_equal(file["view_angle"][()], TILTS["view_angles"])
        np.testing.assert_allclose(file["tilt_q"][()], 2 * np.pi * np.sin(TILTS["tilts"]))
        self.assertIn(file["memory_effect_range"].attrs["censored"], (0, 1, 2))
        self.call("covariance", **BOX, **PAIRS, samples=4000, out="result.h5")
        stored = datasets(self.folder / "result.h5")
        columns = [stored[f"pair_{what}"] for what in ("light_1", "view_1", "light_2", "view_2")]
        np.testing.assert_array_equal(np.transpose(columns).ravel(), PAIRS["pairs"])

    def test_few_samples_are_enough_for_an_error(self):
        for keys in ({"samples": 1}, {"seconds": 1e-9}, {"samples": 1, "method": "wave"}):
            with self.subTest(keys=keys):
                self.call("covariance", **BOX, **VIEWS, **keys, out="result.h5")
                self.check_finite(self.open())

    def test_errors_that_few_paths_carry_are_marked(self):
        keys = {**SLAB, "optical_depth": 1, **VIEWS, "samples": 40_000}
        for g, marked in ((0.995, True), (0.5, False)):
            with self.subTest(g=g):
                done = self.call("covariance", **{**keys, "g": g}, out="result.h5")
                self.assertEqual("entries with NAME_rare = 1" in done.stderr, marked)
                with self.open() as file:
                    self.assertEqual("intensity_rare" in file, marked)

    def test_few_batches_are_told(self):
        done = self.call("covariance", **BOX, **VIEWS, samples=1, out="result.h5")
        self.assertIn("has only 2 batches", done.stderr)

    def test_nothing_scatters(self):
        for keys in ({"count": 0}, {"count": 0, "method": "wave"}, {"phase_shift": 0}):
            with self.subTest(keys=keys):
                self.call("covariance", **{**BOX, **TILTS, **keys}, samples=50, out="result.h5")
                file = self.open()
                self.assertTrue(np.all(file["covariance"][()] == 0))
                self.check_finite(file)


    def test_wave_samples_count_placements(self):
        for method, samples in (("mc", 4000), ("wave", 12)):
            self.call("covariance", **BOX, samples=4000, wave_samples=12, method=method,
                      out="result.h5")
            self.assertEqual(self.open().attrs["samples"], samples)


class Validate(ResultTest):
    def test_groups(self):
        for name, (keys, estimates) in REQUESTS.items():
            with self.subTest(request=name):
                done = self.call("validate", **{**BOX, **keys}, samples=4000, wave_samples=12,
                                 out="result.h5")
                self.assertIn("combined standard errors", done.stdout)
                file = self.open()
                for group in ("mc/", "wave/"):
                    for estimate in estimates:
                        self.assertEqual(file[group + estimate].shape,
                                         file[group + estimate + "_error"].shape)
                    self.check_trace(file, group)
                self.check_scales(file)
                self.check_provenance(file, MEDIUM, "validate")
                self.check_finite(file)
                self.check_again("validate")

    def test_a_fixed_count_and_the_forward_lobe(self):
        """The note appears for views within wavelength/width = 0.05 of the light, such as sin 0.04."""
        poisson, disks = {**BOX, "count": None, "density": 0.155}, {**BOX, "scatterer": "soft"}
        for scene, view, said in ((BOX, 0.04, True), (BOX, -0.04, True), (BOX, 0.06, False),
                                  (BOX, np.pi, False), (poisson, 0.04, False),
                                  ({**disks, "radius": 0.1}, 0.04, False)):
            with self.subTest(scene=scene, view=view):
                done = self.call("validate", **scene, view_angles=[1, view], samples=400,
                                 wave_samples=2, out="result.h5")
                self.assertEqual("density instead of count" in done.stdout, said)

    def test_a_group_is_what_covariance_gives(self):
        scene = {**BOX, **REQUESTS["intensity"][0]}
        self.call("validate", **scene, samples=4000, wave_samples=12, out="both.h5")
        self.call("covariance", **scene, samples=4000, out="mc.h5")
        self.call("covariance", **scene, samples=12, method="wave", out="wave.h5")
        both = datasets(self.folder / "both.h5")
        for method in ("mc", "wave"):
            alone = datasets(self.folder / f"{method}.h5")["intensity"]
            np.testing.assert_array_equal(both[f"{method}/intensity"], alone)


class Sweep(ResultTest):
    def test_shapes(self):
        done = self.call("sweep", **SWEEP, out="result.h5")
        self.assertEqual(len(done.stdout.splitlines()), 1 + 2 * 3 * 2 + 2)
        file = self.open()
        extents = {"optical_depth": 2, "g": 3, "albedo": 2, "tilt": 4}
        grid = ("optical_depth", "g", "albedo")
        self.check_estimate(file, "field_correlation", REAL, (*grid, "tilt"), extents)
        self.check_estimate(file, "memory_effect_range", REAL, grid, extents)
        self.assertEqual(file["range_censored"].shape, (2, 3, 2))
        np.testing.assert_allclose(file["field_correlation"][..., 0], 1, rtol=1e-12)
        np.testing.assert_allclose(file["k_mean_free_path"][:, 2, 1],
                                   2 * np.pi * 100 / np.array([1, 2]))
        for name in ("optical_depth", "g", "albedo"):
            np.testing.assert_array_equal(file[name][()], SWEEP[name])
        self.check_scales(file)
        self.check_provenance(file, [], "sweep")
        self.check_finite(file)
        self.assertEqual(set(file["trace/of_point"][()]), set(range(12)))
        self.check_again("sweep")

    def test_a_point_is_what_covariance_gives(self):
        """Compares the point at optical depth 2, g = -0.2, albedo 0.9."""
        self.call("sweep", **SWEEP, out="sweep.h5")
        self.call("covariance", out="point.h5", **{**SLAB, **SWEEP, "covariance": "memory_effect",
                                                   "optical_depth": 2, "g": -0.2, "albedo": 0.9})
        sweep, point = datasets(self.folder / "sweep.h5"), datasets(self.folder / "point.h5")
        for name in ("field_correlation", "field_correlation_error"):
            np.testing.assert_array_equal(sweep[name][1, 2, 1], point[name])
        self.assertAlmostEqual(sweep["memory_effect_range"][1, 2, 1],
                               point["memory_effect_range"])


class Solve(ResultTest):
    def test_shapes(self):
        for keys, name, axes in (({**LIGHTS, **VIEWS}, "far_field", LV),
                                 ({**LIGHTS, **SENSORS}, "near_field", LS)):
            with self.subTest(field=name):
                self.call("solve", **CYLINDERS, **keys, out="result.h5")
                file = self.open()
                self.assertEqual(file[name].dtype, COMPLEX)
                self.assertEqual(file[name].shape, tuple(EXTENTS[axis] for axis in axes))
                self.assertEqual([dim[0].name for dim in file[name].dims], ["/" + a for a in axes])
                for scalar in ("residual", "condition"):
                    self.assertEqual(file[f"solve/{scalar}"].shape, ())
                self.assertEqual(file["solve/basis_order"].shape, (CYLINDERS["count"],))
                self.check_scales(file)
                self.check_provenance(file, MEDIUM, "solve")
                self.check_finite(file)
                self.check_again("solve")


if __name__ == "__main__":
    unittest.main()
