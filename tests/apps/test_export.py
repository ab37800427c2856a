"""export: CSV of any dataset, equal to what h5py reads; ranges that are only bounds are NaN."""

import csv
import io
import struct
import unittest
import zlib

import h5py
import numpy as np

from program import SLAB, ProgramTest
from refusing import RefusingTest

CURVE = {**SLAB, "covariance": "memory_effect", "method": "transport", "tolerance": 1e-3, "light_angles": 0.1,
         "view_angles": [0.1, 0.3]}


def read_exr(data):
    """Returns the channel Y of an OpenEXR file of uncompressed scan lines."""
    assert struct.unpack_from("<ii", data) == (20000630, 2)
    at, header = 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        size = struct.unpack_from("<i", data, at)[0]
        header[name.decode()] = kind.decode(), data[at + 4:at + 4 + size]
        at += 4 + size
    assert {name: kind for name, (kind, _) in header.items()} == {
        "channels": "chlist", "compression": "compression", "dataWindow": "box2i", "displayWindow": "box2i",
        "lineOrder": "lineOrder", "pixelAspectRatio": "float", "screenWindowCenter": "v2f", "screenWindowWidth": "float"}
    assert header["channels"][1] == struct.pack("<2si4B2iB", b"Y", 2, 0, 0, 0, 0, 1, 1, 0)
    assert header["compression"][1] == header["lineOrder"][1] == b"\0"
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"][1])
    assert (left, top, header["displayWindow"][1]) == (0, 0, header["dataWindow"][1])
    rows = []
    for row, line in enumerate(np.frombuffer(data, "<u8", bottom + 1, at + 1)):
        assert struct.unpack_from("<2i", data, line) == (row, 4 * (right + 1))
        rows.append(np.frombuffer(data, "<f4", right + 1, int(line) + 8))
    assert len(data) == line + 8 + 4 * (right + 1)
    return np.array(rows)


