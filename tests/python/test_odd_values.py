"""Impossible values are rejected by key before the program runs; possible ones are passed unchanged."""

import datetime
import decimal
import fractions
import os
import threading
import unittest
from unittest import mock

import numpy as np
import pandas
import xarray

from package import BOX, FEW, SLAB, PackageTest, fs

from flatspeckle import functions

MASKED = np.ma.masked_array([0.1, 0.2], [False, True])
SCALARS = {"masked": np.ma.masked, "none": [None], "empty": [], "set": {1}, "bytes": b"1", "time": datetime.datetime.now(),
           "numpy time": np.datetime64("2020-01-01", "ns"), "generator": (i for i in range(2)), "function": min,
           "ragged": [[1, 2], [3]], "objects": np.array([object()]), "masked array": MASKED, "list of masked": [MASKED, MASKED],
           "null": "a\0b", "quote": 'a"b', "dict": {"a": 1}, "dataset": xarray.Dataset({"a": ("x", [1])}), "huge": 10 ** 5000,
           "empty array": np.zeros((0, 2)), "empty text": "", "ellipsis": ...}
TABLES = {"unequal": {"x": [1, 2], "z": [1]}, "columns of two axes": {"x": np.zeros((2, 2)), "z": [1, 2]}, "no columns": {},
          "not numbers": {"x": ["a"], "z": [1]}, "missing": {"x": [np.nan], "z": [1]}, "masked": {"x": MASKED, "z": [1, 2]},
          "three axes": np.zeros((2, 2, 2)), "too many columns": np.zeros((2, 7)), "none in it": [[1, None]], "ragged": [[1, 2], [3]]}


class Odd(PackageTest):
    def refused(self, subcommand, key, value, *scene, **given):
        """Returns the one line of the rejection; the program must not have run."""
        with mock.patch.object(functions, "run", side_effect=AssertionError("runs")), self.assertRaises(fs.InputError) as caught:
            getattr(fs, subcommand)(*scene, **{**given, key: value})
        self.assertEqual(caught.exception.key, key)
        self.assertNotIn("\n", str(caught.exception))
        return str(caught.exception)

    def test_numbers_and_texts(self):
        for key in ("depth", "light_angles", "seed", "domain", "layers", "g"):
            for name, value in SCALARS.items():
                with self.subTest(key=key, value=name):
                    self.refused("flux", key, value, SLAB)

    def test_tables(self):
        for subcommand, key, scene in (("solve", "placement", {}), ("covariance", "near_sensors", BOX), ("trace", "rays", {})):
            for name, value in TABLES.items():
                with self.subTest(key=key, value=name):
                    self.refused(subcommand, key, value, scene)

    def test_grids_pictures_and_frames(self):
        index = np.ones((4, 4, 4))
        self.assertIn("must have excess, has index", self.refused("trace", "grid", {"index": index}))
        self.refused("trace", "grid", {"excess": index, "origin": "a", "spacing": 1})
        self.refused("trace", "body_mesh", index)
        self.refused("trace", "ball_spline", {"a": index})
        self.refused("design", "pictures", [np.ones(4)])
        self.refused("design", "pictures", [np.ma.masked_array(np.ones((4, 4)), np.eye(4))])
        self.assertIn("list of frames", self.refused("recover", "frames", np.ones((8, 8))))
        self.refused("recover", "frames", np.ones((1, 2, 8, 8)))
        self.refused("recover", "frames", [np.ones(8), np.ones(9)])
        self.refused("sweep", "vary", {"g": [None]}, SLAB, of="flux")
        self.refused("sweep", "vary", {}, SLAB, of="flux")
        self.refused("fit", "free", {"g": {0.1}})

    def test_scenes(self):
        text = self.folder / "no.toml"
        text.write_text("no scene")
        for scene in (5, [1], {1: 2}, b"x", text, self.folder / "none.toml", self.folder):
            with self.subTest(scene=scene), self.assertRaises(fs.InputError) as caught:
                fs.flux(scene)
            self.assertEqual(caught.exception.key, "scene")

    def test_files_that_are_no_results(self):
        for name, content in (("a.csv", b"x,z\n1,a\n"), ("b.csv", b"\xff\xfe\x00"), ("c.csv", b"")):
            (self.folder / name).write_bytes(content)
            with self.subTest(file=name), self.assertRaisesRegex(fs.InputError, f"{name}: must be a result file"):
                fs.read(self.folder / name)

    def test_what_the_program_refuses_has_its_key_too(self):
        with self.assertRaises(fs.InputError) as caught:
            fs.solve(placement=[[0, 0], [0, 0]], scatterer="soft", radius=0.1)
        self.assertEqual(caught.exception.key, "placement")


