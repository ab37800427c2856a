"""dimension = 3: slabs in space by transport, known numbers and what files say."""

import unittest

import h5py

from program import ProgramTest

DEPTH = 2000
SPACE = {"domain": "slab", "depth": DEPTH, "optical_depth": 10, "method": "transport",
         "dimension": 3}
Q_TILTS = [1.2, 1.4, 1.6]  # conventions, C41
TILTS = {"covariance": "memory_effect", "tilts": [q / (6.283185307179586 * DEPTH) for q in Q_TILTS],
         "tolerance": 1e-5}


class Space(ProgramTest):
    def correlations(self, **keys):
        self.call("covariance", **(SPACE | TILTS | keys), out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            self.assertEqual(file.attrs["dimension"], 3)
            self.assertIn("numerical", file.attrs["errors"])
            correlation = file["field_correlation"][:] ** 2
            return file["reference_intensity"][0], correlation, file.attrs["g"]

    def test_known_numbers(self):
        for g, intensity, known in ((0, 0.058862, [0.5923, 0.4977, 0.4106]),
                                    (0.5, 0.10584, [0.5627, 0.4675, 0.3820])):
            found, correlation, mean_cosine = self.correlations(scatterer="hg", g=g)
            self.assertAlmostEqual(found, intensity, delta=1e-5)
            self.assertAlmostEqual(mean_cosine, g, delta=1e-9)
            for one, other in zip(correlation, known):
                self.assertAlmostEqual(one, other, delta=6e-5)

    def test_a_table_is_per_solid_angle(self):
        (self.folder / "p.csv").write_text("angle,value\n0,1\n3.141592653589793,1\n")
        found, _, mean_cosine = self.correlations(scatterer="phase_table", phase_table="p.csv")
        self.assertAlmostEqual(found, 0.058862, delta=1e-5)
        self.assertAlmostEqual(mean_cosine, 0, delta=1e-9)

    def test_two_equal_terms_are_one(self):
        one = self.correlations(scatterer="hg", g=0.5)
        two = self.correlations(scatterer="two_term_hg", g=0.5, g_back=0.5, forward_share=0.3)
        self.assertAlmostEqual(one[0], two[0], delta=1e-9)
        self.assertAlmostEqual(two[2], 0.5, delta=1e-9)

    def test_sweep(self):
        keys = {"depth": DEPTH, "optical_depth": 10, "method": "transport", "g": [0, 0.5],
                "tilts": [q / (6.283185307179586 * DEPTH) for q in Q_TILTS], "tolerance": 1e-4}
        self.call("sweep", **keys, dimension=3, out="space.h5")
        self.call("sweep", **keys, out="plane.h5")
        with (h5py.File(self.folder / "space.h5") as space,
              h5py.File(self.folder / "plane.h5") as plane):
            self.assertEqual(space.attrs["dimension"], 3)
            self.assertNotIn("dimension", plane.attrs)
            self.assertAlmostEqual(space["memory_effect_range"][:].flat[0], 1.395, delta=2e-3)
            self.assertNotEqual(space["diffusion_range"][:].flat[0],
                                plane["diffusion_range"][:].flat[0])


if __name__ == "__main__":
    unittest.main()
