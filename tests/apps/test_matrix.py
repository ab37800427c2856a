"""Scattering matrices of periodic cells by the command line."""

import unittest

import numpy as np

from program import ProgramTest, attributes, datasets

CELL = {"width": 9.3, "depth": 4, "count": 12, "scatterer": "tm", "radius": 0.3, "index": 1.4}


class OnePlacement(ProgramTest):
    def solve(self, **more):
        self.call("solve", **{**CELL, "period": 9.3, **more}, out="cell.h5")
        return datasets(self.folder / "cell.h5")

    def test_a_lossless_cell_is_unitary(self):
        found = self.solve()
        s = found["scattering_matrix"]
        sides, channels = 2, len(found["sine"])
        self.assertEqual(s.shape, (sides, channels, sides, channels))
        s = s.reshape(sides * channels, -1)
        np.testing.assert_allclose(s.conj() @ s.T, np.eye(len(s)), atol=1e-9)
        t = found["scattering_matrix"][0, :, 1, :]
        np.testing.assert_allclose(np.sort(found["transmission_eigenvalue"]), np.sort(np.linalg.svd(t)[1] ** 2), atol=1e-9)
        self.assertEqual(attributes(self.folder / "cell.h5")["converged"], 1)

    def test_positions_of_a_file_repeat(self):
        found = self.solve()
        xs, zs = found["placement/x"], found["placement/z"]
        xs = np.where(np.arange(len(xs)) % 2, xs, xs + 9.3)
        self.write("cell.csv", "x,z\n" + "".join(f"{x!r},{z!r}\n" for x, z in zip(xs.tolist(), zs.tolist())))
        self.call("solve", placement="cell.csv", scatterer="tm", radius=0.3, index=1.4, period=9.3, out="moved.h5")
        moved = datasets(self.folder / "moved.h5")["scattering_matrix"]
        np.testing.assert_allclose(moved, found["scattering_matrix"], atol=1e-9)

    def test_refused(self):
        self.write("two.csv", "x,z\n0,0\n9,0.1\n")
        two = {"placement": "two.csv", "scatterer": "soft", "radius": 0.2}
        for keys, message in (({**CELL, "period": 9}, "period = 9: must be the width"),
                              ({**two, "period": 9.3}, "overlap with those of the next period"),
                              ({**two, "radius": 0.01, "period": 9.3, "solver": "fast", "period_phase": 1}, "must be 0 or pi"),
                              ({**two, "period": 20, "view_angles": 1}, "view_angles"),
                              ({**CELL, "period_phase": 1}, "period_phase")):
            self.assertIn(message, self.call("solve", **keys, out="no.h5", status=2).stderr)


class Ensemble(ProgramTest):
    def test_sums_agree(self):
        self.call("matrix", **CELL, samples=6, shifts=3, out="matrix.h5")
        found = datasets(self.folder / "matrix.h5")
        np.testing.assert_allclose(found["transmittance"].sum(), found["conductance"])
        np.testing.assert_allclose(found["transmittance"] + found["reflectance"], 1, atol=1e-6)
        np.testing.assert_allclose(found["eigenvalue_count"].sum(), len(found["light_sine"]))
        np.testing.assert_allclose(found["tilt_correlation"][0], 1)
        self.assertLessEqual(found["tilt_correlation"].max(), 1 + 1e-12)

    def test_refused(self):
        for keys, message in (({"shifts": 9}, "shifts = 9: must be less than half"),
                              ({"domain": "slab", "count": None, "width": None, "density": 0.1}, "domain"),
                              ({"width": 0.5, "count": 1}, "fewer than two channels")):
            self.assertIn(message, self.call("matrix", **{**CELL, **keys}, samples=2, out="no.h5", status=2).stderr)


if __name__ == "__main__":
    unittest.main()
