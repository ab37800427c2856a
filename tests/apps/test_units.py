"""Lengths with units, and tilts by q L: the same run as with plain numbers."""

import unittest

import h5py
import numpy as np

from program import SLAB, ProgramTest, flags
from refusing import RefusingTest

CURVE = {**SLAB, "covariance": "memory_effect", "method": "transport"}


class UnitsTest(ProgramTest):
    def open(self, name):
        file = h5py.File(self.folder / name)
        self.addCleanup(file.close)
        return file

    def config_of(self, subcommand, **keys):
        return self.call(subcommand, "--print-config", **keys).stdout.splitlines()

    def test_lengths(self):
        printed = self.config_of("covariance", domain="slab", depth="1mm", wavelength="532nm", mean_free_path="0.1 mm",
                                 scatterer="hg", length_unit="um")
        for line in ("depth = 1000", "wavelength = 0.532", "mean_free_path = 100", "length_unit = 1e-06"):
            self.assertIn(line, printed)
        printed = self.config_of("covariance", width="20um", depth="0.01mm", density="0.1/um^2", length_unit="um",
                                 covariance="translation", beam_waist="3um", shifts="0:2um:3")
        for line in ("width = 20", "depth = 10", "density = 0.1", "shifts = [0, 1, 2]"):
            self.assertIn(line, printed)

    def test_divisors(self):
        printed = self.config_of("covariance", **{**SLAB, "depth": "1mm/8", "optical_depth": "1/3"}, wavelength="633nm/1.33",
                                 light_angles="10deg/4", length_unit="um")
        for line in ("depth = 125", "optical_depth = 0.3333333333333333", f"wavelength = {0.633 / 1.33!r}"):
            self.assertIn(line, printed)
        spheres = dict(domain="slab", scatterer="mie", radius=0.5, depth=10, optical_depth=1, dimension=3, light_angles=0,
                       view_angles=0.1, method="transport", tolerance=0.1)
        for index, out in (("1.59/1.33", "ratio.h5"), (1.59 / 1.33, "number.h5")):
            self.call("covariance", **spheres, index=index, out=out)
        self.assert_same_data("ratio.h5", "number.h5")

    def test_note_on_the_plane(self):
        """Printed once, for scenes of a laboratory that could be in space."""
        note = "note: the scene is in the plane (2D)"
        scene = {**SLAB, "method": "transport", "tolerance": 1e-2, "light_angles": 0, "view_angles": 0.1}
        for changes, count in (({}, 0), ({"length_unit": "um"}, 1), ({"delays": [0, 0.1]}, 1),
                               ({"delays": [0, 0.1], "dimension": 3}, 0),
                               ({"length_unit": "um", "method": "auto", "print-config": True}, 0)):
            done = self.call("covariance", **{**scene, **changes}, out="note.h5")
            self.assertEqual(done.stderr.count(note), count, changes)
        done = self.call("flux", **SLAB, length_unit="um", light_angles=0, out="flux.h5")
        self.assertEqual(done.stderr.count(note), 1)
        done = self.call("sweep", **{**SLAB, "g": [0, 0.5]}, length_unit="um", tilts=[0, 0.01], out="sweep.h5")
        self.assertEqual(done.stderr.count(note), 1)

    def test_swept_and_searched_lengths(self):
        scene = dict(domain="slab", scatterer="hg", g=0.5, optical_depth=2, light_angles=0, view_angles=0.1, samples=2000, length_unit="um")
        self.call("sweep", of="covariance", **scene, vary="depth=0.01mm:40um:2", out="depths.h5")
        np.testing.assert_allclose(self.open("depths.h5")["depth"][()], [10, 40])
        self.call("sweep", of="covariance", **scene, depth=10, vary="wavelength=500nm,1", out="wavelengths.h5")
        np.testing.assert_allclose(self.open("wavelengths.h5")["wavelength"][()], [0.5, 1])
        printed = self.config_of("optimise", of="flux", domain="slab", scatterer="hg", g=0.5, mean_free_path="5um", light_angles=0,
                                 length_unit="um", maximise="reflectance", vary="depth=0.01mm:40um")
        self.assertIn('vary = ["depth=10:40"]', [line.replace("'", '"') for line in printed])

    def test_scene_files_and_inverse_lengths(self):
        self.write("body.toml", 'length_unit = "mm"\nfield = ["homogeneous"]\nstage_box = ["-1cm", "-10", "-10", "1cm", "10", "10mm"]\n'
                                'mu_s = "10/cm"\npoint_light = [0, 0, -5, 1]\nsensor = "area"\nsensor_at = [0, 0, 10]\n'
                                'sensor_size = [1, 1]\npixels = [1, 1]\n')
        printed = self.config_of("render", config="body.toml")
        self.assertIn("mu_s = 1", printed)
        self.assertIn("stage_box = [-10, -10, -10, 10, 10, 10]", printed)
        self.assertIn("length_unit = 0.001", printed)

    def test_tilts_by_q_depth(self):
        self.call("covariance", **CURVE, light_angles=0.2, view_angles=[0.1], q_depths=[0, 0.5, 1], out="q.h5")
        file = self.open("q.h5")
        np.testing.assert_allclose(file["tilt_q"][()] * 100, [0, 0.5, 1], atol=1e-12)
        self.write("again.toml", file.attrs["config"])
        self.call("covariance", config="again.toml", out="again.h5")
        self.assert_same_data("q.h5", "again.h5")
        self.call("sweep", depth=100, optical_depth=[2, 4], g=0.5, q_depths="0:2:5", out="sweep.h5")
        np.testing.assert_allclose(self.open("sweep.h5")["tilt_q"][()] * 100, np.linspace(0, 2, 5), atol=1e-12)

    def test_theory_of_reflection(self):
        """It is that of a semi-infinite slab (Akkermans and Montambaux 2007), close to transport in a thick slab."""
        depth, l, z0 = 1e5, 20, 0.818 * 20
        self.call("covariance", **{**CURVE, "g": 0, "depth": depth, "optical_depth": 5000}, view_angles="pi",
                  tolerance=1e-3, q_depths=[0, 500, 5000, 10000], out="endless.h5")
        Q = np.array([500, 5000, 10000]) / depth
        diffuse = (1 + Q * l - np.exp(-2 * Q * z0)) / (2 * Q * (1 / l + Q)**2) / (np.pi * l**3)
        at_rest = (1 + 2 * 0.818) / (2 * np.pi)
        expected = (1 / (4 * np.pi) + diffuse) / (1 / (4 * np.pi) + at_rest)
        np.testing.assert_allclose(self.open("endless.h5")["reflection_theory"][1:], expected, rtol=2e-3)
        self.call("covariance", **{**CURVE, "g": 0, "optical_depth": 40}, view_angles=[0.1, 2.94], q_depths="0:10:7", out="r.h5")
        file = self.open("r.h5")
        found, theory = file["reflected_field_correlation"][()], file["reflection_theory"][()]
        self.assertLess(found[-1], 0.76)
        np.testing.assert_allclose(theory, found, rtol=0.05)  # as in docs/questions.md
        self.call("covariance", **CURVE, view_angles=0.1, q_depths="0:2:3", out="t.h5")
        self.assertNotIn("reflection_theory", self.open("t.h5"))


