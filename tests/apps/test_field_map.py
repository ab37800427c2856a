"""The total field on a grid, streamed into the result file."""

import os
import resource
import signal
import subprocess
import unittest

import h5py
import numpy as np

from program import PROGRAM, ProgramTest, attributes, datasets, flags

DISKS = "x,z,radius,index_re,index_im\n0,0,0.3,1.5,0\n0.9,0.4,0.4,1.5,0.1\n-0.7,1.1,0.25,2,0\n"
CENTRES, RADII = np.array([[0, 0], [0.9, 0.4], [-0.7, 1.1]]), np.array([0.3, 0.4, 0.25])
VIEW = {"map": [-1.5, 2, -1, 1.75], "map_pixels": [14, 11]}
POINTS = {"width": 4, "depth": 4, "count": 3, "map": [-5, 5, -4, 8]}
SEVERAL_TILES = {**POINTS, "map_pixels": [1100, 1300]}


class FieldMap(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("disks.csv", DISKS)

    def solve(self, name="map.h5", **keys):
        self.call("solve", **{"placement": "disks.csv", "scatterer": "tm", **keys}, out=name)
        return datasets(self.folder / name)

    def test_scales_and_storage(self):
        self.solve(**VIEW, light_angles=[0, 1])
        with h5py.File(self.folder / "map.h5") as file:
            field = file["total_field"]
            self.assertEqual(field.shape, (2, 11, 14))
            self.assertEqual(field.compression, "gzip")
            self.assertIsNotNone(field.chunks)
            for axis, name in enumerate(("light_angle", "map_z", "map_x")):
                self.assertEqual(field.dims[axis][0], file[name])
            np.testing.assert_allclose(file["map_x"], -1.5 + 0.25 * (np.arange(14) + 0.5))
            np.testing.assert_allclose(file["map_z"], -1 + 0.25 * (np.arange(11) + 0.5))
            for name in "map_x", "map_z":
                self.assertEqual(file[name].attrs["units"], "length")
            self.assertIn("map of 14 x 11 pixels", file.attrs["plan"])

    def test_outside_it_is_the_near_field_and_the_incident_wave(self):
        for scatterer in "tm", "soft":
            found = self.solve(**VIEW, light_angles=[0.3, 2], scatterer=scatterer)
            z, x = np.meshgrid(found["map_z"], found["map_x"], indexing="ij")
            distance = np.hypot(x[..., None] - CENTRES[:, 0], z[..., None] - CENTRES[:, 1])
            outside = np.all(distance > RADII, axis=-1)
            self.assertTrue(outside.any() and not outside.all())
            lines = [f"{a!r},{b!r}\n" for a, b in zip(x[outside].tolist(), z[outside].tolist())]
            self.write("sensors.csv", "x,z\n" + "".join(lines))
            near = self.solve(near_sensors="sensors.csv", light_angles=[0.3, 2],
                              scatterer=scatterer, name="near.h5")["near_field"]
            light = np.array([0.3, 2])[:, None]
            path = np.sin(light) * x[outside] + np.cos(light) * z[outside]
            incident = np.exp(2j * np.pi * path)
            np.testing.assert_allclose(found["total_field"][:, outside], near + incident, atol=1e-9)
            inside = found["total_field"][:, ~outside]
            if scatterer == "soft":
                np.testing.assert_array_equal(inside, 0)
            else:
                self.assertGreater(np.abs(inside).min(), 1e-3)

    def test_tiles_fit_together(self):
        """The map has several tiles; its lower right quarter alone is a single one."""
        whole = self.call("solve", **SEVERAL_TILES, out="whole.h5")
        self.assertRegex(whole.stdout, r"in [2-9] tiles")
        self.call("solve", **{**POINTS, "map": [0, 5, 2, 8]}, map_pixels=[550, 650], out="part.h5")
        whole, part = (datasets(self.folder / f"{name}.h5") for name in ("whole", "part"))
        np.testing.assert_allclose(part["map_x"], whole["map_x"][550:], atol=1e-12)
        np.testing.assert_allclose(part["total_field"], whole["total_field"][:, 650:, 550:],
                                   atol=1e-8)

    def test_ten_pixels_per_wavelength(self):
        found = self.solve(map=[0, 3, -1, 1], wavelength=2)
        self.assertEqual(found["total_field"].shape, (1, 10, 15))

    def test_without_scatterers_it_is_the_incident_wave(self):
        self.write("none.csv", "x,z\n")
        found = self.solve(placement="none.csv", scatterer="point", map=[0, 1, 0, 1])
        expected = np.exp(2j * np.pi * found["map_z"])
        np.testing.assert_allclose(found["total_field"][0], expected[:, None] * np.ones(10),
                                   atol=1e-14)

    def test_the_rest_of_the_file_is_as_without_a_map(self):
        mapped, plain = self.solve(**VIEW), self.solve("plain.h5")
        for name in "light_angle", "view_angle", "placement/x", "placement/radius":
            np.testing.assert_array_equal(mapped[name], plain[name])
        np.testing.assert_allclose(mapped["far_field"], plain["far_field"], rtol=1e-10)
        keys = set(attributes(self.folder / "plain.h5"))
        self.assertEqual(keys, set(attributes(self.folder / "map.h5")))

    def test_the_stored_configuration_makes_the_same_map(self):
        self.call("solve", **POINTS, map_pixels=[9, 7], out="map.h5")
        config = attributes(self.folder / "map.h5")["config"]
        self.write("again.toml", config)
        self.call("solve", "--config", "again.toml", out="again.h5")
        self.assert_same_data("map.h5", "again.h5")


class BadInput(ProgramTest):
    def test_one_line_and_no_file(self):
        cases = [
            ({"map": [1, -1, 0, 1]}, ["map = 1 -1 0 1", "x0 < x1"]),
            ({"map": [0, 1, 2, 2]}, ["map = 0 1 2 2", "z0 < z1"]),
            ({"map": [0, 1, 2]}, ["map = 0 1 2", "x0 x1 z0 z1"]),
            ({"map": [0, 1, 2, "nan"]}, ["map = 0 1 2 nan"]),
            ({"map": [0, "inf", 2, 3]}, ["map = 0 inf 2 3"]),
            ({"map": [0, "x", 2, 3]}, ["map", "x", "number"]),
            ({"map": [0, 1, 0, 1], "map_pixels": [0, 5]}, ["map_pixels = 0", "1 to 100000"]),
            ({"map": [0, 1, 0, 1], "map_pixels": [5, -5]}, ["map_pixels = 5 -5", "1 to 100000"]),
            ({"map": [0, 1, 0, 1], "map_pixels": [5]}, ["map_pixels = 5", "nx nz"]),
            ({"map": [0, 1, 0, 1], "map_pixels": [5, 1.5]}, ["map_pixels", "1.5", "whole"]),
            ({"map": [0, 1, 0, 1], "map_pixels": [10 ** 9, 1]}, ["map_pixels = 1000000000"]),
            ({"map": [0, 1e9, 0, 1]}, ["map = 1e+09", "ten pixels per wavelength"]),
            ({"map_pixels": [5, 5]}, ["map_pixels = 5 5", "map"]),
        ]
        for keys, words in cases:
            with self.subTest(keys=keys):
                done = self.call("solve", width=4, depth=4, count=3, **keys, out="map.h5", status=2)
                self.assertRegex(done.stderr, r"\Aflatspeckle: .+\n\Z")
                for word in words:
                    self.assertIn(word, done.stderr)
                self.assertEqual(self.listing(), {})


class Unfinished(ProgramTest):
    """An unfinished map leaves the older file in place and no others."""

    def setUp(self):
        super().setUp()
        self.write_older_result("map.h5")
        self.before = self.listing()

    def test_interrupted(self):
        for number in signal.SIGINT, signal.SIGTERM:
            process = self.start("solve", **{**POINTS, "map_pixels": [4000, 4000]}, out="map.h5")
            self.wait_until_it_catches(process, number)
            self.wait_until(process, lambda: any(".tmp" in name for name in os.listdir(self.folder)))
            process.send_signal(number)
            self.assertEqual(process.wait(timeout=60), 130)
            self.assertEqual(self.listing(), self.before)

    def test_full_disk(self):
        for room in 1024, 2_000_000, 12_000_000:
            def little_room():
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))

            done = subprocess.run([PROGRAM, "solve", *flags(SEVERAL_TILES), "--out", "map.h5"],
                                  cwd=self.folder, text=True, capture_output=True, timeout=120,
                                  preexec_fn=little_room, restore_signals=False)
            self.assertEqual(done.returncode, 4, done.stderr)
            self.assertRegex(done.stderr, r"(^|\n)flatspeckle: writing map.h5 failed: .+\n$")
            self.assertEqual(self.listing(), self.before)


if __name__ == "__main__":
    unittest.main()