class Meant(PackageTest):
    def test_numbers_of_other_libraries(self):
        plain = fs.flux(SLAB, depth=100, light_angles=[0.25, 0.5], **FEW)
        for depth in (decimal.Decimal(100), np.longdouble(100), np.float32(100), fractions.Fraction(100), xarray.DataArray(100)):
            for angles in (pandas.Series([0.25, 0.5]), np.ma.masked_array([0.25, 0.5]), (0.25, "0.5"), [decimal.Decimal("0.25"), 0.5]):
                again = fs.flux(SLAB, depth=depth, light_angles=angles, **FEW)
                np.testing.assert_array_equal(again.reflectance, plain.reflectance)

    def test_placements_of_three_columns(self):
        solved = fs.solve(placement=np.array([[0, 1, 0.2], [3, 4, 0.3]]), scatterer="soft", view_angles=[1])
        np.testing.assert_array_equal(solved["placement/radius"], [0.2, 0.3])

    def test_pictures(self):
        pictures = [np.eye(4), np.ones((4, 4))]
        values = functions.all_values("design", fs.Scene(pictures=pictures))["pictures"]
        for path, picture in zip(values, pictures, strict=True):
            np.testing.assert_array_equal(np.loadtxt(path, delimiter=","), picture)

    def test_frames_in_a_list_are_columns(self):
        values = functions.all_values("recover", fs.Scene(frames=[np.arange(9), np.ones(9)]))["frames"]
        np.testing.assert_array_equal(np.loadtxt(values, delimiter=",", skiprows=1), np.stack([np.arange(9), np.ones(9)], 1))

    def test_pictures_are_frames_of_three_axes(self):
        pictures = np.arange(2 * 70 * 80.0).reshape(2, 70, 80)
        for given in (pictures, list(pictures), np.asfortranarray(pictures)):
            path = functions.all_values("recover", fs.Scene(frames=given))["frames"]
            np.testing.assert_array_equal(np.load(path), pictures)
        path = functions.all_values("recover", fs.Scene(frames=pictures, dark=pictures[0]))["dark"]
        np.testing.assert_array_equal(np.load(path), pictures[0])

    def test_files_of_frames_stay_files(self):
        files = [self.folder / "a.png", self.folder / "b.png"]
        for file in files:
            file.touch()
        for given in (files[0], files):
            found = functions.all_values("recover", fs.Scene(frames=given))["frames"]
            self.assertEqual(found, [str(one) for one in given] if given is files else str(given))

    def test_the_same_call_at_once(self):
        """All threads get the result of the one that makes it."""
        found = []

        def call():
            found.append(fs.covariance(BOX, samples=20_000, threads=1, progress=False).encoding["source"])

        threads = [threading.Thread(target=call) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(found), 3)
        self.assertEqual(len(set(found)), 1)

    def test_files_beside_a_scene(self):
        folder = self.folder / "scenes"
        folder.mkdir()
        scene = folder / "scene.toml"
        scene.write_text('domain = "slab"\nscatterer = "hg"\nlayers = "layers.csv"\n')
        with self.assertRaisesRegex(fs.InputError, f"^layers = layers.csv: no such file in {folder}, .*{os.getcwd()}"):
            fs.flux(scene)
        (folder / "layers.csv").write_text("thickness,optical_depth\n20,2\n30,3\n")
        for given in (scene, fs.Scene.load(scene), fs.Scene.load(scene).replace(g=0.5)):
            self.assertEqual(fs.flux(given).layer_thickness.values.tolist(), [20, 30])


if __name__ == "__main__":
    unittest.main()
