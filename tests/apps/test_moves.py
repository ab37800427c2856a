"""Near sources, beams, tilt-shift maps and translations on the command line."""

import unittest

import h5py
import numpy as np

from program import BOX, WHOLE, ProgramTest

MAP = {**BOX, "covariance": "tilt_shift", "tilts": [0, 0.01, 0.03], "shifts": [-0.1, 0],
       "view_angles": [0.3, 0.5], "samples": 20000}


class Moves(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("source.csv", "x,z\n1,-3\n")
        self.write("sources.csv", "x,z\n1,-3\n2,4\n")
        self.write("sensors.csv", "x,z\n0,13\n3,5\n")

    def open(self, name="result.h5"):
        file = h5py.File(self.folder / name)
        self.addCleanup(file.close)
        return file

    def check_shapes(self, file, shapes, prefix=""):
        for name, shape in shapes.items():
            for dataset in (name, name + "_error"):
                values = file[prefix + dataset][()]
                self.assertEqual(values.shape, shape, dataset)
                self.assertTrue(np.all(np.isfinite(values)), dataset)

    def test_map(self):
        self.call("covariance", **MAP, out="result.h5")
        file = self.open()
        self.check_shapes(file, {
            "covariance": (3, 2, 2), "moved_intensity": (3, 2, 2), "reference_intensity": (2,),
            "field_correlation": (3, 2), "matched_correlation": (3,), "matched_covariance": (3, 2),
            "tilt_range": (), "shift_range": (), "memory_effect_range": ()})
        self.assertEqual(file["shift"].attrs["units"], "1/length")
        self.assertAlmostEqual(file["field_correlation"][0, 1], 1, places=12)
        self.assertAlmostEqual(file["matched_correlation"][0], 1, places=12)
        for theory in ("diffusion_theory", "single_scattering"):
            self.assertEqual(file[theory].shape, (3,))
            self.assertEqual(file[theory][0], 1)
        self.write("again.toml", file.attrs["config"])
        self.call("covariance", config="again.toml", out="again.h5")
        self.assert_same_data("result.h5", "again.h5")

    def test_map_in_reflection_has_no_theory(self):
        self.call("covariance", **{**MAP, "view_angles": [2.9]}, out="result.h5")
        self.assertNotIn("diffusion_theory", self.open())
        self.assertNotIn("single_scattering", self.open())

    def test_views_on_both_sides_are_told_apart(self):
        curve = {**MAP, "covariance": "memory_effect", "shifts": None}
        self.call("covariance", **{**curve, "view_angles": [0.3, 2.9]}, out="both.h5")
        both = self.open("both.h5")
        for views, name in (([0.3], "field_correlation"), ([2.9], "reflected_field_correlation")):
            self.call("covariance", **{**curve, "view_angles": views}, out="one.h5")
            one = self.open("one.h5")
            error = np.hypot(one["field_correlation_error"][()], both[f"{name}_error"][()])
            self.assertTrue(np.all(np.abs(one["field_correlation"][()] - both[name][()])
                                   <= 5 * error))
        self.call("covariance", **{**MAP, "view_angles": [0.3, 2.9]}, out="map.h5")
        self.check_shapes(self.open("map.h5"), {
            "reflected_field_correlation": (3, 2), "reflected_matched_correlation": (3,),
            "reflected_tilt_range": (), "reflected_memory_effect_range": ()})

    def test_tilts_that_are_sought_end_at_twice_the_range(self):
        for medium in ({"domain": "slab", "depth": 100, "optical_depth": 10, "g": 0.8},
                       {"width": 40, "depth": 20, "optical_depth": 4, "g": 0.5, "samples": 20_000 if WHOLE else 8000}):
            self.call("covariance", scatterer="hg", **medium, covariance="memory_effect",
                      light_angles=0.1, view_angles=2.9, tilt_count=9, out="sought.h5")
            file = self.open("sought.h5")
            self.assertEqual(len(file["tilt"]), 9)
            self.assertLess(abs(file["field_correlation"][4]**2 - 0.5), 0.05)
            self.assertEqual(file["memory_effect_range"].attrs["censored"], 0)
            self.write("again.toml", file.attrs["config"])
            self.call("covariance", config="again.toml", out="again.h5")
            self.assert_same_data("sought.h5", "again.h5")

    def test_map_by_both_methods(self):
        self.call("validate", **{**MAP, "wave_samples": 40}, out="result.h5")
        for method in ("mc", "wave"):
            self.check_shapes(self.open(), {"field_correlation": (3, 2),
                                            "matched_correlation": (3,)}, method + "/")
        self.call("covariance", **{**MAP, "samples": 10}, method="wave", out="wave.h5")
        self.check_shapes(self.open("wave.h5"), {"covariance": (3, 2, 2)})

    def test_map_of_near_sensors(self):
        self.call("covariance", **{**MAP, "view_angles": None}, near_sensors="sensors.csv",
                  out="result.h5")
        file = self.open()
        self.check_shapes(file, {"covariance": (3, 2, 2), "field_correlation": (3, 2)})
        self.assertEqual(file["shift"].attrs["units"], "length")
        self.assertNotIn("matched_correlation", file)

    def test_beams(self):
        self.call("covariance", **BOX, beam_waist=2, beam_positions=[0, 3], beam_depth=5,
                  light_angles=[0, 0.2], view_angles=[0.3, 2.9], samples=5000, out="result.h5")
        file = self.open()
        self.check_shapes(file, {"intensity": (4, 2)})
        self.assertEqual(list(file["light_x"]), [0, 3, 0, 3])
        self.assertEqual(list(file["light_angle"]), [0, 0, 0.2, 0.2])
        self.assertEqual(list(file["light_z"]), [5] * 4)
        self.assertEqual(file.attrs["beam_waist"], 2)

    def test_near_sources(self):
        self.call("covariance", **BOX, near_sources="sources.csv", near_sensors="sensors.csv",
                  samples=5000, covariance="full", out="result.h5")
        file = self.open()
        self.check_shapes(file, {"covariance": (2, 2, 2, 2)})
        self.assertEqual(list(file["light_x"]), [1, 2])
        self.assertEqual(list(file["light_z"]), [-3, 4])

    def test_translation(self):
        keys = {**BOX, "covariance": "translation", "shifts": [0, 0.2, 0.5], "samples": 5000}
        self.call("covariance", **keys, near_sources="source.csv", near_sensors="sensors.csv",
                  out="result.h5")
        file = self.open()
        self.check_shapes(file, {"covariance": (3, 2), "field_correlation": (3,),
                                 "translation_range": (), "moved_intensity": (3, 2)})
        self.assertAlmostEqual(file["field_correlation"][0], 1, places=12)
        self.call("covariance", **{**keys, "samples": 10}, method="wave", beam_waist=2,
                  out="wave.h5")
        self.check_shapes(self.open("wave.h5"), {"covariance": (3, 1)})

    def test_printed_curves(self):
        done = self.call("covariance", **{**BOX, "covariance": "memory_effect", "tilts": [0, 0.5],
                                          "view_angles": [0.3], "samples": 4000}, out="result.h5")
        file = self.open()
        field, error = file["field_correlation"][1], file["field_correlation_error"][1]
        row = done.stdout.split("C_I     error\n")[1].splitlines()[1].split()
        for shown, value in zip(row, (0.5, field, error, field**2, 2 * field * error)):
            self.assertAlmostEqual(float(shown), value, delta=0.05 * abs(value))
        done = self.call("covariance", **MAP, out="map.h5")
        self.assertNotIn("light 1", done.stdout)
        self.assertIn("q L at C_I = 1/2", done.stdout)

    def test_other_sources_are_another_run(self):
        keys = {**BOX, "near_sources": "source.csv", "samples": 2000}
        self.call("covariance", **keys, out="result.h5")
        self.write("source.csv", "x,z\n1,-4\n")
        done = self.call("covariance", **{**keys, "samples": 4000}, out="other.h5",
                         resume="result.h5", status=2)
        self.assertEqual(done.stderr.count("\n"), 1)


if __name__ == "__main__":
    unittest.main()
