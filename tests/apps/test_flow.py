"""Scatterers that flow: field correlation after delays, and contrast after exposures."""

import unittest

import h5py
import numpy as np

from program import ProgramTest
from refusing import RefusingTest

K = 2 * np.pi
# Slab so thin that light scatters once.
THIN = {"domain": "slab", "depth": 10, "scatterer": "hg", "g": 0.3, "optical_depth": 1e-8, "method": "mc",
        "samples": 4000, "light_angles": 0}
THICK = {**THIN, "optical_depth": 4, "samples": 20000, "view_angles": [0.3, 2.8]}
VIEWS = np.array([0.5, 2.5])


def contrast(square, time):
    """Returns K^2 from |g1|^2 by the trapezoidal rule."""
    tau = np.linspace(0, time, 20001)
    return 2 / time * np.trapz(square(tau) * (1 - tau / time), tau)


class Flow(ProgramTest):
    def run_thin(self, delays, exposures, **keys):
        self.call("covariance", **{**THIN, **keys}, view_angles=list(VIEWS), delays=list(delays),
                  exposures=list(exposures), out="result.h5")
        with h5py.File(self.folder / "result.h5") as file:
            return {name: file[name][:, 0] for name in
                    ("field_correlation", "squared_contrast", "complex_correlation") if name in file}

    def test_contrast_of_diffusion_scattered_once(self):
        delays = np.concatenate([np.linspace(0, 1, 21), np.geomspace(1.1, 12, 30)])
        times = np.array([0.3, 1, 3, 12.0])
        found = self.run_thin(delays, times, beta=0.5)["squared_contrast"]
        for view, angle in enumerate(VIEWS):
            x = 2 * times * (1 - np.cos(angle))  # |g1| = exp(-x / 2 ...), tau_c where it is 1/e
            closed = 0.5 * (np.exp(-2 * x) - 1 + 2 * x) / (2 * x**2)
            np.testing.assert_allclose(found[:, view], closed, rtol=0.01)

    def test_shear_scattered_once(self):
        shear, depth = 0.03, 10
        delays = np.linspace(0, 4, 81)
        times = np.array([0.5, 2, 4])
        found = self.run_thin(delays, times, shear=shear, diffusion=0)
        for view, angle in enumerate(VIEWS):
            def square(tau):
                return np.sinc(K * np.sin(angle) * shear * tau * depth / 2 / np.pi)**2
            np.testing.assert_allclose(found["field_correlation"][:, view]**2, square(delays), atol=1e-3)
            for time, value in zip(times, found["squared_contrast"][:, view]):
                self.assertAlmostEqual(value, contrast(square, time), delta=0.01 * value)
            # w - w' = (-sin, 1 - cos): the phase of points that move along x
            turn = K * np.sin(angle) * shear * delays * depth / 2
            expected = np.exp(1j * turn) * np.sinc(turn / np.pi)
            complex_ = found["complex_correlation"][:, view]
            np.testing.assert_allclose(complex_["r"] + 1j * complex_["i"] if complex_.dtype.names else complex_,
                                       expected, atol=1e-3)

    def test_uniform_drift_only_turns_the_phase(self):
        delays = [0, 0.01, 0.05]
        for name, keys in (("still", {}), ("drifts", {"velocity": [0.7, -0.2]})):
            self.call("covariance", **THICK, **keys, delays=delays, out=f"{name}.h5")
        with h5py.File(self.folder / "still.h5") as still, h5py.File(self.folder / "drifts.h5") as drifts:
            np.testing.assert_allclose(drifts["field_correlation"], still["field_correlation"], rtol=2e-3)
            phase = np.angle(drifts["complex_correlation"][2, 0])
            turn = K * 0.05 * (-np.sin(THICK["view_angles"]) * 0.7 - 0.2 * (1 - np.cos(THICK["view_angles"])))
            np.testing.assert_allclose(np.exp(1j * phase), np.exp(-1j * turn), atol=5e-3)

    def test_layers_move_by_their_own(self):
        self.write("layers.csv", "thickness,optical_depth,diffusion,flow\n5,1,0,0\n5,1,1,1\n")
        still = "thickness,optical_depth,diffusion,flow\n5,1,0,0\n5,1,0,0\n"
        keys = {**THICK, "depth": None, "optical_depth": None, "layers": "layers.csv",
                "velocity": [0.5, 0], "delays": [0.1], "view_angles": 2.8, "samples": 40000}
        found = []
        for table in (None, still):
            if table:
                self.write("layers.csv", table)
            self.call("covariance", **keys, out="result.h5")
            with h5py.File(self.folder / "result.h5") as file:
                found.append(file["field_correlation"][0, 0, 0])
        self.assertLess(found[0], 0.95)
        self.assertGreater(found[0], 0.2)
        self.assertAlmostEqual(found[1], 1, delta=1e-12)


class Refused(RefusingTest):
    def test_flow_of_layers_without_velocity(self):
        self.write("layers.csv", "thickness,optical_depth,flow\n5,1,0\n5,1,1\n")
        keys = {**THICK, "depth": None, "optical_depth": None, "layers": "layers.csv", "delays": [0, 0.1]}
        for method in ({}, {"method": "transport", "samples": None}):
            self.assert_refused(["column flow requires velocity", "column diffusion"], "covariance", **{**keys, **method})

    def test_what_cannot_be(self):
        for changes, words in (
                ({"velocity": [1, 0]}, ["velocity"]),
                ({"delays": [0, 1], "velocity": [1]}, ["velocity", "v_x, v_z"]),
                ({"delays": [0, 1], "velocity": [1, 0], "method": "transport", "samples": None}, ["velocity"]),
                ({"delays": [0, 1], "exposures": [2]}, ["exposures = 2", "longest"]),
                ({"delays": [0, 1], "exposures": [0.5]}, ["exposures = 0.5", "four"]),
                ({"delays": [0, 1], "diffusion": -1}, ["diffusion"])):
            with self.subTest(**changes):
                self.assert_refused(words, "covariance", **{**THIN, **changes})


if __name__ == "__main__":
    unittest.main()
