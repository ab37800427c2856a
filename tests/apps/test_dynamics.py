"""Delays in seconds, frequencies in Hz and linewidths, against diffusion theory and the same runs in plain numbers."""

import unittest

import h5py
import numpy as np

from program import ProgramTest
from refusing import RefusingTest

# 1 mm of isotropic scatterers, l* = 10 um, in space; the faces do not reflect.
DEPTH, MEAN_FREE_PATH, WAVELENGTH = 1000, 10, 0.5
SLAB = {"domain": "slab", "dimension": 3, "depth": DEPTH, "wavelength": WAVELENGTH, "scatterer": "hg",
        "mean_free_path": MEAN_FREE_PATH, "tolerance": 1e-4, "length_unit": "um", "method": "transport"}
AROUND = {**SLAB, "view_angles": [0, "pi"]}
K = 2 * np.pi / WAVELENGTH  # 1/um
LIGHT_SPEED, BOLTZMANN = 299792458e6, 1.380649e-23  # um/s, J/K
IN_GLASS = {"medium_index": 1.5, "outside_index": 1.5, "wavelength": 1.5 * WAVELENGTH}


def root_of(falling, low, high):
    """Returns the zero of a falling function between two positive numbers, by bisection."""
    for _ in range(60):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if falling(middle) > 0 else (low, middle)
    return middle


def diffuse(rate, thickness=DEPTH, length=MEAN_FREE_PATH):
    """Returns f(Q)/f(0) of transmitted light in diffusion theory, with a source at the depth l* and the extrapolation
    length 0.7104 l*; rate: Q."""
    z0 = 0.7104 * length

    def f(q):
        return np.sinh(q * z0) * np.sinh(q * (length + z0)) / (q * np.sinh(q * (thickness + 2 * z0)))
    return f(rate) / f(1e-5 / thickness)


