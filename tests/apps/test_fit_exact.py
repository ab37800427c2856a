"""Fits of cylinders in a box measured by exact placements, with the bias that fit states. By night two densities with
several seeds."""

import os
import unittest

import numpy as np

from program import ProgramTest, nightly, attributes, datasets

VIEWS = [-2.9, -2.6, -2.3, -2, -1.7, -1.4, -1.1, -0.9, -0.7, -0.5, -0.35, -0.2, 0.25, 0.3, 0.4, 0.45, 0.55, 0.6, 0.65,
         0.8, 1, 1.2, 1.3, 1.5, 1.6, 1.8, 1.9, 2.1, 2.4, 2.7]
BOX = {"domain": "box", "width": 40, "depth": 20, "scatterer": "tm"}
SEEDS = [11 + number + 1000 * int(os.environ.get("FLATSPECKLE_TEST_SEED", 0)) for number in range(4)]
FREE = ["density=0.002:0.06", "radius=0.2:0.7", "index=1.2:1.8"]


class Fits(ProgramTest):
    def fitted(self, count, radius, seed, placements=2000):
        self.call("covariance", **BOX, count=count, radius=radius, index="1.5", method="wave", view_angles=VIEWS,
                  samples=placements, seed=seed, out="exact.h5")
        self.call("fit", "--free", *FREE, scatterer="tm", measurement="exact.h5", threads=1, out="fit.h5")
        found = datasets(self.folder / "fit.h5")
        truth = np.array([count / 800, radius, 1.5])
        bias = np.sqrt(np.diag(found["neglected_covariance"]))
        self.assertTrue((bias < found["estimate_error"]).all())
        normalised = (found["estimate"] - truth) / found["estimate_error"]
        print(f"{count} of radius {radius}, seed {seed}: estimate {found['estimate']}, error {found['estimate_error']}, "
              f"expected bias {bias}, residuals {normalised}, chi^2 {attributes(self.folder / 'fit.h5')['chi_squared']:.1f}")
        self.assertLess(np.abs(normalised).max(), 3)
        return found


class Once(Fits):
    def test_few_placements(self):
        found = self.fitted(14, 0.48, 11, placements=400)
        self.assertLess((found["estimate_error"] / found["estimate"]).max(), 0.15)


@nightly
class Seeds(Fits):
    """Two densities, several seeds, 2000 placements each."""

    def test_k_mfp_500(self):
        for seed in SEEDS:
            self.fitted(5, 0.35, seed)

    def test_k_mfp_100(self):
        for seed in SEEDS:
            self.fitted(14, 0.48, seed)


if __name__ == "__main__":
    unittest.main()
