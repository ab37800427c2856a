"""flux: shares of power in the result file, rejected input, and resumption after an interruption."""

import unittest

import h5py
import numpy as np

from program import BOX, SLAB, ProgramTest

ESTIMATES = ["reflectance", "transmittance", "direct_transmittance", "absorptance"]


class Flux(ProgramTest):
    def run_flux(self, keys, **more):
        self.call("flux", **keys, light_angles=[0, 0.8], out="x.h5", **more)
        return h5py.File(self.folder / "x.h5")

    def test_shares_add_up(self):
        for keys, sides in ((SLAB | {"albedo": 0.9}, []), (BOX, ["side_loss"])):
            with self.run_flux(keys, target_error=0.01, method="mc") as file:
                total = sum(file[name][:] for name in ESTIMATES + sides)
                error = sum(file[name + "_error"][:] for name in ESTIMATES + sides)
                self.assertTrue(np.all(np.abs(total - 1) <= 4 * error + 1e-12))
                self.assertEqual("side_loss" in file, bool(sides))
                self.assertEqual(file["reflectance"].dims[0][0].name, "/light_angle")
                self.assertIn("without phases", file.attrs["plan"])

    def test_exit_radiance(self):
        with self.run_flux(SLAB, angle_bins=36, samples=20000) as file:
            radiance, angle = file["exit_radiance"][:], file["exit_angle"][:]
            error = file["exit_radiance_error"][:]
            self.assertEqual(radiance.shape, (2, 36))
            through = np.sum(radiance[:, np.cos(angle) > 0], axis=1) * 2 * np.pi / 36
            spread = 36 * np.max(error) * 2 * np.pi / 36
            self.assertTrue(np.all(np.abs(through - file["transmittance"][:]) < spread))

    def test_agrees_with_render(self):
        """Counted paths through a slab of tissue under air, whose control variates leave 1/100 of the variance."""
        with self.run_flux({"domain": "slab", "dimension": 3, "scatterer": "hg", "g": 0.9, "depth": 10, "albedo": 10 / 10.01,
                            "mean_free_path": 1 / 10.01, "medium_index": 1.37, "polarisation": "unpolarised"}) as file:
            transmitted = file["transmittance"][0]
            reflected = file["reflectance"][0] + file["specular_reflectance"][0]
        self.call("render", stage_box=[-60, -60, -0.001, 60, 60, 10.001], block=[-60, -60, 0, 60, 60, 10, 1.37, 10, 0.01, 0.9],
                  beam_light=[0, 0, -0.001, 0, 0, 1, 0.1, 1], sensor=["area", "area"], sensor_at=[0, 0, 10.001, 0, 0, -0.001],
                  sensor_up=[1, 0, 0, 1, 0, 0], sensor_size=[119, 119, 119, 119], pixels=[1, 1, 1, 1], method="forward",
                  samples=10000, out="paths.h5")
        with h5py.File(self.folder / "paths.h5") as paths:
            for number, expected, precise in ((1, transmitted, 0.003), (2, reflected, 0.002)):
                value, error = (paths[f"sensors/{number}/total{of}"][()] for of in ("", "_error"))
                self.assertLess(abs(value - expected), 4 * error)
                self.assertLess(error, precise * expected)

    def test_in_space(self):
        """Exit radiance is by polar angle; the slab is van de Hulst's."""
        keys = {"domain": "slab", "depth": 2, "optical_depth": 2, "scatterer": "hg", "g": 0.75,
                "albedo": 0.9, "dimension": 3}
        with self.run_flux(keys, angle_bins=30) as file:
            self.assertAlmostEqual(file["reflectance"][0], 0.09739, delta=5e-6)
            radiance, angle = file["exit_radiance"][:], file["exit_angle"][:]
            through = np.sum(radiance[:, angle < np.pi / 2], axis=1) * np.pi / 30
            np.testing.assert_allclose(through, file["transmittance"][:], rtol=1e-4)
            self.assertEqual(file.attrs["dimension"], 3)
        self.call("flux", **keys, method="mc", target_error=0.005, out="y.h5")
        with h5py.File(self.folder / "y.h5") as file:
            off = abs(file["reflectance"][0] - 0.09739) / file["reflectance_error"][0]
            self.assertLess(off, 4)

    def test_forward_peak_in_space(self):
        keys = {"domain": "slab", "depth": 1, "optical_depth": 1, "scatterer": "hg", "g": 0.999, "dimension": 3}
        with self.run_flux(keys) as file:
            total = sum(file[name][:] for name in ESTIMATES)
            np.testing.assert_allclose(total, 1, rtol=0, atol=1e-9)

    def test_refused(self):
        for keys, words in (({"angle_bins": 0}, "angle_bins = 0"),
                            ({"view_angles": [0.1]}, "view_angles: unknown key"),
                            ({"covariance": "full"}, "covariance: unknown key"),
                            ({"tilts": [0.1]}, "tilts: unknown key; it is a key of covariance, "),
                            ({"method": "wave"}, "must be one of mc transport auto"),
                            ({"light_angles": [2]}, "light_angles = 2")):
            done = self.call("flux", **(SLAB | keys), out="x.h5", status=2)
            self.assertIn(words, done.stderr)
            self.assertEqual(self.listing(), {})

    def test_resume_ends_in_the_same_numbers(self):
        self.call("flux", **SLAB, samples=20000, target_error=1e-9, out="part.h5", status=3)
        self.call("flux", **SLAB, samples=60000, out="part.h5", resume=True)
        self.call("flux", **SLAB, samples=60000, out="whole.h5")
        self.assert_same_data("part.h5", "whole.h5")


if __name__ == "__main__":
    unittest.main()
