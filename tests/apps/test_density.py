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


SPACE = {"dimension": 3, "domain": "box", "width": 20, "height": 12, "depth": 10, "scatterer": "hg", "g": 0.5,
         "mean_free_path": 5, "light_angles": 0.3, "light_azimuths": 1, "view_angles": [0.4, 1.3, 2.6],
         "view_azimuths": [0, 2, -1]}
HOLE_IN_SPACE = "x,z,y,radius,amplitude\n-2,4,1,2,-1\n5,7,-2,1.5,2\n"


def density_in_space(x, y, z):
    return (1 - np.exp(-((x + 2)**2 + (y - 1)**2 + (z - 4)**2) / 8) + 2 * np.exp(
        -((x - 5)**2 + (y + 2)**2 + (z - 7)**2) / 4.5))


def middles(low, high, cells):
    return low + (high - low) * (np.arange(cells) + 0.5) / cells


def grid_in_space(cells):
    """Midpoints of cells^3 cells of the box in space, [z][y][x]."""
    z, y, x = np.meshgrid(middles(0, 10, cells), middles(-6, 6, cells), middles(-10, 10, cells), indexing="ij")
    return x, y, z


def depth_along(place, w, steps):
    """Integral of the density in space from places in the box to its edge, along w."""
    with np.errstate(divide="ignore"):
        to_edge = [np.where(c > 0, (high - p) / c, (low - p) / c)
                   for p, c, low, high in zip(place, w, (-10, -6, 0), (10, 6, 10)) if c != 0]
    length = np.minimum.reduce(to_edge)
    return sum(density_in_space(*(p + c * length * t for p, c in zip(place, w)))
               for t in middles(0, 1, steps)) * length / steps


def mean_passing(light, out, cells):
    """Mean of the density times the attenuation of light that is scattered once in the box in space."""
    place = grid_in_space(cells)
    depth = depth_along(place, -light, 2 * cells) + depth_along(place, out, 2 * cells)
    return np.mean(density_in_space(*place) * np.exp(-depth / SPACE["mean_free_path"]))


def direction(angle, azimuth):
    return np.array([np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth), np.cos(angle)])


class Density(ProgramTest):
    def intensity(self, scene=BOX, **keys):
        self.call("covariance", **{**scene, **keys}, out="result.h5")
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

    def test_cells_in_space_agree_with_blobs(self):
        self.write("hole.csv", HOLE_IN_SPACE)
        write_cells(self.folder / "hole.h5", density_in_space(*grid_in_space(32)))
        blobs, error = self.intensity(SPACE, samples=40000, density_blobs="hole.csv")
        cells, own = self.intensity(SPACE, samples=40000, density_map="hole.h5", seed=2)
        self.assertTrue(np.all(np.abs(cells - blobs) < 4 * np.hypot(error, own)))
        self.assertTrue(np.all(own < 0.02 * blobs))

    def test_single_scattering_in_space_agrees_with_an_integral(self):
        self.write("hole.csv", HOLE_IN_SPACE)
        albedo = 1e-4
        found, error = self.intensity(SPACE, albedo=albedo, samples=40000, density_blobs="hole.csv")
        g, light = SPACE["g"], direction(0.3, 1)
        for view, (angle, azimuth) in enumerate(zip(SPACE["view_angles"], SPACE["view_azimuths"])):
            out = direction(angle, azimuth)
            phase = (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * light @ out)**1.5)
            # the midpoint rule has an error in proportion to the square of the cells' size
            passing = (4 * mean_passing(light, out, 40) - mean_passing(light, out, 20)) / 3
            expected = albedo / 5 * phase * passing * 20 * 12 * 10
            self.assertLess(abs(found[0, view] - expected), 4 * error[0, view] + 2e-3 * expected)
            self.assertLess(error[0, view], 0.01 * expected)

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


    def test_power_is_conserved_in_space(self):
        self.write("hole.csv", HOLE_IN_SPACE)
        scene = {key: value for key, value in SPACE.items() if not key.startswith("view")}
        self.call("flux", **scene, albedo=0.9, density_blobs="hole.csv", samples=20000, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            shares = ("reflectance", "transmittance", "side_loss", "absorptance", "direct_transmittance")
            np.testing.assert_allclose(sum(file[name][()] for name in shares), 1, atol=0.01)
            x, z = file["map_density_x"][()], file["map_density_z"][()]
            np.testing.assert_allclose(file["relative_density"][()], density_in_space(x, 0, z[:, None]), atol=1e-12)


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

    def test_axes(self):
        self.check(["\"y\""], HOLE_IN_SPACE)
        for axes, scene in ((3, BOX), (2, SPACE)):
            write_cells(self.folder / "map.h5", np.ones(axes * [2]))
            self.check(["axes"], density_blobs=None, density_map="map.h5", **{"density": None, **scene})

    def test_cells(self):
        for density in (np.full((2, 2), -1.0), np.zeros((2, 2)), np.ones(3), np.full((2, 2), np.nan)):
            write_cells(self.folder / "map.h5", density)
            self.check(["map.h5"], density_blobs=None, density_map="map.h5")
        self.check(["one of them"], density_map="map.h5")


if __name__ == "__main__":
    unittest.main()