class Delays(ProgramTest):
    def run_delays(self, **keys):
        done = self.call("covariance", **{**AROUND, **keys}, out="delays.h5")
        file = h5py.File(self.folder / "delays.h5")
        self.addCleanup(file.close)
        return done, file

    def test_seconds_are_scaled_delays(self):
        diffusion = 4e-13
        rate = diffusion * 1e12 * K**2
        done, file = self.run_delays(delays=["0", "1us:5ms:25:log"], diffusion="0.4 um^2/s", beta=0.5)
        delay, g1 = file["delay"][()], file["field_correlation"][()]
        np.testing.assert_allclose(delay[[0, 1, -1]], [0, 1e-6, 5e-3], rtol=1e-12)
        self.assertEqual(file["delay"].attrs["units"], "s")
        np.testing.assert_allclose(file["delay"].attrs["diffusion"], diffusion, rtol=1e-12)
        np.testing.assert_allclose(file["delay"].attrs["k2_diffusion"], rate, rtol=1e-12)
        np.testing.assert_allclose(file["intensity_correlation"], 0.5 * g1**2, rtol=1e-12)
        decay = file["decay_time"][()]
        theory = root_of(lambda t: diffuse(np.sqrt(6 * rate * t) / MEAN_FREE_PATH) - np.exp(-1), 1e-7, 1e-2)
        self.assertAlmostEqual(decay[0, 0] / theory, 1, delta=0.02)
        self.assertLess(file["decay_time_error"][0, 0], 0.01 * theory)
        self.assertIn(f"decay time (|g1| = 1/e): {decay[0, 0]:.4g}", done.stdout)
        np.testing.assert_allclose(file["diffusion_theory"][1:10], g1[1:10, 0, 0], rtol=0.02)
        np.testing.assert_allclose(file["reflected_diffusion_theory"][1:10], g1[1:10, 0, 1], rtol=0.05)
        _, plain = self.run_delays(delays=list(rate * delay))
        np.testing.assert_allclose(plain["field_correlation"], g1, rtol=1e-9)
        np.testing.assert_allclose(plain["decay_time"], rate * decay, rtol=1e-9)
        self.assertEqual(plain["delay"].attrs["units"], "1")

    def test_diffusion_of_spheres_in_water(self):
        water = {"temperature": 293.15, "viscosity": "1.0016 mPa s", "delays": ["10us", "1ms"]}
        done, file = self.run_delays(**water, particle_radius="500nm")
        expected = BOLTZMANN * 293.15 / (6 * np.pi * 1.0016e-3 * 0.5e-6)
        self.assertAlmostEqual(expected, 4.28e-13, delta=1e-15)
        np.testing.assert_allclose(file["delay"].attrs["diffusion"], expected, rtol=1e-12)
        self.assertIn("diffusion constant 4.28", done.stdout)
        for size in ({"radius": 0.05}, {"diameter": 0.1}):
            _, file = self.run_delays(**water, scatterer="mie", **size, index=1.2, mean_free_path=100)
            np.testing.assert_allclose(file["delay"].attrs["diffusion"], 10 * expected, rtol=1e-12)

    def test_walks_of_flowing_scatterers_in_seconds(self):
        thin = {**SLAB, "dimension": None, "mean_free_path": None, "optical_depth": 1e-8, "g": 0.3, "method": "mc",
                "tolerance": None, "samples": 4000, "view_angles": [0.5]}
        self.call("covariance", **thin, delays=["1us", "2us"], diffusion="0 m^2/s", velocity=["10mm", 0], out="flow.h5")
        with h5py.File(self.folder / "flow.h5") as file:
            found = file["complex_correlation"][:, 0, 0]
            turn = K * np.sin(0.5) * 1e4 * np.array([1e-6, 2e-6])
            np.testing.assert_allclose(found, np.exp(1j * turn), atol=1e-9)

    def test_decay_beyond_the_delays_is_a_bound(self):
        done, file = self.run_delays(delays=["0.1us", "0.2us"], diffusion="0.4 um^2/s")
        self.assertEqual(file["decay_time_censored"][0, 0], 1)
        np.testing.assert_allclose(file["decay_time"][0, 0], 2e-7, rtol=1e-12)
        self.assertIn("above 2e-07, the largest step", done.stdout)


