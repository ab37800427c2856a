"""Exact fields of one placement at several wavelengths."""

import unittest

import h5py
import numpy as np

from program import DATA, ProgramTest, attributes, datasets
from refusing import RefusingTest

DISKS = {"width": 20, "depth": 10, "count": 30, "scatterer": "tm", "radius": 0.3}
FAR = {"light_angles": [0, 0.2], "view_angles": [0.1, 0.5, 3.0]}
FILE = {"placement": DATA / "reference/g2/placement.csv", "scatterer": "te"}
TABLE = "wavelength,index_re,index_im\n0.8,1.3,0\n1.2,1.4,0.01\n"


class Wavelengths(ProgramTest):
    def field(self, name, **keys):
        self.call("solve", **FAR, **keys, out=name)
        return datasets(self.folder / name)

    def test_each_is_a_solution_of_its_own(self):
        for scene in ({**DISKS, "index": 1.3}, {**FILE, "index": "1.5+0.1i"},
                      {"width": 20, "depth": 10, "density": 0.2}):
            with self.subTest(scene=scene):
                all_of = self.field("all.h5", **scene, wavelengths=[0.9, 1.1], wavelength_count=3)
                np.testing.assert_allclose(all_of["wavelength"], [0.9, 1.0, 1.1], rtol=1e-15)
                self.assertEqual(all_of["far_field"].shape, (3, 2, 3))
                alone = self.field("alone.h5", **scene, wavelength=1.1)
                np.testing.assert_array_equal(all_of["placement/x"], alone["placement/x"])
                np.testing.assert_array_equal(all_of["far_field"][2], alone["far_field"])
                self.assertEqual(all_of["solve/residual"][2], alone["solve/residual"])
                self.assertEqual(all_of["solve/highest_order"][2], alone["solve/basis_order"].max())
                self.assertIn("3 wavelengths", attributes(self.folder / "all.h5")["plan"])

    def test_index_of_a_table(self):
        self.write("n.csv", TABLE)
        found = self.field("table.h5", **DISKS, wavelengths=[0.9, 1.1], index_table="n.csv")
        alone = self.field("alone.h5", **DISKS, wavelength=1.1, index="1.375+0.0075i")
        np.testing.assert_allclose(found["far_field"][1], alone["far_field"], rtol=1e-11)

    def test_near_sensors(self):
        self.write("sensors.csv", "x,z\n0,-2\n1,13\n")
        self.call("solve", **DISKS, index=1.3, wavelengths=[1, 0.9], near_sensors="sensors.csv",
                  out="near.h5")
        with h5py.File(self.folder / "near.h5") as file:
            self.assertEqual(file["near_field"].shape, (2, 1, 2))
            self.assertEqual([axis[0].name for axis in file["near_field"].dims],
                             ["/wavelength", "/light_angle", "/sensor"])
            self.assertNotIn("far_field", file)


class Refused(RefusingTest):
    def test_refused(self):
        for name, text in (("n.csv", TABLE), ("falls.csv", TABLE.replace("1.2,", "0.7,")),
                           ("amplifies.csv", TABLE.replace("0.01", "-0.01")),
                           ("wide.csv", TABLE.replace("1.2,", "0,"))):
            self.write(name, text)
        two = {"wavelengths": [0.9, 1.1]}
        for keys, words in (
                ({"wavelengths": [0]}, ["wavelengths = 0", "positive"]),
                ({"wavelengths": [1, 1]}, ["wavelengths = 1", "twice"]),
                ({"wavelengths": [1, 2, 3], "wavelength_count": 4}, ["wavelength_count = 4"]),
                ({**two, "wavelength_count": 1}, ["wavelength_count = 1", "from 2"]),
                ({"wavelength_count": 4}, ["wavelength_count = 4", "wavelengths only"]),
                ({**two, "map": [0, 1, 0, 1]}, ["map"]),
                ({**two, "index_table": "none.csv"}, ["none.csv", "no such file"]),
                ({"wavelengths": [0.9, 1.3], "index_table": "n.csv"}, ["n.csv", "1.3"]),
                ({**two, "index_table": "falls.csv"}, ["falls.csv", "increasing"]),
                ({**two, "index_table": "amplifies.csv"}, ["amplifies.csv", "1.2"]),
                ({**two, "index_table": "wide.csv"}, ["wide.csv", "positive"]),
                ({"index_table": "n.csv"}, ["index_table", "wavelengths"]),
                ({**two, "index": 1.3, "index_table": "n.csv"}, ["index_table, index"]),
                ({**two, "scatterer": "soft", "index_table": "n.csv"}, ["tm or te"])):
            self.assert_refused_both_ways("solve", DISKS, keys, words)


if __name__ == "__main__":
    unittest.main()
