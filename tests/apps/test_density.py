"""Density maps in boxes: Gaussian blobs and cells."""

import unittest

import h5py
import numpy as np

from program import WHOLE, ProgramTest
from refusing import RefusingTest

BOX = {"domain": "box", "width": 20, "depth": 10, "density": 0.155, "light_angles": 0,
       "view_angles": [0.4, 0.8, 1.3, 2, 2.6, 3.14159]}
HOLE = "x,z,radius,amplitude\n-2,4,2,-1\n5,7,1.5,2\n"


def write_cells(path, density):
    with h5py.File(path, "w") as file:
        file["relative_density"] = np.asarray(density, dtype=float)


def checkered():
    cells = np.ones((5, 8))
    cells[1:3, 2:5] = 0
    cells[3, 6] = 3
    return cells


class Density(ProgramTest):
    def intensity(self, **keys):
        self.call("covariance", **BOX, **keys, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            return file["intensity"][()], file["intensity_error"][()]

    def test_a_constant_map_equals_none(self):
        self.write("flat.csv", "x,z,radius,amplitude\n0,5,2,0\n")
        write_cells(self.folder / "flat.h5", np.ones((3, 4)))
        without, error = self.intensity(samples=100000)
        for key, name in (("density_blobs", "flat.csv"), ("density_map", "flat.h5")):
            found, own = self.intensity(samples=100000, seed=2, **{key: name})
            self.assertTrue(np.all(np.abs(found - without) < 4 * np.hypot(error, own)))
            self.assertTrue(np.all(own < 0.01 * without))

    def test_holes_agree_with_exact_placements(self):
        self.write("hole.csv", HOLE)
        write_cells(self.folder / "hole.h5", checkered())
        for key, name in (("density_blobs", "hole.csv"), ("density_map", "hole.h5")):
            self.call("validate", **BOX, **{key: name}, samples=100000, wave_samples=6000 if WHOLE else 3000,
                      wave_tolerance=1e-3, out="result.h5")
            with h5py.File(self.folder / "result.h5") as file:
                mc, exact = file["mc/intensity"][()], file["wave/intensity"][()]
                error = np.hypot(file["mc/intensity_error"], file["wave/intensity_error"])
                allowed = 4 * error + file.attrs["bias_allowance"] * exact
                self.assertTrue(np.all(np.abs(mc - exact) < allowed), (mc, exact, error))
                self.assertTrue(np.all(error < 0.03 * exact))

    def test_power_is_conserved(self):
        self.write("hole.csv", HOLE)
        self.call("flux", domain="box", width=20, depth=10, scatterer="hg", g=0.5, albedo=0.9,
                  mean_free_path=2, density_blobs="hole.csv", light_angles=[0, 0.5], samples=20000,
                  out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            shares = ("reflectance", "transmittance", "side_loss", "absorptance", "direct_transmittance")
            np.testing.assert_allclose(sum(file[name][()] for name in shares), 1, atol=0.01)
            x, z = file["map_density_x"][()], file["map_density_z"][()]
            density = file["relative_density"][()]
            expected = 1 - np.exp(-((x + 2)**2 + (z[:, None] - 4)**2) / 8) + 2 * np.exp(
                -((x - 5)**2 + (z[:, None] - 7)**2) / 4.5)
            np.testing.assert_allclose(density, expected, atol=1e-12)


class Refused(RefusingTest):
    def check(self, words, table=HOLE, **changes):
        self.write("map.csv", table)
        with self.subTest(table=table, **changes):
            self.assert_refused(words, "covariance", **{**BOX, "density_blobs": "map.csv", "samples": 400,
                                                        **changes})

    def test_blobs(self):
        self.check(["amplitude", "-1"], "x,z,radius,amplitude\n0,0,1,-0.7\n1,1,1,-0.4\n")
        self.check(["radius = 0"], "x,z,radius,amplitude\n0,0,0,1\n")
        self.check(["amplitude"], "x,z,radius\n0,0,1\n")
        self.check(["box"], domain="slab", width=None)
        self.check(["count"], density=None, count=31)
        self.check(["equilibrium"], method="wave", scatterer="tm", radius=0.2, placement="equilibrium")

    def test_cells(self):
        for density in (np.full((2, 2), -1.0), np.zeros((2, 2)), np.ones(3), np.full((2, 2), np.nan)):
            write_cells(self.folder / "map.h5", density)
            self.check(["map.h5"], density_blobs=None, density_map="map.h5")
        self.check(["one of them"], density_map="map.h5")


if __name__ == "__main__":
    unittest.main()