class Frequencies(ProgramTest):
    def run_shifts(self, **keys):
        done = self.call("covariance", **{**SLAB, **IN_GLASS, **keys}, out="shifts.h5")
        file = h5py.File(self.folder / "shifts.h5")
        self.addCleanup(file.close)
        return done, file

    def test_half_width_in_gigahertz(self):
        done, file = self.run_shifts(frequency_shifts=["0.1GHz:20GHz:21:log"])
        theory = root_of(lambda nu: abs(diffuse(np.sqrt(3j * 1.5 * 2 * np.pi * nu / LIGHT_SPEED / MEAN_FREE_PATH)))**2 - 0.5,
                        1e6, 1e11)
        width = file["frequency_half_width_hz"][0, 0]
        self.assertAlmostEqual(width / theory, 1, delta=0.02)
        optical = LIGHT_SPEED / (1.5 * WAVELENGTH)
        np.testing.assert_allclose(file["frequency_half_width"][0, 0] * optical, width, rtol=1e-12)
        np.testing.assert_allclose(file["frequency_shift_hz"][[0, -1]], [1e8, 2e10], rtol=1e-12)
        self.assertIn(f"half width (C_I = 1/2): {width:.4g}", done.stdout)
        shifts = file["frequency_shift"][()]
        wavelengths = 1.5 * WAVELENGTH / (1 + shifts) - 1.5 * WAVELENGTH  # um
        for texts in ([f"{change:.15g}um" for change in wavelengths],
                      [f"{shift / (1.5 * WAVELENGTH):.15g}/um" for shift in shifts]):
            other = self.run_shifts(frequency_shifts=texts)[1]
            np.testing.assert_allclose(other["frequency_shift"], shifts, rtol=1e-9)
        plain = self.run_shifts(frequency_shifts=list(shifts), medium_index=None, outside_index=None,
                                wavelength=WAVELENGTH)[1]
        np.testing.assert_allclose(plain["frequency_half_width"], file["frequency_half_width"], rtol=1e-9)
        self.assertNotIn("frequency_half_width_hz", plain)

    def test_contrast_of_sources(self):
        keys = {"frequency_shifts": ["1MHz:80GHz:31:log"]}
        done, file = self.run_shifts(**keys, linewidths=["1MHz", "3GHz", "20GHz"])
        self.assertIn("C^2", done.stdout)
        np.testing.assert_allclose(file["linewidth_hz"], [1e6, 3e9, 2e10], rtol=1e-12)
        squares, errors = file["squared_source_contrast"][:, 0, 0], file["squared_source_contrast_error"][:, 0, 0]
        self.assertAlmostEqual(squares[0], 1, delta=1e-4)
        x = np.append(0, file["frequency_shift_hz"][()])
        correlation = np.append(1, np.abs(file["frequency_correlation"][:, 0, 0])**2)
        fine = np.linspace(0, 300, 200001)**2 * 8e10 / 9e4
        curve = np.exp(np.interp(np.sqrt(fine), np.sqrt(x), np.log(correlation)))
        for width, square, error in zip((3e9, 2e10), squares[1:], errors[1:]):
            weight = np.exp(-2 * np.log(2) * (fine / width)**2)
            self.assertAlmostEqual(square, np.trapz(curve * weight, fine) / np.trapz(weight, fine), delta=0.02 * square)
            self.assertLess(error, 5e-3 * square)
        places = np.linspace(-10, 10, 401)
        self.write("line.csv", "frequency,power\n" + "".join(
            f"{4e14 + 1e9 * at:.17g},{np.exp(-4 * np.log(2) * (at / 3)**2):.17g}\n" for at in places))
        table = self.run_shifts(**keys, line_shape="table", line_table="line.csv")[1]
        np.testing.assert_allclose(table["linewidth_hz"], [3e9], rtol=1e-3)
        np.testing.assert_allclose(table["squared_source_contrast"][0, 0, 0], squares[1], rtol=1e-3)

    def test_shifts_that_end_early_are_reported(self):
        done, file = self.run_shifts(frequency_shifts=["0.1GHz:0.5GHz:6:log"], linewidths=["5GHz"], line_shape="lorentzian")
        self.assertIn("add larger shifts", done.stderr)
        self.assertGreater(file["squared_source_contrast_error"][0, 0, 0], 0.1)
        self.assertEqual(file["frequency_half_width_censored"][0, 0], 1)


