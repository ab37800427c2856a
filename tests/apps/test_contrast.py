"""Maps of speckle contrast from frames of known contrast."""

import unittest

import numpy as np

from frame_files import speckle, write_tiff
from program import ProgramTest, datasets
from refusing import RefusingTest

PATTERNS = (2, 10)  # independent patterns in the left and the right half: K^2 is 1 over their number


def frames(count, pixels, random, photons=None):
    """Frames of sums of independent speckle patterns, brighter in the right half."""
    made = []
    for _ in range(count):
        left, right = (sum(speckle(pixels, 3, random) for _ in range(number)) for number in PATTERNS)
        light = np.where(np.arange(pixels) < pixels // 2, left / left.mean(), 2 * right / right.mean())
        made.append(light if photons is None else random.poisson(photons * light))
    return np.array(made)


def halves(values, columns, pixels, margin):
    return [values[:, columns < pixels // 2 - margin], values[:, columns > pixels // 2 + margin]]


class Contrast(ProgramTest):
    def map(self, made, **keys):
        np.save(self.folder / "frames.npy", made)
        self.call("contrast", frames="frames.npy", **keys, out="c.h5")
        return datasets(self.folder / "c.h5")

    def check(self, found, pixels, window, largest_error):
        """K^2 and its errors in both halves; windows that touch are independent."""
        for number, square, error in zip(PATTERNS, *(halves(found[name], found["map_column"], pixels, window)
                                                     for name in ("contrast_map", "contrast_map_error"))):
            apart = square[::window, ::window], error[::window, ::window]
            mean = square.mean()
            spread = np.std(apart[0]) / np.sqrt(apart[0].size)
            self.assertLess(abs(mean * number - 1), 4 * spread * number + 0.02)
            self.assertLess(spread * number, largest_error)
            claimed = np.sqrt((apart[1]**2).mean())
            self.assertLess(abs(np.std(apart[0]) / claimed - 1), 0.35)

    def test_contrast_over_space(self):
        pixels, random = 256, np.random.default_rng(1)
        made = frames(12, pixels, random)
        for window in (7, 15):
            found = self.map(made, window=window)
            self.assertEqual(found["contrast_map"].shape, (pixels - window + 1, pixels - window + 1))
            self.check(found, pixels, window, 0.03)
            self.assertLess(found["invariants/variance"], 1e-9)

    def test_shot_noise_is_subtracted(self):
        pixels, random = 256, np.random.default_rng(2)
        made = 4.0 * frames(12, pixels, random, photons=10)
        self.check(self.map(made, window=9, counts_per_photon=4), pixels, 9, 0.04)
        noisy = self.map(made, window=9)
        self.assertGreater(np.median(noisy["contrast_map"][:, -100:]) * PATTERNS[1], 1.3)

    def test_several_files_are_one_stack(self):
        made = frames(3, 64, np.random.default_rng(6))
        whole = self.map(made, exposure="5ms")
        for number, frame in enumerate(made):
            np.save(self.folder / f"f{number}.npy", frame)
        self.call("contrast", frames=["f0.npy", "f1.npy", "f2.npy"], exposure=0.005, out="c.h5")
        for name, values in datasets(self.folder / "c.h5").items():
            np.testing.assert_array_equal(values, whole[name], name)

    def test_contrast_over_time(self):
        pixels, random = 96, np.random.default_rng(3)
        self.check(self.map(frames(60, pixels, random), window=3, contrast_over="time"), pixels, 3, 0.05)

    def test_decay_rates_solve_the_equation_of_the_contrast(self):
        found = self.map(frames(12, 128, np.random.default_rng(4)), window=15, exposure=0.01, beta=0.8)
        known = found["decay_rate_known"] == 1
        x = found["decay_rate"][known] * 0.01
        square = found["contrast_map"][known]
        expected = np.where(x > 0, 0.8 * (np.expm1(-2 * x) + 2 * x) / (2 * np.maximum(x, 1e-9)**2), 0.8)
        np.testing.assert_allclose(np.minimum(square, 0.8), expected, rtol=1e-6)


class Flow(ProgramTest):
    """Frames of a phantom of two boxes side by side, in which the scatterers diffuse fast and slowly: the exposure adds
    up the light of `field` at many delays. K^2 of the map is that of `covariance` for the decay of the same box."""
    DIFFUSION = 0.5, 0.05
    FRAMES, PIXELS, TIMES, WINDOW = 12, 64, 10, 9
    LIQUID = {"dimension": 3, "width": 40, "height": 40, "depth": 10, "scatterer": "hg", "g": 0.5,
              "optical_depth": 3, "view_angles": 0}

    def exposed(self, diffusion, seed):
        delays = [(i + 0.5) / self.TIMES for i in range(self.TIMES)]
        self.call("field", **self.LIQUID, camera_pixels=self.PIXELS, camera_aperture=0.2, fields=self.FRAMES,
                  paths_per_field=3000, delays=delays, diffusion=diffusion, tolerance=0.05, seed=seed, out="f.h5")
        field = datasets(self.folder / "f.h5")["field"]
        light = (np.abs(field)**2).mean(axis=1).reshape(self.FRAMES, self.PIXELS, self.PIXELS)
        return light / light.mean()

    def expected(self, diffusion):
        self.call("covariance", **self.LIQUID, delays=[i / 20 for i in range(21)], exposures=1, diffusion=diffusion,
                  samples=20000, out="k.h5")
        found = datasets(self.folder / "k.h5")
        return float(found["squared_contrast"].ravel()[0]), float(found["squared_contrast_error"].ravel()[0])

    def test_map_of_a_phantom_agrees_with_the_decay(self):
        made = np.concatenate([self.exposed(d, seed) for seed, d in enumerate(self.DIFFUSION, 3)], axis=2)
        np.save(self.folder / "frames.npy", made)
        self.call("contrast", frames="frames.npy", window=self.WINDOW, out="c.h5")
        found = datasets(self.folder / "c.h5")
        squares = halves(found["contrast_map"], found["map_column"], 2 * self.PIXELS, self.WINDOW // 2)
        for diffusion, square in zip(self.DIFFUSION, squares):
            expected, error = self.expected(diffusion)
            apart = square[::self.WINDOW, ::self.WINDOW]
            spread = np.hypot(error, apart.std() / np.sqrt(apart.size))
            with self.subTest(diffusion=diffusion, found=apart.mean(), expected=expected, spread=spread):
                self.assertLess(spread, 0.03 * expected)
                self.assertLess(abs(apart.mean() - expected), 3 * spread)
        self.assertLess(squares[0].mean(), 0.8 * squares[1].mean())


class Refused(RefusingTest):
    def test_keys(self):
        write_tiff(self.folder / "one.tif", [np.arange(64 * 64, dtype=np.uint16).reshape(64, 64)])
        self.write("lines.csv", "a,b\n" + "1,2\n" * 64)
        for words, keys in ((["window = 17", "quarter"], {"window": 17}), (["window = 1"], {"window": 1}),
                            (["contrast_over = time", "2 frames"], {"contrast_over": "time"}), (["beta"], {"beta": 0.5}),
                            (["exposure"], {"exposure": 0}), (["window"], {"frames": "lines.csv"})):
            with self.subTest(**keys):
                self.assert_refused(words, "contrast", **{"frames": "one.tif", **keys})
        np.save(self.folder / "other.npy", np.ones((64, 60)))
        self.assert_refused(["frames = other.npy", "60 x 64 pixels", "one.tif has 64 x 64"], "contrast",
                            frames=["one.tif", "other.npy"])


if __name__ == "__main__":
    unittest.main()