def read_png(path):
    """Returns the pixels of a grey PNG file."""
    data, at, parts = path.read_bytes(), 8, {}
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        parts[kind] = parts.get(kind, b"") + data[at + 8:at + 8 + size]
        at += 12 + size
    columns, rows, depth, colour = struct.unpack_from(">IIBB", parts[b"IHDR"])
    assert colour == 0 and b"gAMA" in parts and parts[b"tEXt"].startswith(b"flatspeckle\0")
    size = depth // 8
    lines = np.frombuffer(zlib.decompress(parts[b"IDAT"]), np.uint8).reshape(rows, 1 + size * columns)
    out = np.zeros((rows, size * columns), np.uint8)
    for row, (kind, *line) in enumerate(lines):
        for i, byte in enumerate(line):
            left, up, corner = (int(out[row, i - size]) if i >= size else 0, int(out[row - 1, i]) if row else 0,
                                int(out[row - 1, i - size]) if row and i >= size else 0)
            nearest = min((left, up, corner), key=lambda value: abs(left + up - corner - value))
            out[row, i] = (byte + (0, left, up, (left + up) // 2, nearest)[kind]) % 256
    return np.frombuffer(out.tobytes(), f">u{size}").reshape(rows, columns)


class Files(ProgramTest):
    """Pictures of render as PFM, OpenEXR, PNG and NPY."""

    def test_pictures(self):
        self.call("render", stage_box=[-1, -1, 0, 1, 1, 2], mu_s=1, point_light=[0.3, 0.4, 1, 1], sensor="area", sensor_at=[0, 0, 2],
                  sensor_size=[2, 2], pixels=[6, 4], samples=4000, out="r.h5")
        with h5py.File(self.folder / "r.h5") as file:
            image, rows = file["image"][:], file["row"][:]
        top_down = image if rows[0] > rows[-1] else image[::-1]
        self.call("export", "r.h5", "image", to="r.pfm")
        kind, size, scale, data = (self.folder / "r.pfm").read_bytes().split(b"\n", 3)
        self.assertEqual((kind, size, scale), (b"Pf", b"%d %d" % image.shape[::-1], b"-1.0"))
        np.testing.assert_array_equal(np.frombuffer(data, "<f4").reshape(image.shape), top_down[::-1].astype("f4"))
        self.call("export", "r.h5", "image", to="r.exr")
        np.testing.assert_array_equal(read_exr((self.folder / "r.exr").read_bytes()), top_down.astype("f4"))
        self.call("export", "r.h5", "image", to="r.npy")
        np.testing.assert_array_equal(np.load(self.folder / "r.npy"), image)
        done = self.call("export", "r.h5", "image", to="r.png")
        white = np.quantile(image, 0.995, method="lower")
        self.assertIn("for display (gamma 2.2, white = ", done.stdout)
        self.assertAlmostEqual(float(done.stdout.split("white = ")[1].split(")")[0]), white)
        np.testing.assert_array_equal(read_png(self.folder / "r.png"), np.round(255 * np.clip(top_down / white, 0, 1)**(1 / 2.2)))
        done = self.call("export", "r.h5", "image", to="linear.png", linear=True)
        self.assertIn("linear (count = ", done.stdout)
        np.testing.assert_array_equal(read_png(self.folder / "linear.png"), np.round(65535 / image.max() * image))
        for words, flags in (("must end with", {"to": "r.gif"}), ("two axes", {"dataset": "mean", "to": "r.png"}),
                             ("two axes", {"dataset": "mean", "to": "r.png", "linear": True}),
                             ("linear", {"to": "r.tif", "linear": True})):
            done = self.call("export", "r.h5", flags.pop("dataset", "image"), **flags, status=2)
            self.assertIn(words, done.stderr)


class ExportTest(ProgramTest):
    def table(self, *words):
        """Returns the comment and the columns {name: texts} that export prints."""
        lines = self.call("export", *words).stdout.splitlines(keepends=True)
        comment = lines.pop(1) if lines[1].startswith("#") else ""
        names, *rows = csv.reader(io.StringIO("".join(lines)))
        return comment, dict(zip(names, map(list, zip(*rows))))

    def assert_columns(self, table, **columns):
        """Checks names, order and values of all columns."""
        self.assertEqual(list(table), list(columns))
        for name, values in columns.items():
            np.testing.assert_array_equal(np.array(table[name], float), np.ravel(values), name)

    def write_example(self):
        """Writes a file with axes in groups, whole numbers, complex numbers and texts."""
        with h5py.File(self.folder / "e.h5", "w") as file:
            for name, values in (("x", [0.5, 1.5]), ("y", [1e-300, 2, 1 / 3]), ("far/z", [7.0, 8, 9])):
                file[name] = np.array(values)
                file[name].make_scale(name)
            file["x"].attrs["units"] = "length"
            rng = np.random.default_rng(1)
            file["far/map"] = rng.normal(size=(2, 3)) + 1j * rng.normal(size=(2, 3))
            file["far/map_error"] = rng.random((2, 3))
            file["count"] = np.arange(3, dtype=np.uint64)
            file["word"] = ["a,b", 'say "x"', "plain"]
            file["bare"] = rng.random((2, 1))
            file["one"] = 0.1
            for name, axes in (("far/map", ["x", "y"]), ("far/map_error", ["x", "y"]), ("count", ["far/z"]),
                               ("word", ["far/z"])):
                for axis, scale in enumerate(axes):
                    file[name].dims[axis].attach_scale(file[scale])
            file["state/sums"] = [1.0]
            return {name: file[name][()] for name in ("x", "y", "far/z", "far/map", "far/map_error", "count", "bare")}

    def test_all_kinds_of_datasets(self):
        found = self.write_example()
        comment, table = self.table("e.h5", "far/map")
        self.assertEqual(comment, "# units: x [length]\n")
        self.assert_columns(table, **{"x": np.repeat(found["x"], 3), "y": np.tile(found["y"], 2),
                                      "far/map_re": found["far/map"].real, "far/map_im": found["far/map"].imag,
                                      "far/map_error": found["far/map_error"]})
        table = self.table("e.h5", "count", "word")[1]
        self.assertEqual(table.pop("word"), ["a,b", 'say "x"', "plain"])
        self.assert_columns(table, **{"far/z": found["far/z"], "count": [0, 1, 2]})
        self.assert_columns(self.table("e.h5", "bare")[1], **{"bare.0": [0, 1], "bare.1": [0, 0], "bare": found["bare"]})
        self.assert_columns(self.table("e.h5", "one")[1], one=[0.1])

    def test_ranges_that_are_bounds(self):
        for name, q_depths in (("known", "0:4:9"), ("above", [0, 0.1, 0.2]), ("below", [0, 5, 6])):
            self.call("covariance", **CURVE, q_depths=q_depths, out=f"{name}.h5")
            with h5py.File(self.folder / f"{name}.h5") as file:
                value, error = (file["memory_effect_range" + of][()] for of in ("", "_error"))
                curve = {of: file[of][()] for of in ("tilt", "field_correlation", "field_correlation_error")}
            nan = np.nan
            expected = {"known": (value, error, nan, nan), "above": (nan, nan, value, nan),
                        "below": (nan, nan, nan, value)}[name]
            names = ["memory_effect_range" + of for of in ("", "_error", "_at_least", "_at_most")]
            comment, table = self.table(f"{name}.h5", names[0])
            self.assertIn("memory_effect_range [1]", comment)
            self.assert_columns(table, **dict(zip(names, expected)))
            comment, table = self.table(f"{name}.h5", "field_correlation")
            self.assertIn("tilt [rad]", comment)
            self.assert_columns(table, **curve)

    def test_sweeps_with_bounds(self):
        for name, keys in (("curves", {}), ("results", {"of": "covariance", **CURVE, "depth": None})):
            values = {"depth": 100, "optical_depth": [0.1, 4]} if name == "curves" else \
                {"depth": 100, "optical_depth": None, "vary": "optical_depth=0.1,4"}
            settings = {**CURVE, "covariance": None} if name == "curves" else keys
            self.call("sweep", **{**settings, **values}, q_depths=[0, 0.5, 1, 1.5, 2, 2.5, 3], out=f"{name}.h5")
            table = self.table(f"{name}.h5", "memory_effect_range")[1]
            known, bound = (np.array(table["memory_effect_range" + of], float) for of in ("", "_at_least"))
            np.testing.assert_array_equal(np.isnan(known), [True, False], name)
            np.testing.assert_array_equal(np.isnan(bound), [False, True], name)
            self.assertAlmostEqual(bound[0], 3, places=9)


class RefusedTest(RefusingTest):
    def refused(self, *words):
        done = self.call("export", *words, status=2)
        self.assertEqual((done.stdout, done.stderr.count("\n")), ("", 1))
        return done.stderr

    def test_refused(self):
        ExportTest.write_example(self)
        self.assertIn("export = nothing: must be one of bare count far/map", self.refused("e.h5", "nothing"))
        self.assertNotIn("state", self.refused("e.h5", "state/sums").split("one of")[1])
        self.assertIn("names of datasets", self.refused("e.h5"))
        self.assertIn("must have the axes of count", self.refused("e.h5", "count", "bare"))
        self.assertIn("no such file", self.refused("none.h5", "count"))
        self.write("text.h5", "no HDF5")
        self.assertIn("text.h5: not a readable HDF5 file", self.refused("text.h5", "count"))
        self.assertIn("must have a result file", self.refused())


if __name__ == "__main__":
    unittest.main()
