"""Exact solutions of points in a layer whose faces reflect, and rejected input."""

import unittest

import h5py
import numpy as np

from refusing import RefusingTest

POINTS = "x,z\n-2,1.5\n0.3,4\n4,0.2\n1,2.2\n"
ANGLES = {"light_angles": [0, 0.4], "view_angles": [0.3, 2.8]}


class Layer(RefusingTest):
    def setUp(self):
        super().setUp()
        self.write("points.csv", POINTS)

    def field(self, **keys):
        self.call("solve", **{"placement": "points.csv", **ANGLES, **keys}, out="layer.h5")
        with h5py.File(self.folder / "layer.h5") as file:
            return file["far_field"][()], dict(file.attrs)

    def test_without_contrast_it_is_the_homogeneous_medium(self):
        expected, _ = self.field(wavelength=1)
        found, attributes = self.field(wavelength=1.3, medium_index=1.3, outside_index=1.3, depth=5)
        np.testing.assert_allclose(found, expected, rtol=1e-9)
        self.assertAlmostEqual(attributes["wavelength"], 1)
        self.assertEqual(attributes["medium_index"], 1.3)

    def test_a_drawn_placement_is_solved_as_from_a_file(self):
        box = {"placement": None, "width": 10, "depth": 5, "density": 0.5, "medium_index": 1.5, "polarisation": "te"}
        drawn, attributes = self.field(**box)
        self.assertEqual(attributes["polarisation"], "te")
        with h5py.File(self.folder / "layer.h5") as file:
            rows = np.column_stack([file["placement/x"], file["placement/z"]])
        self.write("drawn.csv", "x,z\n" + "".join(f"{x:.17g},{z:.17g}\n" for x, z in rows))
        again, _ = self.field(placement="drawn.csv", depth=5, medium_index=1.5, polarisation="te")
        np.testing.assert_allclose(again, drawn, atol=1e-6 * np.abs(drawn).max())

    def test_other_scenes_are_refused(self):
        file = {"placement": "points.csv", "depth": 5, "medium_index": 1.3, **ANGLES}
        for words, keys in ((["medium_index", "point"], {"scatterer": "soft", "radius": 0.01}),
                            (["depth"], {"depth": None}),
                            (["placement", "between 0 and depth"], {"depth": 4}),
                            (["near_sensors"], {"near_sensors": "points.csv"}),
                            (["tolerance"], {"tolerance": 1e-8})):
            with self.subTest(**keys):
                self.assert_refused(words, "solve", **{**file, **keys})
        box = {"width": 10, "depth": 5, "density": 0.5, "medium_index": 1.3, "wave_samples": 10, **ANGLES}
        self.assert_refused(["scatterer = point"], "validate", **box, scatterer="soft", radius=0.1)
        self.assert_refused(["wave_tolerance", "1e-06"], "validate", **box, wave_tolerance=1e-8)


if __name__ == "__main__":
    unittest.main()
