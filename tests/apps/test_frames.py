"""Frames as cameras write them: formats, corrections, and pictures recovered from them."""

import unittest

import h5py
import numpy as np

from frame_files import diffused, letter, similarity, speckle, write_all, write_png, write_tiff
from program import ProgramTest, datasets
from refusing import RefusingTest

FAST = {"longest": 30, "starts": 2, "phase_iterations": 40}


class Formats(ProgramTest):
    def test_one_frame_in_six_formats_gives_the_same_bits(self):
        random = np.random.default_rng(1)
        frame = np.round(500 * diffused(192, letter(), 4, random)).astype(np.uint16)
        results = {}
        for name, keys in write_all(self.folder, frame).items():
            self.call("recover", frames=name, **keys, **FAST, out="r.h5")
            results[name] = datasets(self.folder / "r.h5")
        first = results.pop("frame.png")
        opaque = np.full_like(frame, 65535)
        write_png(self.folder / "rgba.png", np.stack([frame] * 3 + [opaque], axis=-1))
        (self.folder / "colours.pfm").write_bytes(
            b"PF\n%d %d\n-1\n" % frame.shape[::-1] + np.repeat(frame[::-1, :, None], 3, axis=-1).astype("<f4").tobytes())
        for name in ("rgba.png", "colours.pfm"):  # with equal colours
            self.call("recover", frames=name, **FAST, out="r.h5")
            results[name] = datasets(self.folder / "r.h5")
        for name, found in results.items():
            for dataset in ("autocorrelation", "phased_picture", "phase_residual", "contrast"):
                np.testing.assert_array_equal(found[dataset], first[dataset], f"{name} {dataset}")

    def test_pages_are_frames_and_may_be_averaged(self):
        random = np.random.default_rng(2)
        frames = np.array([diffused(128, letter(), 4, random) for _ in range(4)])
        write_tiff(self.folder / "pages.tif", list(frames))
        np.save(self.folder / "stack.npy", frames)
        np.save(self.folder / "by_columns.npy", np.asfortranarray(frames))
        self.call("recover", frames="by_columns.npy", **FAST, out="a.h5")
        by_columns = datasets(self.folder / "a.h5")
        self.call("recover", frames="pages.tif", **FAST, out="a.h5")
        self.call("recover", frames="stack.npy", average=2, **FAST, out="b.h5")
        each, both = datasets(self.folder / "a.h5"), datasets(self.folder / "b.h5")
        self.assertEqual(each["autocorrelation"].shape[0], 4)
        np.testing.assert_array_equal(by_columns["autocorrelation"], each["autocorrelation"])
        np.testing.assert_allclose(both["autocorrelation"][0], each["autocorrelation"][:2].mean(axis=0), atol=1e-12)

    def test_corrections(self):
        """Dark and flat frames, a region and binning give the frame that they would have spoiled."""
        random = np.random.default_rng(3)
        clean = diffused(128, letter(), 4, random, photons=500)
        dark, flat = 20 * random.random((256, 300)), 1 + 0.5 * random.random((256, 300))
        spoiled = np.ones((256, 300))
        spoiled[:, 30:286] = np.kron(clean / 4, np.ones((2, 2)))
        for name, values in (("frames", spoiled * flat + dark), ("dark", dark), ("flat", 3 * flat + dark),
                             ("clean", clean)):
            np.save(self.folder / f"{name}.npy", values)
        self.call("recover", frames="frames.npy", dark="dark.npy", flat="flat.npy", region=[30, 0, 256, 256], binning=2,
                  **FAST, out="a.h5")
        self.call("recover", frames="clean.npy", **FAST, out="b.h5")
        found, expected = datasets(self.folder / "a.h5"), datasets(self.folder / "b.h5")
        np.testing.assert_allclose(found["autocorrelation"], expected["autocorrelation"], atol=1e-9)

    def test_saturated_pixels_are_counted(self):
        frame = np.full((64, 64), 100, np.uint8) + np.arange(64, dtype=np.uint8)
        frame[:3, 0] = 255
        write_png(self.folder / "frame.png", frame)
        said = self.call("recover", frames="frame.png", longest=12, starts=1, phase_iterations=4, out="r.h5").stderr
        self.assertIn("3 of 4096 pixels", said)