CASES = [
    ("covariance", SLAB, {"depth": "1mm"}, ["depth = 1mm", "length_unit = um"]),
    ("covariance", SLAB, {"depth": "1/mm", "length_unit": "um"}, ["depth = 1/mm", "must be a number"]),
    ("covariance", SLAB, {"wavelength": "633/1.33nm", "length_unit": "um"}, ["wavelength = 633/1.33nm", "633nm/1.33"]),
    ("covariance", SLAB, {"wavelength": "633nm/1.33nm", "length_unit": "um"}, ["633nm/1.33nm", "must have no unit"]),
    ("covariance", SLAB, {"light_angles": "5mm", "length_unit": "um"}, ["light_angles = 5mm", "30deg"]),
    ("covariance", SLAB, {"optical_depth": "5mm", "length_unit": "um"}, ["optical_depth = 5mm", "must be a number"]),
    ("covariance", SLAB, {"depth": "5us", "length_unit": "um"}, ["depth = 5us", "1 mm"]),
    ("render", {}, {"point_light": [0, 0, "-5mm", "1mm"], "length_unit": "um"}, ["point_light = 1mm", "must be a number"]),
    ("covariance", SLAB, {"depth": "1mile", "length_unit": "um"}, ["depth = 1mile", "must be a number"]),
    ("covariance", SLAB, {"g": "0.5um", "length_unit": "um"}, ["g = 0.5um", "must be a number"]),
    ("covariance", SLAB, {"length_unit": "inch"}, ["length_unit = inch", "must be um"]),
    ("covariance", SLAB, {"length_unit": "0um"}, ["length_unit = 0", "must be positive"]),
    ("covariance", CURVE, {"q_depths": 1, "tilts": 0.1}, ["tilts, q_depths", "exactly one"]),
    ("covariance", CURVE, {"q_depths": 5000}, ["q_depths = 5000", "beyond the horizon"]),
]


class RefusedTest(RefusingTest):
    def test_units(self):
        for subcommand, scene, changes, words in CASES:
            with self.subTest(changes=changes):
                self.assert_refused(words, subcommand, *flags({**scene, **changes}))


if __name__ == "__main__":
    unittest.main()
