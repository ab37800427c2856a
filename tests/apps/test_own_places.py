"""`validate` with the user's placement: one speckle pattern divided by the mean intensity of Monte Carlo."""

import unittest

import numpy as np

from program import WHOLE, datasets, flags
from refusing import RefusingTest

BOX = {"domain": "box", "width": 20, "depth": 10, "scatterer": "tm", "radius": 0.16, "index": 1.5}
VIEWS = {"view_angles": "0.3:3.1:121"}
FEW = {"samples": 20000}
TABLE = "x,z\n0,1\n3,4\n-5,9\n"


class OwnPlaces(RefusingTest):
    def draw(self, seed, count=50):
        self.call("place", width=20, depth=10, radii=0.16, count=count, seed=seed, out=f"p{seed}.csv")
        return f"p{seed}.csv"

    def test_the_ratio_is_that_of_solve_and_covariance(self):
        places = self.draw(3)
        self.call("validate", **BOX, placement=places, light_angles=[0, 0.5], **VIEWS, **FEW, out="own.h5")
        self.call("solve", placement=places, scatterer="tm", index=1.5, light_angles=[0, 0.5], **VIEWS, out="one.h5")
        own, one = datasets(self.folder / "own.h5"), datasets(self.folder / "one.h5")
        np.testing.assert_allclose(own["far_field"], one["far_field"], rtol=1e-4)
        ratio = np.abs(own["far_field"])**2 / own["mc/intensity"]
        np.testing.assert_allclose(own["intensity_ratio"], ratio, rtol=1e-12)
        counted = own["forward"] == 0
        self.assertTrue(0 < counted.sum() < counted.size)  # light 0.5 shines into some of the views
        self.assertAlmostEqual(float(own["mean_ratio"]), ratio[counted].mean(), 12)
        self.call("covariance", **BOX, count=50, light_angles=[0, 0.5], **VIEWS, **FEW, out="mean.h5")
        mean = datasets(self.folder / "mean.h5")
        error = np.hypot(mean["intensity_error"], own["mc/intensity_error"])
        self.assertLess(np.abs((mean["intensity"] - own["mc/intensity"]) / error).max(), 5)

    def test_mean_and_contrast_are_one_and_their_errors_are_what_placements_differ_by(self):
        found = []
        for seed in range(1, 25 if WHOLE else 10):
            self.call("validate", **BOX, placement=self.draw(seed), **VIEWS, samples=4000, out="own.h5")
            own = datasets(self.folder / "own.h5")
            found.append([float(own[name]) for name in ("mean_ratio", "ratio_contrast", "mean_ratio_error",
                                                        "ratio_contrast_error")])
        mean, contrast, mean_error, contrast_error = np.array(found).T
        for values, errors in ((mean, mean_error), (contrast, contrast_error)):
            normalised = (values - 1) / errors
            self.assertLess(abs(normalised.mean()), 4 / np.sqrt(len(normalised)) + 0.08 / errors.mean())
            self.assertLess(abs(normalised.std(ddof=1) - 1), 4 / np.sqrt(2 * len(normalised)))

    def test_what_is_refused(self):
        self.write("mine.csv", TABLE)
        own = {**BOX, "placement": "mine.csv", **VIEWS}
        for changes, words in (({"count": 3}, ["placement = mine.csv", "leave out count"]),
                               ({"density": 0.1}, ["placement = mine.csv", "density"]),
                               ({"view_angles": 0}, ["view_angles", "forward"]),
                               ({"view_angles": "0.3:3.1:600"}, ["view_angles", "512"]),
                               ({"covariance": "full"}, ["placement", "intensity"]),
                               ({"domain": "slab"}, ["domain"]),
                               ({"depth": 3}, ["mine.csv", "row 2", "inside the box"]),
                               ({"wave_samples": 9}, ["wave_samples"]),
                               ({"placement": "poison", "count": 3}, ["placement = poison", "must be one of poisson hard_disk"])):
            with self.subTest(changes=changes):
                self.assert_refused(words, "validate", *flags({**own, **changes}))
        self.write("unequal.csv", "x,z,radius\n0,1,0.16\n3,4,0.2\n")
        self.assert_refused(["unequal.csv", "row 2", "solve"], "validate", *flags({**own, "placement": "unequal.csv"}))
        self.assert_refused(["placement", "hard_disk"], "covariance", *flags({**own, "count": 3}))


if __name__ == "__main__":
    unittest.main()
