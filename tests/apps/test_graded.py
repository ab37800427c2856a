"""Graded index around the scatterers: exact placements, Monte Carlo, and rejected input. By night: speckle of
slabs whose mean field is refracted, and boxes of rods that guide it."""

import unittest

import h5py
import numpy as np

from program import ERRORS, SAMPLES, WHOLE, ProgramTest, nightly
from refusing import RefusingTest

SOURCES = "x,z\n0,-4\n0.5,-4\n"
SENSORS = "x,z\n0,14\n0.5,14\n8,14\n0,-4\n"
BOX = {"domain": "box", "width": 20, "depth": 10, "density": 0.155, "near_sources": "sources.csv",
       "near_sensors": "sensors.csv"}
LINEAR = {"index_field": "linear", "index_slope": [0, 0.05]}


class Graded(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("sources.csv", SOURCES)
        self.write("sensors.csv", SENSORS)

    def check_agreement(self, **keys):
        self.call("validate", **{**BOX, **keys}, samples=int(40000 * SAMPLES), wave_samples=int(1000 * SAMPLES),
                  out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            mc, exact = file["mc/intensity"][()], file["wave/intensity"][()]
            error = np.hypot(file["mc/intensity_error"], file["wave/intensity_error"])
            allowed = 4 * error + file.attrs["bias_allowance"] * exact
            self.assertTrue(np.all(np.abs(mc - exact) < allowed), (mc, exact, error))
            self.assertTrue(np.all(error < 0.06 * ERRORS * exact))

    def test_a_linear_field_agrees_with_exact_placements(self):
        self.check_agreement(**LINEAR)

    def test_a_guide_agrees_with_exact_placements(self):
        self.check_agreement(index_field="parabolic", index_alpha=0.06, width=20 if WHOLE else 10)

    def test_hardly_any_field_is_none(self):
        found = []
        for keys in ({}, {"index_field": "linear", "index_slope": [0, 1e-9]}):
            self.call("covariance", **BOX, **keys, covariance="full", samples=4000, out="result.h5")
            with h5py.File(self.folder / "result.h5") as file:
                found.append(file["covariance"][()])
        np.testing.assert_allclose(found[0], found[1], atol=1e-5 * np.abs(found[0]).max())

    def test_solve_knows_what_an_ensemble_is_made_of(self):
        self.write("one.csv", "x,z\n1,5\n")
        self.call("solve", **LINEAR, placement="one.csv", near_sources="sources.csv",
                  near_sensors="sensors.csv", out="one.h5")
        with h5py.File(self.folder / "one.h5") as file:
            one = file["near_source_field"][()]
        self.assertEqual(one.shape, (2, 4))
        # |4 i G G'|, with 1/sqrt(8 pi k J) for |G|: leading order in 1/(k distance).
        def size(p, q):
            p, q = np.array(p, float), np.array(q, float)
            mean, square = (2 + 0.05 * (p[1] + q[1])) / 2, (q - p) @ (q - p)
            sigma = np.sqrt(2 * square / (mean + np.sqrt(mean**2 - 0.05**2 * square / 4)))
            return 1 / np.sqrt(8 * np.pi * 2 * np.pi * sigma * (square / sigma**2 - (0.025 * sigma)**2 / 4))
        expected = 4 * size((0, -4), (1, 5)) * size((1, 5), (8, 14))
        self.assertAlmostEqual(abs(one[0, 2]) / expected, 1, delta=0.003)

    def test_sound_and_blobs(self):
        self.write("blobs.csv", "x,z,height,width\n2,4,0.05,3\n")
        for keys in ({"index_field": "blobs", "index_blobs": "blobs.csv"},
                     {"index_field": "ultrasound", "sound_amplitude": 0.01, "sound_wavenumber": 0.3}):
            self.call("covariance", **BOX, **keys, samples=2000, out="result.h5")
            with h5py.File(self.folder / "result.h5") as file:
                self.assertTrue(np.all(file["intensity"][()] > 0))


    def test_samples_of_a_field_are_the_field(self):
        """A sampled field gives the same numbers with the same random numbers."""
        z = -6 + 0.5 * np.arange(45)
        excess = np.sqrt(1 + 0.05 * z) - 1
        with h5py.File(self.folder / "linear.h5", "w") as file:
            samples = file.create_dataset("excess", data=np.broadcast_to(excess, (49, 5, 45)))
            samples.attrs["origin"], samples.attrs["spacing"] = [-12, -1, -6], [0.5, 0.5, 0.5]
        found = []
        for field in (LINEAR, {"index_field": "grid", "index_grid": "linear.h5"}):
            self.call("covariance", **BOX, **field, samples=1000, out="result.h5")
            with h5py.File(self.folder / "result.h5") as file:
                found.append(file["intensity"][()])
        np.testing.assert_allclose(found[1], found[0], rtol=1e-4)


class Guiding(ProgramTest):
    """Boxes deeper than wide whose scatterers shift the phase, which weakly guide the mean field."""

    VIEWS = [0.4, 0.8, 1.3, 2, 2.6]
    RODS = {"width": 5, "depth": 30, "scatterer": "tm", "radius": 0.1, "index": 1.5, "count": 100,
            "structure": "hard_disks", "wave_tolerance": 1e-3}
    POINTS = {"width": 5, "depth": 20, "scatterer": "point", "phase_shift": 0.5, "count": 20}

    def deviations(self, out, wave_samples, **keys):
        """Returns relative deviations of Monte Carlo from the exact placements of straight.h5, their errors, and the
        deviations allowed."""
        self.call("validate", **keys, view_angles=self.VIEWS, samples=40000, wave_samples=wave_samples, out=out)
        with h5py.File(self.folder / out) as file, h5py.File(self.folder / "straight.h5") as exact_file:
            mc, exact = file["mc/intensity"][()], exact_file["wave/intensity"][()]
            error = np.hypot(file["mc/intensity_error"], exact_file["wave/intensity_error"])
            return mc / exact - 1, error / exact, file.attrs["bias_allowance"]

    def check(self, wave_samples, **keys):
        straight, error, allowance = self.deviations("straight.h5", wave_samples, **keys)
        self.assertTrue(np.all(np.abs(straight) < allowance + 4 * error), (straight, allowance, error))
        refracted, error, allowance = self.deviations("refracted.h5", 2, **keys, index_field="mean_field")
        self.assertTrue(np.all(np.abs(refracted) < allowance + 4 * error), (refracted, error))
        rms = lambda values: np.sqrt(np.mean(values**2))
        self.assertLess(rms(refracted), rms(straight) / 2)

    @nightly
    def test_rods(self):
        self.check(200, **self.RODS)

    def test_points(self):
        self.check(12000, **self.POINTS)


@nightly
class Slabs(ProgramTest):
    """Slabs of cylinders against exact placements."""

    TILTS = [-0.06, -0.04, -0.02, 0.02, 0.04, 0.06]
    SLAB = {"domain": "box", "width": 24, "depth": 6, "scatterer": "tm", "radius": 0.1, "index": 1.5, "count": 355,
            "light_angles": 0.8, "view_angles": [0.5, 0.65, 0.95, 1.1, 2, 2.3, 2.6, 2.9], "covariance": "memory_effect",
            "tilts": [0, *TILTS]}

    def seen(self, **keys):
        """Returns phases of the covariances of tilted lights, their errors, intensities and their errors."""
        self.call("covariance", **self.SLAB, **keys, out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            found = file["covariance"][()]
            error = file["covariance_error"][()] / np.abs(found) / np.sqrt(2)
            return (np.angle(found)[1:], error[1:], file["reference_intensity"][()],
                    file["reference_intensity_error"][()])

    def test_speckle_is_refracted(self):
        """Here k_shift/k is 0.05."""
        exact, error, bright, bright_error = self.seen(method="wave", wave_samples=1000, wave_tolerance=1e-3)
        keys = {"samples": 100000, "structure": "hard_disks"}
        refracted, _, intensity, _ = self.seen(**keys, index_field="mean_field")
        straight, _, _, _ = self.seen(**keys)
        self.assertLess(np.abs((refracted - exact) / error).max(), 4)
        self.assertTrue(np.all(np.abs(intensity - bright) < 4 * bright_error + 0.05 * bright))
        transmitted = np.cos(self.SLAB["view_angles"]) > 0
        off = lambda phases: np.sqrt(np.mean(((phases - exact) / error)[:, transmitted]**2))
        self.assertLess(off(refracted), 1.5)
        self.assertGreater(off(straight), 1.5)


class Refused(RefusingTest):
    def check(self, words, command="covariance", **changes):
        self.write("sources.csv", SOURCES)
        self.write("sensors.csv", SENSORS)
        with self.subTest(**changes):
            self.assert_refused(words, command, **{**BOX, "samples": 400, **changes})

    def test_keys(self):
        self.check(["index_slope"], index_field="linear")
        self.check(["index_alpha"], index_field="parabolic")
        self.check(["index_alpha"], **LINEAR, index_alpha=0.1)
        self.check(["index_slope"], index_slope=[0, 0.05])
        self.check(["index_field", "must be one of"], index_field="wavy")
        self.check(["n^2 = -"], index_field="linear", index_slope=[0, 0.5])
        self.check(["no such file"], index_field="blobs", index_blobs="none.csv")
        self.write("blobs.csv", "x,z,height,width\n0,0,0.1,0\n")
        self.check(["width = 0", "positive"], index_field="blobs", index_blobs="blobs.csv")

    def test_what_graded_media_have_not(self):
        self.check(["phase functions"], **LINEAR, scatterer="tm", radius=0.1)
        self.check(["not beams"], **LINEAR, near_sources=None, beam_waist=3)
        self.check(["near_sources only"], **LINEAR, near_sources=None, light_angles=0, method="wave", samples=None,
                   wave_samples=10)
        self.check(["exact solver"], index_field="blobs", index_blobs=self.blobs(), method="wave",
                   samples=None, wave_samples=10)
        self.check(["index_field", "slab"], domain="slab", width=None, index_field="parabolic", index_alpha=0.05,
                   near_sources=None, near_sensors=None)
        self.check(["covariances"], **LINEAR, near_sources=None, near_sensors=None, delays=[0, 1])

    def test_caustics_are_told(self):
        self.check(["caustic"], index_field="parabolic", index_alpha=0.5, axis_index=6)
        self.check(["turns round at z"], domain="slab", width=None, index_field="linear",
                   index_slope=[0, -0.05], light_angles=1.2, near_sources=None, near_sensors=None)

    def blobs(self):
        self.write("blobs.csv", "x,z,height,width\n2,4,0.05,3\n")
        return "blobs.csv"


if __name__ == "__main__":
    unittest.main()