class Pictures(ProgramTest):
    def test_a_letter_behind_a_diffuser_is_recovered(self):
        random = np.random.default_rng(4)
        write_png(self.folder / "frame.png", np.round(
            diffused(768, letter(), 3, random, photons=2000)).clip(0, 65535).astype(np.uint16))
        self.call("recover", frames="frame.png", longest=36, photons=2000, starts=12, phase_iterations=300, out="r.h5")
        found = datasets(self.folder / "r.h5")
        self.assertGreater(similarity(letter(), found["phased_picture"][0]), 0.85)
        self.assertGreater(found["agreement"][0], 0.8)

    def test_a_bispectrum_keeps_the_orientation(self):
        random = np.random.default_rng(7)
        frames = np.array([diffused(512, letter(), 3, random, photons=5000) for _ in range(4)])
        np.save(self.folder / "frames.npy", frames)
        for count in (1, 4):
            self.call("recover", frames="frames.npy", longest=34, recovery="bispectrum", average=count, out="r.h5")
            for picture in datasets(self.folder / "r.h5")["phased_picture"]:
                upright, turned = (similarity(letter(), picture, (turn,)) for turn in (False, True))
                if count == 4:
                    self.assertGreater(upright, 0.8)
                    self.assertGreater(upright, turned + 0.05)

    def test_the_autocorrelation_is_that_of_the_object_times_that_of_a_grain(self):
        random = np.random.default_rng(5)
        points = np.zeros((20, 20))
        points[2, 3], points[14, 9], points[6, 17] = 1, 0.7, 0.5
        np.save(self.folder / "points.npy", np.array([diffused(512, points, 4, random, photons=1e4) for _ in range(8)]))
        np.save(self.folder / "one.npy", np.array([speckle(512, 4, random) for _ in range(8)]))
        self.call("recover", frames="points.npy", average=8, photons=1e4, **FAST, out="a.h5")
        self.call("recover", frames="one.npy", average=8, **FAST, out="b.h5")
        both, grain = (datasets(self.folder / f"{name}.h5") for name in "ab")
        size = 128
        own = np.zeros((size, size))
        own[:61, :61] = grain["autocorrelation"][0]
        transform = np.abs(np.fft.fft2(points, (size, size)))**2 / points.sum()**2
        expected = np.real(np.fft.ifft2(np.fft.fft2(own) * transform))[:61, :61]
        off = both["autocorrelation"][0] - expected
        inside = np.abs(off[15:46, 15:46])
        self.assertLess(np.sqrt((inside**2).mean()), 2 * np.hypot(both["noise"][0], grain["noise"][0]))
        self.assertLess(inside.max(), 8 * np.hypot(both["noise"][0], grain["noise"][0]))
        self.assertGreater(expected.max(), 30 * both["noise"][0])  # so that the test is significant


class Refused(RefusingTest):
    def check(self, words, name, **keys):
        with self.subTest(file=name, **keys):
            self.assert_refused([name, *words], "recover", frames=name, **keys)

    def test_files(self):
        frame = np.arange(96 * 80, dtype=np.uint16).reshape(80, 96) % 251 + 1
        write_all(self.folder, frame)
        self.check(["frame_axes = picture", "frame_axes = columns"], "frame.csv")
        whole = (self.folder / "frame.png").read_bytes()
        (self.folder / "cut.png").write_bytes(whole[:len(whole) // 2])
        self.check(["damaged PNG"], "cut.png")
        colours = np.stack([frame, frame, frame + 1], axis=-1)
        write_png(self.folder / "colours.png", colours.astype(np.uint8))
        self.check(["has colours: convert it to grey"], "colours.png")
        write_png(self.folder / "clear.png", np.stack([frame] * 4, axis=-1).astype(np.uint8))
        self.check(["transparent"], "clear.png")
        for name, start in (("sky.hdr", b"#?RADIANCE\n"), ("sky.jpg", b"\xff\xd8\xff\xe0"), ("sky.exr", b"v/1\1\2\0\0\0")):
            (self.folder / name).write_bytes(start)
            self.check(["give a grey PNG, TIFF, NPY, PFM or HDF5, a Radiance HDR, or an EXR (uncompressed, ZIP, ZIPS or RLE)"], name)
        (self.folder / "cut.tif").write_bytes((self.folder / "frame.tif").read_bytes()[:2000])
        self.check(["TIFF"], "cut.tif")
        (self.folder / "cut.npy").write_bytes((self.folder / "frame.npy").read_bytes()[:2000])
        self.check(["damaged NPY"], "cut.npy")
        np.save(self.folder / "complex.npy", frame.astype(complex))
        self.check(["<c16"], "complex.npy")
        for shape in (f"{10**30}, 2", f"{2**63}, 2", f"{2**32}, {2**32}"):
            data = f"{{'descr': '<u2', 'fortran_order': False, 'shape': ({shape}), }}\n".encode()
            (self.folder / "long.npy").write_bytes(b"\x93NUMPY\x01\0" + bytes([len(data), 0]) + data + b"\0" * 8)
            self.check(["NPY" if "0000" not in shape else "memory"], "long.npy")
        np.save(self.folder / "line.npy", frame[0])
        self.check(["two axes"], "line.npy")
        np.save(self.folder / "nan.npy", np.where(frame == 7, np.nan, frame))
        self.check(["finite"], "nan.npy")
        write_tiff(self.folder / "uneven.tif", [frame, frame[:40]])
        self.check(["different sizes"], "uneven.tif")
        with h5py.File(self.folder / "two.h5", "w") as file:
            file["a"], file["b"] = frame, frame
        self.check(["frame_dataset"], "two.h5")
        self.check(["no dataset c"], "two.h5", frame_dataset="c")

    def test_keys(self):
        frame = np.arange(96 * 80, dtype=np.uint16).reshape(80, 96) % 251 + 1
        write_all(self.folder, frame)
        for words, keys in ((["points"], {"recovery": "search"}), (["frame_axes"], {"frame_axes": "picture"}),
                            (["longest"], {"longest": 30}), (["points"], {"points": 3}),
                            (["region = 0 0 100 10, binning = 1"], {"region": [0, 0, 100, 10]}), (["region"], {"region": [1, 2, 3]}),
                            (["dark"], {"dark": "small.npy"}), (["average"], {"average": 2})):
            np.save(self.folder / "small.npy", frame[:10])
            with self.subTest(**keys):
                self.assert_refused(words, "recover", frames="frame.png", **keys)


if __name__ == "__main__":
    unittest.main()
