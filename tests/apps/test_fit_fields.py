"""Media fitted to speckle patterns: complex fields and intensities."""

import unittest

import numpy as np

from program import ProgramTest, attributes, datasets
from refusing import RefusingTest

SLAB = {"domain": "slab", "depth": 2000, "scatterer": "hg"}
TRUTH = {"g": 0.8, "optical_depth": 4}
TILTS = np.array([0, 0.0002, 0.0004, 0.0008])
VIEW = 0.1
FREE = ["g=0.5:0.95", "optical_depth=1:20"]


class FitFields(ProgramTest):
    def covariance(self):
        """Returns the covariance of the fields of a view under each tilt, by transport."""
        views = np.arcsin(np.sin(VIEW) + np.sin(TILTS))
        pairs = [angle for i in range(4) for j in range(i + 1)
                 for angle in (TILTS[i], views[i], TILTS[j], views[j])]
        self.call("covariance", **SLAB, **TRUTH, covariance="pairs", pairs=pairs, method="transport", tolerance=1e-4,
                  out="c.h5")
        found = np.zeros((4, 4), complex)
        found[np.tril_indices(4)] = datasets(self.folder / "c.h5")["covariance"].view(complex)
        return np.tril(found) + np.tril(found, -1).conj().T

    def patterns(self, count, seed=1):
        random = np.random.default_rng(seed)
        normal = (random.standard_normal((count, 4)) + 1j * random.standard_normal((count, 4))) / 2**0.5
        return normal @ np.linalg.cholesky(self.covariance()).T

    def table(self, name, fields, columns):
        rows = [[pattern, VIEW, tilt, *values] for pattern, row in enumerate(fields)
                for tilt, values in zip(TILTS, row)]
        np.savetxt(self.folder / name, rows, delimiter=",", comments="", fmt="%.17g",
                   header=",".join(["pattern", "view_angle", "tilt", *columns]))

    def fit(self, table, *words, **keys):
        self.call("fit", *words, "--free", *FREE, depth=2000, measurement=table, out="fit.h5", **keys)
        return datasets(self.folder / "fit.h5")

    def test_fields_reach_the_bound(self):
        count = 2000
        fields = 7 * self.patterns(count)  # the scale is unknown
        self.table("fields.csv", [[(u.real, u.imag) for u in row] for row in fields], ["field_re", "field_im"])
        found = self.fit("fields.csv")
        normalised = (found["estimate"] - list(TRUTH.values())) / found["estimate_error"]
        self.assertLess(np.abs(normalised).max(), 4)
        self.call("fit", "--plan", "--free", *FREE, depth=2000, **TRUTH, view_angles=VIEW, tilts=list(TILTS[1:]),
                  patterns=count, out="plan.h5")
        bound = datasets(self.folder / "plan.h5")["planned_error"]
        np.testing.assert_allclose(found["estimate_error"], bound, rtol=0.2)
        self.table("intensities.csv", [[(abs(u)**2,) for u in row] for row in fields], ["speckle_intensity"])
        curve = self.fit("intensities.csv")
        normalised = (curve["estimate"] - list(TRUTH.values())) / curve["estimate_error"]
        self.assertLess(np.abs(normalised).max(), 4)
        self.assertGreater((curve["estimate_error"] / found["estimate_error"]).min(), 1.2)

    def test_drawn_fields(self):
        """Fits fields of a box, all views at once, by Monte Carlo."""
        box = {"domain": "box", "width": 20, "depth": 10, "scatterer": "hg"}
        self.call("field", **box, g=0.5, optical_depth=2, view_angles=[0.1, 0.15, 0.2, 2.7, 2.75], fields=400,
                  seed=5, method="covariance", out="drawn.h5")
        self.call("fit", "--free", "g=0.2:0.8", "optical_depth=0.5:6", scatterer="hg", measurement="drawn.h5",
                  model_share=0.5, threads=1, out="fit.h5")
        found = datasets(self.folder / "fit.h5")
        normalised = (found["estimate"] - [0.5, 2]) / found["estimate_error"]
        self.assertLess(np.abs(normalised).max(), 4)
        self.assertEqual(len(found["measured"]), 25)


class BadFields(RefusingTest):
    def refused(self, words, table):
        self.write("m.csv", table)
        self.assert_refused(words, "fit", "--free", *FREE, measurement="m.csv", depth=2000)

    def test_patterns(self):
        head = "pattern,view_angle,tilt,field_re,field_im\n"
        self.refused(["must have more patterns than fields"], head + "0,0,0,1,0\n0,0,0.1,1,0\n")
        self.refused(["same tilts"], head + "0,0,0,1,0\n0,0,0.1,1,0\n1,0,0,1,0\n")
        self.refused(["pattern, view and tilt"], head + "0,0,0,1,0\n0,0,0,1,0\n")
        self.refused(["field_im"], "pattern,tilt,field_re\n0,0,1\n")
        self.refused(["column depth"], "pattern,tilt,depth,field_re,field_im\n0,0,1,1,1\n")
        self.refused(["pattern"], "tilt,field_re,field_im\n0,1,1\n")
        self.refused(["tilt 0"], "pattern,tilt,speckle_intensity\n" +
                     "".join(f"{n},0.1,1\n{n},0.2,1\n" for n in range(20)))
        self.refused(["more than the number of tilts plus 10"], "pattern,tilt,speckle_intensity\n0,0,1\n0,0.1,1\n")


if __name__ == "__main__":
    unittest.main()
