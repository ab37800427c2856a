"""Suspensions: amounts of particles by their keys, coefficients in files, the printed line."""

import math
import unittest

import h5py

from program import ProgramTest

# 1 um polystyrene in water, 633 nm in vacuum, 1 % by mass, in a cell of 1 mm; lengths in um
MEDIUM_INDEX, PARTICLE_INDEX, VACUUM_WAVELENGTH, MASS_FRACTION = 1.33, 1.59, 0.633, 0.01
POLYSTYRENE = {"domain": "slab", "dimension": 3, "scatterer": "mie", "length_unit": "um",
               "wavelength": VACUUM_WAVELENGTH / MEDIUM_INDEX, "depth": "1mm", "diameter": "1um",
               "index": PARTICLE_INDEX / MEDIUM_INDEX, "mass_fraction": MASS_FRACTION,
               "particle_density": 1.05, "medium_density": 1}


def efficiencies(x, m):
    """Returns Q_ext, Q_sca and g by Mie's series with logarithmic derivatives (as BHMIE)."""
    last = int(x + 4 * x ** (1 / 3) + 12)
    derivative = [0j] * (max(last, int(abs(m * x))) + 16)
    for n in range(len(derivative) - 1, 0, -1):
        derivative[n - 1] = n / (m * x) - 1 / (derivative[n] + n / (m * x))
    outgoing = [complex(math.cos(x), math.sin(x)), complex(math.sin(x), -math.cos(x))]
    extinction = scattering = cosine = 0
    before = 0, 0
    for n in range(1, last + 1):
        outgoing.append((2 * n - 1) * outgoing[n] / x - outgoing[n - 1])
        xi, lower = outgoing[n + 1], outgoing[n]
        a, b = (((factor + n / x) * xi.real - lower.real) / ((factor + n / x) * xi - lower)
                for factor in (derivative[n] / m, derivative[n] * m))
        extinction += (2 * n + 1) * (a + b).real
        scattering += (2 * n + 1) * (abs(a) ** 2 + abs(b) ** 2)
        cosine += (2 * n + 1) / (n * (n + 1)) * (a * b.conjugate()).real
        cosine += (n * n - 1) / n * (before[0] * a.conjugate() + before[1] * b.conjugate()).real
        before = a, b
    return 2 / x**2 * extinction, 2 / x**2 * scattering, 2 * cosine / scattering


class Suspensions(ProgramTest):
    def attributes(self, *command, **keys):
        self.printed = self.call(*command, **keys, out="x.h5").stdout
        with h5py.File(self.folder / "x.h5") as file:
            return dict(file.attrs)

    def assert_close(self, attributes, known, relative=1e-9):
        for name, value in known.items():
            self.assertAlmostEqual(attributes[name] / value, 1, delta=relative, msg=name)

    def test_polystyrene_in_water(self):
        x = math.pi * MEDIUM_INDEX / VACUUM_WAVELENGTH
        extinction, scattering, g = efficiencies(x, complex(PARTICLE_INDEX / MEDIUM_INDEX))
        volumes = MASS_FRACTION / 1.05, 1 - MASS_FRACTION
        fraction = volumes[0] / sum(volumes)
        density = fraction / (math.pi / 6)
        mu_s = density * math.pi / 4 * scattering
        known = {"diameter": 1, "size_parameter": x, "scattering_efficiency": scattering,
                 "extinction_efficiency": extinction, "sigma_s": math.pi / 4 * scattering,
                 "sigma_e": math.pi / 4 * extinction, "g": g, "density": density,
                 "packing_fraction": fraction, "mu_s": mu_s, "mu_t": mu_s,
                 "reduced_scattering": mu_s * (1 - g), "mean_free_path": 1 / mu_s,
                 "transport_mean_free_path": 1 / (mu_s * (1 - g)),
                 "k_mean_free_path": 2 * x / mu_s, "optical_depth": 1000 * mu_s}
        for command in ("flux", "covariance"):
            found = self.attributes(command, **POLYSTYRENE, tolerance=1e-3)
            self.assert_close(found, known)
            self.assertIn("suspension: diameter 1, volume fraction 0.0095283, mu_s' 0.0030827, "
                          "l* 324.4\n", self.printed)
        self.assertIn("reduced_scattering = 0.00308", self.call("explain", "x.h5").stdout)

    def test_keys_of_the_density_agree(self):
        by_mass = self.attributes("flux", **POLYSTYRENE)
        one = {key: value for key, value in POLYSTYRENE.items()
               if key not in ("mass_fraction", "particle_density", "medium_density")}
        density = by_mass["density"]
        for amount in ({"volume_fraction": by_mass["packing_fraction"]}, {"density": density},
                       {"density": f"{density * 1e9:.15g}/mm^3"},
                       {"optical_depth": by_mass["optical_depth"]}):
            found = self.attributes("flux", **one, **amount)
            self.assert_close(found, {name: by_mass[name] for name in
                                      ("density", "mu_s", "packing_fraction")}, 1e-12)

    def test_order_of_a_dense_suspension(self):
        dense = {"domain": "slab", "dimension": 3, "scatterer": "mie", "depth": 20, "radius": 0.05,
                 "index": 1.2, "volume_fraction": 0.3, "tolerance": 1e-3}
        alone = self.attributes("flux", **dense)
        self.assertIn("extinction_efficiency", alone)
        correlated = self.attributes("flux", **dense, structure="hard_spheres")
        self.assert_close(correlated, {name: alone[name] for name in ("sigma_s", "density")})
        # For spheres much smaller than the wavelength, scattering is multiplied by nearly S(0) = 0.094.
        self.assertTrue(0.094 < correlated["mu_s"] / alone["mu_s"] < 0.13)
        self.assertIn("spheres fill 0.3", self.call("covariance", **dense, out="y.h5").stderr)
        self.assertNotIn("spheres fill", self.call("covariance", **dense, structure="hard_spheres",
                                                   out="z.h5").stderr)

    def test_cylinders(self):
        disks = {"domain": "slab", "depth": 50, "scatterer": "te", "diameter": 0.4, "index": 1.3}
        found = self.attributes("covariance", **disks, volume_fraction=0.1, structure="hard_disks")
        self.assert_close(found, {"density": 0.1 / (math.pi * 0.04), "packing_fraction": 0.1,
                                  "scattering_efficiency": found["sigma_s"] / 0.4})
        self.assertIn("suspension: diameter 0.4, area fraction 0.1", self.printed)


if __name__ == "__main__":
    unittest.main()
