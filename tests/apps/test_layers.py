"""Media of layers, from a CSV file."""

import re
import unittest

import h5py
import numpy as np

from program import ERRORS, WHOLE, ProgramTest
from refusing import RefusingTest

POINTS = "thickness,density\n3,0.05\n3,0.25\n4,0.15\n"
TISSUE = "thickness,optical_depth,g,albedo\n20,2,0.9,0.99\n30,3,0.7,0.9\n10,1,0,1\n"
BOX = {"domain": "box", "width": 20, "layers": "layers.csv", "light_angles": 0}
SLAB = {"domain": "slab", "layers": "layers.csv", "scatterer": "hg", "samples": 4000}


class Layers(ProgramTest):
    def test_layers_of_points_agree_with_exact_placements(self):
        self.write("layers.csv", POINTS)
        self.call("validate", **BOX, view_angles=[0.4, 0.8, 1.3, 2, 2.6, 3.14159], samples=100000,
                  wave_samples=6000, wave_tolerance=1e-3, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            mc, exact = file["mc/intensity"], file["wave/intensity"]
            error = np.hypot(file["mc/intensity_error"], file["wave/intensity_error"])
            allowed = 4 * error + file.attrs["bias_allowance"] * exact[()]
            self.assertTrue(np.all(np.abs(mc[()] - exact[()]) < allowed))
            self.assertTrue(np.all(error < 0.03 * exact[()]))

    def test_layers_of_disks_agree_with_exact_placements(self):
        self.write("layers.csv", "thickness,density,radius\n3,0.1,0.2\n3,0.4,0.1\n4,0.2,0.2\n")
        self.call("validate", **BOX, scatterer="tm", index=1.3, view_angles=[0.6, 1, 2, 2.6], samples=40000,
                  wave_samples=3000 if WHOLE else 400, wave_tolerance=1e-3, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            mc, exact = file["mc/intensity"], file["wave/intensity"]
            error = np.hypot(file["mc/intensity_error"], file["wave/intensity_error"])
            allowed = 4 * error + file.attrs["bias_allowance"] * exact[()]
            self.assertTrue(np.all(np.abs(mc[()] - exact[()]) < allowed))
            self.assertTrue(np.all(error < 0.05 * ERRORS * exact[()]))

    def test_transport_agrees_with_paths_and_is_swept(self):
        self.write("layers.csv", TISSUE)
        slab = {**SLAB, "samples": 20000, "light_angles": 0.2, "view_angles": [0.1, 0.9, 2, 2.9]}
        self.call("validate", **slab, tolerance=1e-3, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            mc, exact = file["mc/intensity"][()], file["transport/intensity"][()]
            self.assertTrue(np.all(np.abs(mc - exact) < 4 * file["mc/intensity_error"][()] + 1e-3 * exact))
        self.write("layers.csv", "thickness,optical_depth\n20,2\n10,0.5\n")
        self.call("sweep", layers="layers.csv", method="transport", g=[0, 0.5], tilts=[0, 0.002, 0.01], tolerance=1e-3,
                  out="sweep.h5")
        with h5py.File(self.folder / "sweep.h5") as file:
            self.assertEqual(file["field_correlation"].size, 6)

    def test_clear_layers_of_air_or_water_do_not_change_the_decay_of_water_in_air(self):
        water = {"dimension": 3, "domain": "slab", "length_unit": "um", "wavelength": "633nm", "scatterer": "hg",
                 "g": 0.5, "view_angles": [0, 3.14159], "delays": [0, 1e-4, 1e-3], "diffusion": "1e-12 m^2/s",
                 "method": "transport", "tolerance": 1e-3}
        self.call("covariance", **water, depth=1000, optical_depth=4, medium_index=1.33, out="water.h5")
        for clear in 1, 1.33:
            self.write("layers.csv",
                       f"thickness,optical_depth,medium_index\n30,0,{clear}\n1000,4,1.33\n70,0,{clear}\n")
            self.call("covariance", **water, layers="layers.csv", out="layers.h5")
            with h5py.File(self.folder / "layers.h5") as layers, h5py.File(self.folder / "water.h5") as alone:
                # k^2 D is that in vacuum
                self.assertAlmostEqual(layers["delay"].attrs["k2_diffusion"] * 1.33**2,
                                       alone["delay"].attrs["k2_diffusion"], delta=1e-9)
                np.testing.assert_allclose(layers["field_correlation"], alone["field_correlation"], rtol=1e-3)
                self.assertLess(np.min(alone["field_correlation"]), 0.8)

    def test_transport_knows_flux_and_delays(self):
        self.write("layers.csv", TISSUE)
        self.call("flux", domain="slab", layers="layers.csv", scatterer="hg", method="transport", tolerance=1e-5,
                  out="flux.h5")
        with h5py.File(self.folder / "flux.h5") as file:
            self.assertAlmostEqual(file["reflectance"][0], 0.286583, delta=3e-6)
            self.assertAlmostEqual(file["transmittance"][0], 0.294708, delta=3e-6)
        found = []
        for keys in ({"method": "transport", "tolerance": 1e-4}, {"method": "mc", "samples": 20000}):
            self.call("covariance", domain="slab", layers="layers.csv", scatterer="hg", view_angles=[0.3, 2.5],
                      delays=[0, 0.01, 0.05], diffusion=2, **keys, out="delays.h5")
            with h5py.File(self.folder / "delays.h5") as file:
                found.append((file["field_correlation"][()], file["field_correlation_error"][()]))
        (exact, _), (mc, error) = found
        self.assertTrue(np.all(np.abs(mc - exact) <= 4 * error + 1e-4), (mc, exact, error))

    def test_results_have_no_theory_of_uniform_slabs(self):
        self.write("walls.csv", "thickness,optical_depth,medium_index\n100,0,1.5\n20,2,1.33\n100,0,1.5\n")
        slab = {"domain": "slab", "layers": "walls.csv", "scatterer": "hg", "g": 0.5, "light_angles": 0, "view_angles": 0.1,
                "method": "transport", "tolerance": 1e-2}
        self.call("covariance", **slab, covariance="memory_effect", tilts=[0, 0.001], out="result.h5")
        self.write("layers.csv", "thickness,optical_depth\n20,2\n10,0.5\n")
        layers = {**slab, "layers": "layers.csv"}
        self.call("covariance", **layers, delays=[0, 0.1], out="delays.h5")
        self.call("covariance", **{**layers, **BOX, "method": "mc", "tolerance": None}, samples=100, covariance="tilt_shift",
                  tilts=[0, 0.002], shifts=[0, 0.01], out="map.h5")
        self.call("sweep", layers="layers.csv", method="transport", g=[0, 0.5], tilts=[0, 0.002], tolerance=1e-2, out="sweep.h5")
        for name in ("result", "delays", "map", "sweep"):
            with h5py.File(self.folder / f"{name}.h5") as file:
                self.assertFalse([one for one in (*file, *file.attrs) if re.search("theory|single_scatt|diffusion_r|extrapol", one)])
        told = self.call("explain", "result.h5").stdout
        self.assertIn("means over the depth of all layers", told)
        self.assertRegex(told, r"layer +thickness +optical depth +g +albedo +index +l\*\n(.*\n)  1 +20 +2 +0.5 +1 +1.33 +20\n")

    def test_clear_layers_change_nothing(self):
        """Clear layers change nothing for light without phases."""
        found = []
        for table in ("thickness,optical_depth\n4,0\n3,2\n5,0\n3,1\n", "thickness,optical_depth\n3,2\n3,1\n"):
            self.write("layers.csv", table)
            self.call("flux", domain="slab", layers="layers.csv", scatterer="hg", g=0.5, method="transport",
                      out="flux.h5")
            with h5py.File(self.folder / "flux.h5") as file:
                found.append([file[name][0] for name in ("reflectance", "transmittance")])
        np.testing.assert_allclose(*found, rtol=1e-9)

    def test_what_is_in_the_file(self):
        self.write("layers.csv", TISSUE)
        self.call("flux", **SLAB, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            np.testing.assert_allclose(file["layer_thickness"], [20, 30, 10])
            np.testing.assert_allclose(file["layer_optical_depth"], [2, 3, 1])
            np.testing.assert_allclose(file["layer_g"], [0.9, 0.7, 0])
            np.testing.assert_allclose(file["layer_albedo"], [0.99, 0.9, 1])
            self.assertEqual(file.attrs["depth"], 60)
            self.assertAlmostEqual(file.attrs["optical_depth"], 6)
            total = sum(file[name][0] for name in
                        ("reflectance", "transmittance", "absorptance", "direct_transmittance"))
            self.assertAlmostEqual(total, 1, delta=0.03)

    def test_a_changed_file_is_another_scene(self):
        self.write("layers.csv", TISSUE)
        self.call("covariance", **SLAB, keep_state=True, out="result.h5")
        self.write("layers.csv", TISSUE.replace("0.99", "0.98"))
        self.call("covariance", **{**SLAB, "samples": 8000}, resume=True, out="result.h5", status=2)


class Refused(RefusingTest):
    def check(self, words, table=TISSUE, command="covariance", **changes):
        self.write("layers.csv", table)
        keys = {**SLAB, **changes}
        with self.subTest(table=table, **changes):
            self.assert_refused(words, command, **keys)

    def test_keys_that_the_table_replaces(self):
        self.check(["depth"], depth=5)
        self.check(["optical_depth"], optical_depth=5)
        self.check(["column g", "leave out the key g"], g=0.5)
        self.check(["layer 1", "g"], scatterer="point")

    def test_tables_that_cannot_be(self):
        for table, words in {
                "thickness,optical_depth\n4,-2\n": ["layer 1", "optical_depth", "positive"],
                "thickness,optical_depth\n0,2\n": ["thickness = 0", "positive"],
                "thickness,optical_depth\n4,0\n": ["at least one layer must scatter or absorb"],
                "thickness,optical_depth,density\n1,2,3\n": ["exactly one of"],
                "optical_depth\n1\n": ["column thickness is missing"],
                "thickness,optical_depth\n": ["layers", "1 to 1000"],
                "thickness,optical_depth,g\n1,2,0\n1,2,1.5\n": ["layer 2", "g = 1.5"],
                "thickness,optical_depth,wrong\n1,2,1.5\n": ["wrong", "must be one of"]}.items():
            self.check(words, table)
        self.check(["no such file"], layers="none.csv")

    def test_what_layers_have_not(self):
        self.check(["layers", "gradient", "use method = mc"], method="transport", samples=None, gradient=True)
        points = "thickness,density\n3,0.05\n3,0.25\n"
        disks = {**BOX, "scatterer": "tm", "radius": 0.2}
        self.check(["equilibrium"], points, method="wave", placement="equilibrium", **disks)
        self.check(["structure"], points, structure="hard_disks", **disks)
        self.check(["count"], points, **{**BOX, "scatterer": "point", "count": 5})


if __name__ == "__main__":
    unittest.main()
