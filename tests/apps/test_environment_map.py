"""Light from a picture of all directions: its directions, and powers by every method."""

import itertools
import struct
import unittest
import zlib

import numpy as np

from renders import BOX, RenderTest

ROWS, COLUMNS = 8, 16
COMPRESSIONS = ["none", "rle", "zips", "zip"]


def directions():
    """Unit vectors to the middles of the pixels: centre z, up y, columns to the right (-x)."""
    angle = np.pi * (np.arange(ROWS)[:, None] + 0.5) / ROWS
    azimuth = 2 * np.pi * ((np.arange(COLUMNS)[None, :] + 0.5) / COLUMNS - 0.5)
    return np.stack(np.broadcast_arrays(-np.sin(angle) * np.sin(azimuth), np.cos(angle),
                                        np.sin(angle) * np.cos(azimuth)), axis=-1)


def sky():
    """A picture with a bright pixel: every pixel has another value."""
    values = 0.5 + np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS) / 100
    values[2, 11] = 40
    return values


def write_pfm(path, values):
    with open(path, "wb") as file:
        file.write(f"Pf\n{values.shape[1]} {values.shape[0]}\n-1.0\n".encode())
        file.write(values[::-1].astype("<f4").tobytes())


def runs(data, least=3, most=127):
    """Yields whether the next bytes are equal, and these bytes, at most 127."""
    pending = b""
    for _, group in itertools.groupby(data):
        same = bytes(group)
        if pending and (len(same) >= least or len(pending) > most - least):
            yield False, pending
            pending = b""
        if len(same) >= least:
            yield from ((True, same[i:i + most]) for i in range(0, len(same), most))
        else:
            pending += same
    if pending:
        yield False, pending


def exr_block(block, compression):
    """Returns a block of lines as OpenEXR compresses it: even bytes first, differences of bytes, ZIP or run lengths."""
    if compression == "none":
        return block
    parted = np.frombuffer(block[::2] + block[1::2], np.uint8).astype(int)
    coded = bytes([parted[0], *((np.diff(parted) + 128) % 256)])
    packed = zlib.compress(coded) if "zip" in compression else b"".join(
        bytes([len(part) - 1, part[0]]) if same else bytes([256 - len(part)]) + part for same, part in runs(coded))
    return packed if len(packed) < len(block) else block


