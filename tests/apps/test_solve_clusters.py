"""T-matrices of clusters of scatterers, and their copies as single objects."""

import unittest

import h5py
import numpy as np

from program import ProgramTest, datasets
from refusing import RefusingTest

MOTIF = np.array([(0, 0.4), (0.7, -0.2), (-0.6, -0.5)])
PLACES = np.array([(-3, 0, 0.3), (3, 1, 2.0), (0, 6, -1.0)])
DISK = {"scatterer": "tm", "radius": 0.2, "index": 1.5}
FAR = {"light_angles": [0, 0.7], "view_angles": [0.3, 1.9, 3.1]}
TURNED = "x,z,angle\n" + "\n".join(",".join(map(str, place)) for place in PLACES) + "\n"


def table(points):
    return "x,z\n" + "\n".join(f"{x:.17g},{z:.17g}" for x, z in points) + "\n"


def copies():
    """Returns copies of the motif about the middle of its centres."""
    about = MOTIF - (MOTIF.min(axis=0) + MOTIF.max(axis=0)) / 2
    for x, z, angle in PLACES:
        c, s = np.cos(angle), np.sin(angle)
        yield from (x + c * about[:, 0] + s * about[:, 1], z + c * about[:, 1] - s * about[:, 0])


def motif(test, **keys):
    test.write("motif.csv", table(MOTIF))
    test.write("places.csv", TURNED)
    test.call("solve", placement="motif.csv", **DISK, **{"t_matrix_gap": 1.5, **keys}, out="motif.h5")


class Clusters(ProgramTest):
    def test_copies_are_as_all_disks(self):
        for keys in ({}, {"t_matrix_gap": 0.1}):  # the second: too many orders to be inverted
            with self.subTest(keys=keys):
                self.check_copies(**keys)

    def check_copies(self, **keys):
        motif(self, **keys)
        rows = list(copies())
        self.write("all.csv", table(np.column_stack([np.concatenate(rows[0::2]), np.concatenate(rows[1::2])])))
        self.write("sensors.csv", "x,z\n0,-4\n7,9\n")
        self.call("solve", placement="all.csv", **DISK, **FAR, near_sensors="sensors.csv", out="all.h5")
        self.call("solve", placement="places.csv", cluster="motif.h5", **FAR, near_sensors="sensors.csv",
                  out="copies.h5")
        expected, found = datasets(self.folder / "all.h5"), datasets(self.folder / "copies.h5")
        for name in ("far_field", "near_field"):
            error = np.linalg.norm(found[name] - expected[name]) / np.linalg.norm(expected[name])
            self.assertLess(error, 1e-10, name)

    def test_t_matrix_in_the_waves_of_the_guide(self):
        motif(self)
        with h5py.File(self.folder / "motif.h5") as file:
            t, n = file["cluster/t_matrix"][...], file["cluster/order"][...]
        self.assertEqual(list(n), list(range(int(n[0]), 1 - int(n[0]))))
        np.testing.assert_allclose(t + t.conj().T + 2 * t.conj().T @ t, 0, atol=1e-11)  # energy
        swapped = t[::-1, ::-1].T * (-1.0) ** (n[:, None] + n)  # reciprocity
        np.testing.assert_allclose(t, swapped, atol=1e-12)


class Refused(RefusingTest):
    def test_fast_needs_the_inverse(self):
        motif(self, t_matrix_gap=0.1)
        for solver in ("fast", "krylov"):
            self.assert_refused_both_ways(
                "solve", {}, {"cluster": "motif.h5", "placement": "places.csv", "solver": solver},
                ["nearly singular", "dense"])

    def test_refused(self):
        motif(self, tolerance=1e-10)
        self.write("close.csv", "x,z\n0,0\n0,3\n")
        self.write("strange.csv", "x,z,radius\n0,0,1\n")
        self.write("sensors.csv", "x,z\n-3,1\n")
        self.write("no.h5", "no result")
        two = {"cluster": "motif.h5", "placement": "places.csv", "tolerance": 1e-9}
        for keys, words in (
                ({**two, "placement": "close.csv"}, ["distance of the clusters", "gap"]),
                ({**two, "placement": "strange.csv"}, ["strange.csv", "radius"]),
                ({**two, "placement": "hard_disk"}, ["placement = hard_disk", "copies"]),
                ({**two, "tolerance": 1e-12}, ["tolerance = 1e-12", "at least", "1e-10"]),
                ({**two, "near_sensors": "sensors.csv"}, ["near_sensors", "radius and gap"]),
                ({**two, "wavelength": 2}, ["wavelength"]),
                ({**two, "index": 2}, ["index"]),
                ({**two, "cluster": "none.h5"}, ["none.h5", "no such file"]),
                ({**two, "cluster": "no.h5"}, ["no.h5"]),
                ({**two, "cluster": "old.h5"}, ["old.h5"]),
                ({**DISK, "placement": "motif.csv", "t_matrix_gap": 0}, ["t_matrix_gap = 0", "positive"]),
                ({**DISK, "placement": "motif.csv", "t_matrix_gap": 1e-9}, ["gap", "orders"]),
                ({**DISK, "placement": "motif.csv", "t_matrix_gap": 1, "wavelengths": [1, 2]}, ["t_matrix_gap"])):
            self.write_older_result("old.h5")
            self.assert_refused_both_ways("solve", {}, keys, words)


if __name__ == "__main__":
    unittest.main()