SECONDS = {"delays": ["1us", "1ms"]}
WATER = {"temperature": 293, "viscosity": 1e-3}
CASES = [
    (SECONDS, ["delays = 1us", "diffusion in m^2/s"]),
    ({**SECONDS, "diffusion": 2}, ["delays = 1us", "diffusion in m^2/s"]),
    ({**SECONDS, "diffusion": "1e-12 m/s"}, ["diffusion = 1e-12 m/s", "4.3e-13 m^2/s"]),
    ({**SECONDS, "diffusion": "-1e-12 m^2/s"}, ["diffusion = -1e-12 m^2/s", "must not be negative"]),
    ({**SECONDS, "diffusion": "1e-12 m^2/s", "length_unit": None}, ["diffusion = 1e-12 m^2/s", "length_unit"]),
    ({**SECONDS, **WATER, "diffusion": 1, "particle_radius": 1}, ["diffusion, temperature", "only one"]),
    ({**SECONDS, **WATER}, ["temperature = 293", "particle_radius"]),
    ({**SECONDS, "temperature": 293, "particle_radius": 1}, ["requires viscosity"]),
    ({"delays": [1], "viscosity": 1e-3}, ["viscosity = 0.001", "delays"]),
    ({"delays": [1], "particle_radius": 1}, ["particle_radius = 1", "delays"]),
    ({"delays": [1, 2, 3, 4, 5], "exposures": ["4us"]}, ["exposures = 4us", "diffusion in m^2/s"]),
    (WATER, ["temperature = 293", "delays"]),
    ({"diffusion": "1e-12 m^2/s"}, ["diffusion = 1e-12 m^2/s", "delays"]),
    ({"delays": [0, 1], "beta": 2}, ["beta = 2", "(0, 1]"]),
    ({"delays": [0, 1], "beta": 0.5, "covariance": "memory_effect", "tilts": [0, 0.01]}, ["beta = 0.5", "intensity"]),
    ({"delays": ["-1"]}, ["delays = -1", "must not be negative"]),
    ({"frequency_shifts": ["1GHz"]}, ["frequency_shifts = 1GHz", "medium_index"]),
    ({"frequency_shifts": ["1GHz"], **IN_GLASS, "length_unit": None}, ["frequency_shifts = 1GHz", "length_unit"]),
    ({"frequency_shifts": ["1:5GHz:3"], **IN_GLASS}, ["frequency_shifts = 1:5GHz:3", "each number"]),
    ({"frequency_shifts": ["1us"], **IN_GLASS}, ["frequency_shifts = 1us", "1GHz, 0.1nm or 0.5/cm"]),
    ({"frequency_shifts": ["200THz"], **IN_GLASS}, ["frequency_shifts", "-0.1 to 0.1"]),
    ({"linewidths": [1e-5]}, ["linewidths = 1e-05", "frequency_shifts"]),
    ({"line_shape": "lorentzian"}, ["line_shape = lorentzian", "frequency_shifts"]),
    ({"frequency_shifts": [1e-5], "line_shape": "lorentzian"}, ["line_shape = lorentzian"]),
    ({"frequency_shifts": [1e-5], "linewidths": [0]}, ["linewidths = 0", "above 0"]),
    ({"frequency_shifts": [1e-5], "linewidths": ["1GHz"]}, ["linewidths = 1GHz", "medium_index"]),
    ({"frequency_shifts": [1e-5], "line_shape": "table"}, ["line_table is not given"]),
    ({"frequency_shifts": [1e-5], "linewidths": [1e-5], "line_table": "line.csv"}, ["line_table = line.csv"]),
    ({"frequency_shifts": [1e-5], "line_shape": "table", "linewidths": [1e-5], "line_table": "line.csv"}, ["linewidths"]),
    ({"frequency_shifts": [1e-5], "line_shape": "table", "line_table": "hz.csv"}, ["line_table = hz.csv", "column shift"]),
    ({"frequency_shifts": [1e-5], "line_shape": "table", "line_table": "dark.csv"}, ["line_table = dark.csv", "power"]),
    ({"frequency_shifts": [1e-5], "linewidths": [1e-5], "covariance": "memory_effect", "tilts": [0, 0.01]}, ["linewidths"]),
]


class Refused(RefusingTest):
    def test_refused(self):
        self.write("line.csv", "shift,power\n-1e-5,0\n0,1\n1e-5,0\n")
        self.write("hz.csv", "frequency,power\n1e9,0\n2e9,1\n3e9,0\n")
        self.write("dark.csv", "shift,power\n0,0\n1e-5,0\n")
        for keys, words in CASES:
            with self.subTest(keys=keys):
                self.assert_refused(words, "covariance", **{**SLAB, **keys})

    def test_exact_solutions_have_no_delays(self):
        box = {"width": 20, "depth": 10, "count": 3, "method": "wave"}
        self.assert_refused(["delays", "method = mc"], "covariance", **box, delays=["1us"], diffusion="1e-12 m^2/s",
                            length_unit="um")


if __name__ == "__main__":
    unittest.main()