def write_hdr(path, colours, is_packed, variables=""):
    """Writes a Radiance HDR of these [row, column, colour], flat or with run lengths. Returns its luminance."""
    rows, columns, _ = colours.shape
    exponent = np.frexp(colours.max(axis=2))[1]
    mantissas = np.floor(colours * 256 / 2.0**exponent[:, :, None])
    pixels = np.concatenate([mantissas, exponent[:, :, None] + 128], axis=2).astype(np.uint8)
    data = pixels.tobytes()
    if is_packed:
        data = b"".join(bytes([2, 2, columns // 256, columns % 256]) + b"".join(
            bytes([128 + len(part), part[0]]) if same else bytes([len(part)]) + part
            for channel in row.T for same, part in runs(channel.tobytes())) for row in pixels)
    path.write_bytes(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{variables}\n-Y {rows} +X {columns}\n".encode() + data)
    return mantissas @ [0.2126, 0.7152, 0.0722] * 2.0**(exponent - 8)


def write_exr(path, channels, compression="none"):
    """Writes an OpenEXR file of scan lines with these channels {name: values}, in the order of names."""
    rows, columns = next(iter(channels.values())).shape
    window = struct.pack("<4i", 0, 0, columns - 1, rows - 1)
    listed = b"".join(name.encode() + struct.pack("<Biiii", 0, 1 if values.dtype.itemsize == 2 else 2, 0, 1, 1)
                      for name, values in sorted(channels.items())) + b"\0"
    header = struct.pack("<2i", 20000630, 2)
    for name, kind, value in (("channels", "chlist", listed), ("compression", "compression", bytes([COMPRESSIONS.index(compression)])),
                              ("dataWindow", "box2i", window), ("displayWindow", "box2i", window)):
        header += f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value
    header += b"\0"
    lines = [b"".join(values[row].tobytes() for _, values in sorted(channels.items())) for row in range(rows)]
    step = 16 if compression == "zip" else 1
    blocks = [exr_block(b"".join(lines[row:row + step]), compression) for row in range(0, rows, step)]
    places = len(header) + 8 * len(blocks) + np.cumsum([0, *(8 + len(block) for block in blocks[:-1])])
    path.write_bytes(header + places.astype("<u8").tobytes() +
                     b"".join(struct.pack("<2i", step * i, len(block)) + block for i, block in enumerate(blocks)))


class EnvironmentMap(RenderTest):
    def setUp(self):
        super().setUp()
        self.values = sky()
        np.save(self.folder / "sky.npy", self.values)

    def test_directions(self):
        """A narrow camera in an empty stage measures the pixel that it looks at, without noise."""
        for row, column in ((2, 11), (0, 3), (5, 15), (7, 8), (3, 0)):
            found = self.render(**BOX, environment_map="sky.npy", environment=2, sensor="camera",
                                sensor_at=[0.1, 0, 2], sensor_direction=list(directions()[row, column]),
                                sensor_up=[0.3, 0.2, 1], field_of_view=0.05, pixels=[2, 2],
                                method="path", samples=400)
            np.testing.assert_allclose(found["image"], 2 * self.values[row, column], rtol=1e-12)

    def seen(self, name):
        """Returns the value of one pixel of a picture in an empty stage: row 3, column 8 of those of sky()."""
        return self.render(**BOX, environment_map=name, environment_centre=[1, 0, 0],
                           environment_up=[0, 0, 1], sensor="camera", sensor_at=[0.1, 0, 2],
                           sensor_direction=[np.cos(0.2), -np.sin(0.2), 0.2], sensor_up=[0, 0, 1],
                           field_of_view=0.02, pixels=[1, 1], method="path", samples=400)["image"]

    def test_turned_and_in_other_formats(self):
        write_pfm(self.folder / "sky.pfm", self.values)
        write_exr(self.folder / "y.exr", {"Y": self.values.astype("<f4")})
        write_exr(self.folder / "rgb.exr", {"B": 3 * self.values.astype("<f2"), "G": self.values.astype("<f4"),
                                            "R": 2 * self.values.astype("<f2")})
        for name, factor in (("sky.pfm", 1), ("y.exr", 1), ("rgb.exr", 0.7152 + 2 * 0.2126 + 3 * 0.0722)):
            np.testing.assert_allclose(self.seen(name), factor * self.values[3, 8], rtol=1e-3 if factor > 1 else 1e-6)

    def test_compressed(self):
        """OpenEXR with each compression, in blocks of 16 lines and a rest, and Radiance HDR agree with the pixels."""
        values = np.kron(self.values, np.ones((3, 8)))
        write_exr(self.folder / "none.exr", {"Y": values.astype("<f2")})
        for compression in COMPRESSIONS[1:]:
            path = self.folder / f"{compression}.exr"
            write_exr(path, {"Y": values.astype("<f2")}, compression)
            self.assertLess(path.stat().st_size, 0.8 * (self.folder / "none.exr").stat().st_size)
            np.testing.assert_array_equal(self.seen(path.name), self.seen("none.exr"))
        colours = values[:, :, None] * [2, 1, 3]
        for is_packed, variables in ((False, ""), (True, ""), (True, "EXPOSURE=2\nEXPOSURE=0.25\n")):
            luminance = write_hdr(self.folder / "sky.hdr", colours, is_packed, variables)
            np.testing.assert_allclose(self.seen("sky.hdr"), luminance[10, 68] * (2 if variables else 1), rtol=1e-9)

    def test_cut_off(self):
        """Files that end early are refused in one line."""
        values = np.kron(self.values, np.ones((1, 8)))
        write_hdr(self.folder / "sky.hdr", values[:, :, None] * [2, 1, 3], True)
        for compression in COMPRESSIONS:
            write_exr(self.folder / f"{compression}.exr", {"Y": values.astype("<f2")}, compression)
        for path in [*self.folder.glob("*.exr"), self.folder / "sky.hdr"]:
            data = path.read_bytes()
            for size in (12, 30, len(data) // 2, len(data) - 1):
                path.write_bytes(data[:size])
                done = self.call("render", status=2, **BOX, environment_map=path.name, sensor="polar",
                                 sensor_direction=[0, 0, 1], rings=2, samples=100, out="bad.h5")
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                self.assertIn(path.name, done.stderr)

    def test_powers_by_every_method(self):
        """The irradiance of an area in scattering fog: rays of an own sum are the reference where nothing
        scatters, path tracing, which never samples the map, where the fog scatters."""
        area = {"sensor": "area", "sensor_at": [0, 0, 4], "sensor_size": [1, 0.8], "pixels": [1, 1],
                "samples": 60000}
        fine = np.pi * (np.arange(400)[:, None] + 0.5) / 400
        weights = np.sin(fine) * (np.pi / 400) * (2 * np.pi / 800)
        azimuth = 2 * np.pi * ((np.arange(800)[None, :] + 0.5) / 800 - 0.5)
        arriving = np.maximum(-np.sin(fine) * np.cos(azimuth), 0)  # cosine at the face z = 4
        clear = np.sum(np.kron(self.values, np.ones((50, 50))) * arriving * weights)
        fog = {}
        for method in ("path", "light", "bidirectional", "forward"):
            with self.subTest(method=method):
                found = self.render(**BOX, **area, environment_map="sky.npy", method=method)
                self.assertLess(abs(found["mean"] - clear), 4 * found["mean_error"] + 1e-3 * clear)
                found = self.render(**BOX, **area, environment_map="sky.npy", method=method, mu_s=0.5)
                fog[method] = found["mean"], found["mean_error"]
                self.assertLess(found["mean_error"], 0.05 * found["mean"])
        for method, (mean, error) in fog.items():
            self.assertLess(abs(mean - fog["path"][0]), 4 * np.hypot(error, fog["path"][1]), method)

    def test_refused(self):
        for values, words in ((np.zeros((2, 2)), "some above 0"), (-self.values, "from 0 on"),
                              (np.ones((3, 2, 2)), "one picture")):
            np.save(self.folder / "bad.npy", values)
            done = self.call("render", status=2, **BOX, environment_map="bad.npy", sensor="polar",
                             sensor_direction=[0, 0, 1], rings=2, samples=100, out="bad.h5")
            self.assertIn("environment_map", done.stderr)
            self.assertIn(words, done.stderr)
        (self.folder / "bad.pfm").write_bytes(b"Pf\n4 4\n-1.0\n123")
        for keys, words in (({"environment_map": "bad.pfm"}, "4 bytes"),
                            ({"environment_map": "sky.npy", "environment_up": [0, 0, 2]}, "parallel"),
                            ({"environment": 1, "environment_up": [1, 0, 0]}, "environment_map")):
            done = self.call("render", status=2, **BOX, **keys, sensor="polar",
                             sensor_direction=[0, 0, 1], rings=2, samples=100, out="bad.h5")
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
