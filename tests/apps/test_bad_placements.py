"""Bad placements: status 2, one line that names file, column and value, no file."""

import unittest

from program import flags
from refusing import RefusingTest

POSITIVE = "must be positive"


class Placements(RefusingTest):
    def refused(self, text, words, **keys):
        with self.subTest(text=text):
            content = text if isinstance(text, bytes) else text.encode()
            (self.folder / "disks.csv").write_bytes(content)
            scatterer = {"scatterer": "tm", "placement": "disks.csv", **keys}
            self.assert_refused(words, "solve", *flags(scatterer))

    def test_malformed(self):
        self.refused("", ["disks.csv", "empty"])
        self.refused("x,radius\n1,2\n", ["disks.csv", "column z"])
        self.refused("x,z\n1,2\n", ["disks.csv", "column radius"])
        self.refused("x,z,radius\n1,two,0.1\n", ["disks.csv", "line 2", "z", "two"])
        self.refused("x,z,radius\n1,nan,0.1\n", ["disks.csv", "line 2", "z", "nan"])
        self.refused("x,z,radius\n1,inf,0.1\n", ["disks.csv", "line 2", "z", "inf"])
        self.refused("x,z,radius\n1,2\n", ["disks.csv", "line 2", "expected 3 fields, found 2"])
        self.refused("x,z,radius\n1,2,3,4\n", ["disks.csv", "line 2", "expected 3 fields, found 4"])
        self.refused("x,z,radius\n1,2,\n", ["disks.csv", "line 2", "radius"])
        self.refused("x,z,radius,radius\n1,2,3,4\n", ["disks.csv", "radius", "twice"])
        self.refused(bytes(range(256)) * 9, ["disks.csv"])

    def test_values(self):
        self.refused("x,z,radius\n1,2,0\n", ["disks.csv", "radius = 0", POSITIVE])
        self.refused("x,z,radius\n1,2,-1\n", ["disks.csv", "radius = -1", POSITIVE])
        self.refused("x,z,radius,index_re,index_im\n1,2,0.1,0,0\n", ["disks.csv", "index"])
        self.refused("x,z,radius,index_re,index_im\n1,2,0.1,1.5,-1\n", ["disks.csv", "index"])
        self.refused("x,z,radius,index_im\n1,2,0.1,1\n", ["disks.csv", "index_re"])
        self.refused("x,z,radius,index\n1,2,0.1,1.5\n", ["disks.csv", '"index"', "index_re"])

    def test_overlaps(self):
        for second in ("0.1,0", "0,0", "0.2,0"):
            self.refused(f"x,z,radius\n5,5,0.1\n0,0,0.1\n{second},0.1\n", ["placement", "2 and 3"])
        self.refused("x,z\n0,0\n0,0\n", ["placement", "1 and 2"], scatterer="point")

    def test_keys_that_contradict_the_file(self):
        self.write("disks.csv", "x,z,radius\n1,2,0.1\n")
        placed = {"scatterer": "tm", "placement": "disks.csv"}
        for key in ("width", "depth", "count", "density", "mean_free_path", "optical_depth",
                    "min_gap"):
            with self.subTest(key=key):
                self.assert_refused([key, "disks.csv"], "solve", *flags({**placed, key: 1}))
        self.assert_refused(["domain", "disks.csv"], "solve", *flags({**placed, "domain": "slab"}))
        self.assert_refused(["solver = lu", "auto dense fast krylov"], "solve",
                            *flags({**placed, "solver": "lu"}))
        self.assert_refused(["scatterer = hg"], "solve", *flags({**placed, "scatterer": "hg"}))

    def test_sensor_inside_a_disk(self):
        self.write("disks.csv", "x,z,radius\n1,2,0.5\n")
        for place in ("1.2,2", "1,2.1", "1.4999999,2"):
            self.write("sensors.csv", f"x,z\n8,8\n{place}\n")
            self.assert_refused(["near_sensors = (1.", "outside"], "solve", scatterer="tm",
                                placement="disks.csv", near_sensors="sensors.csv")

    def test_sensor_on_a_point(self):
        self.write("points.csv", "x,z\n1,2\n")
        self.write("sensors.csv", "x,z\n1,2\n")
        self.assert_refused(["near_sensors", "outside"], "solve", placement="points.csv",
                            near_sensors="sensors.csv")


if __name__ == "__main__":
    unittest.main()
